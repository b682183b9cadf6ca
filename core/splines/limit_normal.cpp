#include "splines/limit_normal.h"

#include "splines/bernstein.h"

#include <limits>
#include <span>

namespace rayleaf {

namespace {

/// A first-order term below this share of its products is rounding after cancellation, not a direction.
constexpr double kCancellationShare = 1e-8;

/// A length below which a derivative of the patch may be rounding error alone: some tens of roundings of its largest
/// coordinate, times how far the weights differ (P_u w_u amplifies errors by that much).
double noise_length(const PatchView& patch) {
    double largest = 0, low = std::numeric_limits<double>::infinity(), high = 0;
    for (int j = 0; j < patch.rows(); ++j) {
        for (const Vec4d& p : std::span(patch.row(j), static_cast<size_t>(patch.columns()))) {
            const double w = patch.rational ? p.w : 1.0;
            largest = std::max(largest, max_abs(spatial_part(p)) / w);
            low = std::min(low, w);
            high = std::max(high, w);
        }
    }
    const double roundings = 16.0 * (patch.degree_u + patch.degree_v + 1);
    return roundings * std::numeric_limits<double>::epsilon() * largest * (high / low);
}

/// The source of normals: its points, their noise and the sum of the degrees.
struct PatchSource {
    const PatchView& patch;

    PatchPoint evaluate(double u, double v) const { return patch.evaluate(u, v); }
    double noise() const { return noise_length(patch); }
    int degrees() const { return patch.degree_u + patch.degree_v; }
};

struct FunctionSource {
    const SurfaceFunction& surface;

    static constexpr int kDegrees = 6;  // piecewise bicubic
    PatchPoint evaluate(double u, double v) const { return surface(u, v); }
    double noise() const { return 16.0 * (kDegrees + 1) * std::numeric_limits<double>::epsilon(); }
    int degrees() const { return kDegrees; }
};

bool is_regular(const auto& source, const PatchPoint& p) {
    const double uu = p.du.dot(p.du), vv = p.dv.dot(p.dv);
    const Vec3d cross = p.du.cross(p.dv);
    if (!(cross.dot(cross) > kDegenerateShare * uu * vv)) return false;
    const double shorter = std::sqrt(std::min(uu, vv)), longer = std::sqrt(std::max(uu, vv));
    if (shorter > kSuspiciousRatio * longer && shorter > kSuspiciousLength * max_abs(p.position)) return true;
    return shorter > source.noise();
}

/// The derivative of n for N with derivative dN: the part of dN across n, divided by the length of N.
Vec3d unit_derivative(const Vec3d& normal, double length, const Vec3d& derivative) {
    const Vec3d change = (derivative - normal * normal.dot(derivative)) / length;
    return is_finite(change) ? change : Vec3d(0.0);
}

/// The normal and its derivatives where N is regular; empty if its square leaves the range of doubles.
std::optional<LimitNormal> regular_normal(const PatchPoint& p) {
    const Vec3d cross = p.du.cross(p.dv);
    const double length = cross.length();
    if (!(length > 0.0) || !std::isfinite(length)) return std::nullopt;
    LimitNormal out;
    out.normal = normalized_or(cross, Vec3d(0, 0, 1));
    out.dn_du = unit_derivative(out.normal, length, p.duu.cross(p.dv) + p.du.cross(p.duv));
    out.dn_dv = unit_derivative(out.normal, length, p.duv.cross(p.dv) + p.du.cross(p.dvv));
    return out;
}

/// +1 or -1: which way leads further from the border of [0,1].
double inward(double parameter) {
    return parameter <= 0.5 ? 1.0 : -1.0;
}

std::optional<Vec3d> expanded_normal(const auto& source, const PatchPoint& p, double a, double b) {
    const double u = p.du.length(), v = p.dv.length(), uu = p.duu.length(), uv = p.duv.length(), vv = p.dvv.length();
    const Vec3d step = (p.duu.cross(p.dv) + p.du.cross(p.duv)) * a + (p.duv.cross(p.dv) + p.du.cross(p.dvv)) * b;
    const double products = u * uv + uu * v + u * vv + uv * v;
    const double noise = source.noise() * source.degrees() * (u + v + uu + uv + vv);
    const double length = step.length();
    if (!(length > kCancellationShare * products) || !(length > noise) || !std::isfinite(length)) return std::nullopt;
    const Vec3d none(0.0);
    const Vec3d normal = normalized_or(p.du.cross(p.dv) + step * kInset, none);
    return normal == none ? std::nullopt : std::optional(normal);
}

LimitNormal degenerate_normal(const auto& source, double u, double v, const PatchPoint& point,
                              const NormalFallback& fallback) {
    const double a = inward(u), b = inward(v);
    const PatchPoint inside = source.evaluate(u + a * kInset, v + b * kInset);
    const std::optional<LimitNormal> inset = is_regular(source, inside) ? regular_normal(inside) : std::nullopt;
    LimitNormal out = inset.value_or(LimitNormal());
    if (const auto expanded = expanded_normal(source, point, a, b)) {
        out.normal = *expanded;
        out.stage = NormalStage::SecondOrder;
        return out;
    }
    if (inset) {
        out.stage = NormalStage::Inset;
        return out;
    }
    const Vec3d none(0.0);
    const std::optional<Vec3d> neighbour = fallback.neighbour ? fallback.neighbour() : std::nullopt;
    out.normal = normalized_or(neighbour.value_or(none), none);
    out.stage = NormalStage::Neighbour;
    if (out.normal != none) return out;
    out.normal = normalized_or(fallback.geometric, Vec3d(0, 0, 1));
    out.stage = NormalStage::Geometric;
    return out;
}

LimitNormal normal_of(const auto& source, double u, double v, const PatchPoint& point, const NormalFallback& fallback) {
    if (is_regular(source, point))
        if (const auto regular = regular_normal(point)) return *regular;
    return degenerate_normal(source, u, v, point, fallback);
}

}  // namespace

LimitNormal limit_normal(const PatchView& patch, double u, double v, const PatchPoint& point,
                         const NormalFallback& fallback) {
    return normal_of(PatchSource{patch}, u, v, point, fallback);
}

LimitNormal limit_normal(const SurfaceFunction& surface, double u, double v, const PatchPoint& point,
                         const NormalFallback& fallback) {
    return normal_of(FunctionSource{surface}, u, v, point, fallback);
}

LimitNormal limit_normal(const PatchView& patch, double u, double v, const NormalFallback& fallback) {
    return limit_normal(patch, u, v, patch.evaluate(u, v), fallback);
}

}  // namespace rayleaf
