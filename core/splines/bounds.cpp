#include "splines/bounds.h"

#include "splines/bernstein.h"

#include <limits>

namespace rayleaf {

namespace {

Vec3d position_of(const Vec4d& point, bool rational) {
    return rational ? project(point) : spatial_part(point);
}

/// Relative error of a sum of `terms` products, as a share of the largest coordinate: a few roundings for each term.
double rounding_share(int terms) {
    return (4.0 * terms + 8.0) * std::numeric_limits<double>::epsilon();
}

Box3d hull_box(const PatchView& patch, double share) {
    Box3d box;
    box.min = box.max = position_of(patch.points[0], patch.rational);
    for (int j = 0; j < patch.rows(); ++j) {
        for (int i = 0; i < patch.columns(); ++i) {
            const Vec3d here = position_of(patch.point(i, j), patch.rational);
            for (int axis = 0; axis < 3; ++axis) {
                box.min[axis] = std::min(box.min[axis], here[axis]);
                box.max[axis] = std::max(box.max[axis], here[axis]);
            }
        }
    }
    for (int axis = 0; axis < 3; ++axis) {
        const double margin = share * std::max(std::abs(box.min[axis]), std::abs(box.max[axis]));
        box.min[axis] -= margin;
        box.max[axis] += margin;
    }
    return box;
}

float float_not_above(double x) {
    const float rounded = static_cast<float>(x);
    return static_cast<double>(rounded) > x ? std::nextafter(rounded, -std::numeric_limits<float>::infinity())
                                            : rounded;
}

float float_not_below(double x) {
    return -float_not_above(-x);
}

struct Lengths {
    double space = 0, weight = 0;
};

/// Largest lengths over a control net: of the spatial part and of the weight.
class Largest {
  public:
    void add(const Vec4d& difference) {
        squared_ = std::max(squared_, spatial_part(difference).length2());
        weight_ = std::max(weight_, std::abs(difference.w));
    }
    Lengths scaled(double factor) const { return {std::sqrt(squared_) * factor, weight_ * factor}; }

  private:
    double squared_ = 0, weight_ = 0;
};

/// The largest elements of the control nets of a homogeneous patch's derivatives.
struct DerivativeNets {
    Lengths du, dv, duu, duv, dvv;
};

DerivativeNets derivative_nets(const PatchView& p) {
    struct {
        Largest du, dv, duu, duv, dvv;
    } nets;
    const int n = p.degree_u, m = p.degree_v;
    for (int j = 0; j <= m; ++j) {
        for (int i = 0; i <= n; ++i) {
            const Vec4d& here = p.point(i, j);
            if (i < n) nets.du.add(p.point(i + 1, j) - here);
            if (j < m) nets.dv.add(p.point(i, j + 1) - here);
            if (i + 1 < n) nets.duu.add((p.point(i + 2, j) - p.point(i + 1, j)) - (p.point(i + 1, j) - here));
            if (j + 1 < m) nets.dvv.add((p.point(i, j + 2) - p.point(i, j + 1)) - (p.point(i, j + 1) - here));
            if (i < n && j < m) nets.duv.add((p.point(i + 1, j + 1) - p.point(i, j + 1)) - (p.point(i + 1, j) - here));
        }
    }
    return {nets.du.scaled(n), nets.dv.scaled(m), nets.duu.scaled(n * (n - 1)), nets.duv.scaled(n * m),
            nets.dvv.scaled(m * (m - 1))};
}

struct WeightRange {
    double lowest = std::numeric_limits<double>::infinity(), highest = 0;
};

WeightRange weight_range(const PatchView& patch) {
    WeightRange range;
    for (int j = 0; j < patch.rows(); ++j) {
        for (int i = 0; i < patch.columns(); ++i) {
            range.lowest = std::min(range.lowest, patch.point(i, j).w);
            range.highest = std::max(range.highest, patch.point(i, j).w);
        }
    }
    return range;
}

CurvatureBounds rational_bounds(const PatchView& patch, const WeightRange& weights, const Box3d& box) {
    const Vec3d center = box.center();
    BezierPatch moved = BezierPatch::copy_of(patch);
    double radius = 0;
    for (Vec4d& p : moved.points) {
        const Vec3d offset = project(p) - center;
        radius = std::max(radius, offset.length());
        p = homogeneous(offset, p.w);
    }
    const DerivativeNets a = derivative_nets(moved.view());
    const double w = weights.lowest;
    const double du = (a.du.space + radius * a.du.weight) / w, dv = (a.dv.space + radius * a.dv.weight) / w;
    CurvatureBounds out;
    out.duu = (a.duu.space + 2.0 * du * a.du.weight + radius * a.duu.weight) / w;
    out.duv = (a.duv.space + du * a.dv.weight + dv * a.du.weight + radius * a.duv.weight) / w;
    out.dvv = (a.dvv.space + 2.0 * dv * a.dv.weight + radius * a.dvv.weight) / w;
    return out;
}

/// Bounds by the parameters of the patch itself; `extent` is not set.
CurvatureBounds bounds_by_quarters(const PatchView& patch, int quarterings) {
    const WeightRange weights = weight_range(patch);
    if (weights.highest <= kTameWeightRatio * weights.lowest || quarterings == 0)
        return rational_bounds(patch, weights, hull_box(patch, 0.0));
    const BezierPatch whole = BezierPatch::copy_of(patch);
    const auto [low, high] = whole.split(PatchDirection::U, 0.5);
    CurvatureBounds largest;
    for (const BezierPatch* half : {&low, &high}) {
        const auto [below, above] = half->split(PatchDirection::V, 0.5);
        for (const BezierPatch* quarter : {&below, &above}) {
            const CurvatureBounds b = bounds_by_quarters(quarter->view(), quarterings - 1);
            largest.duu = std::max(largest.duu, b.duu);
            largest.duv = std::max(largest.duv, b.duv);
            largest.dvv = std::max(largest.dvv, b.dvv);
        }
    }
    // A quarter's parameters advance twice as fast as those of the whole, so its second derivatives are a quarter.
    return {4.0 * largest.duu, 4.0 * largest.duv, 4.0 * largest.dvv, 0.0};
}

}  // namespace

Box3d hull_bounds(const PatchView& patch) {
    return hull_box(patch, rounding_share(patch.degree_u + patch.degree_v));
}

Box3d hull_bounds(const BezierCurve& curve) {
    return hull_box({curve.degree, 0, curve.rational, curve.points.data(), 0}, rounding_share(curve.degree));
}

Box3f outward_float(const Box3d& box) {
    if (box.isEmpty()) return {};
    return {{float_not_above(box.min.x), float_not_above(box.min.y), float_not_above(box.min.z)},
            {float_not_below(box.max.x), float_not_below(box.max.y), float_not_below(box.max.z)}};
}

CurvatureBounds curvature_bounds(const PatchView& patch) {
    CurvatureBounds out;
    if (patch.rational) {
        out = bounds_by_quarters(patch, kMostQuarterings);
    } else {
        const DerivativeNets nets = derivative_nets(patch);
        out = {nets.duu.space, nets.duv.space, nets.dvv.space, 0.0};
    }
    out.extent = hull_bounds(patch).size().length();
    return out;
}

double facet_distance_bound(const CurvatureBounds& bounds, int cells_u, int cells_v) {
    const double hu = 1.0 / cells_u, hv = 1.0 / cells_v;
    const double by_curvature = (bounds.duu * hu * hu + 2.0 * bounds.duv * hu * hv + bounds.dvv * hv * hv) / 8.0;
    return std::min(by_curvature, bounds.extent);  // facets and patch lie in one box
}

}  // namespace rayleaf
