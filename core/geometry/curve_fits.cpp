#include "geometry/curve_fits.h"

#include "base/error.h"

#include <numbers>

namespace rayleaf {
namespace {

/// The tube of one strand, ring by ring.
class TubeBuilder {
  public:
    TubeBuilder(const Strands& strands, int sides, std::vector<float>& vertices, std::vector<float>& normals)
        : strands_(strands), sides_(sides), vertices_(vertices), normals_(normals) {}

    /// Resets the frame for a new strand.
    void begin() { across_ = Vec3d(0.0); }

    void add_ring(uint32_t segment, double s) {
        const StrandSegment curve = strands_.segment(segment);
        const StrandPoint point = curve.at(s), change = curve.derivative(s);
        const Vec3d tangent = normalized_or(axis_point(change), tangent_);
        carry_frame(tangent);
        const Vec3d up = tangent.cross(across_);
        const LocalFrame& frame = strands_.frame();
        for (int i = 0; i < sides_; ++i) {
            const double angle = 2.0 * std::numbers::pi * i / sides_;
            const Vec3d around = across_ * std::cos(angle) + up * std::sin(angle);
            push(vertices_, frame.center + (axis_point(point) + around * point.w) * frame.scale);
            push(normals_, around);
        }
    }

  private:
    const Strands& strands_;
    int sides_;
    std::vector<float>&vertices_, &normals_;
    Vec3d tangent_{0, 0, 1}, across_{0, 0, 0};

    static void push(std::vector<float>& values, const Vec3d& v) {
        for (int axis = 0; axis < 3; ++axis) values.push_back(static_cast<float>(v[axis]));
    }
    /// Turns the frame with the tangent, without twist.
    void carry_frame(const Vec3d& tangent) {
        Vec3f any, other;
        orthonormal_basis(Vec3f(tangent), any, other);
        across_ = normalized_or(across_ - tangent * tangent.dot(across_), Vec3d(any));
        tangent_ = tangent;
    }
};

void require_detail(const std::string& name, const char* argument, int value, int least) {
    if (value < least || value > kMostTubeDetail)
        throw InputError(name, argument, std::to_string(value),
                         std::to_string(least) + " to " + std::to_string(kMostTubeDetail));
}

/// Adds two triangles per quadrangle, in the order of FacetLayout::Quads.
void add_quads(std::vector<int32_t>& triangles, int32_t ring, int32_t next, int sides) {
    for (int i = 0; i < sides; ++i) {
        const int j = (i + 1) % sides;
        const int32_t a = ring + i, b = ring + j, c = next + j, d = next + i;
        triangles.insert(triangles.end(), {a, b, d, c, d, b});
    }
}

/// Adds a piece of a swept curve's spine as a cubic: exact for polynomial cubics, else with the same ends and
/// directions.
void add_piece(const SweepPath& path, const SweepPiece& piece, double profile_radius, bool is_first,
               std::vector<StrandPoint>& points) {
    const auto at = [&](double u) {
        const SweepRingPoint ring = path.evaluate(piece, u);
        const double length = ring.ring.across.length();
        const double change = length > 0.0 ? ring.ring.across.dot(ring.change.across) / length : 0.0;
        const Vec3d &c = ring.ring.center, &d = ring.change.center;
        return std::pair(StrandPoint(c.x, c.y, c.z, length * profile_radius),
                         StrandPoint(d.x, d.y, d.z, change * profile_radius));
    };
    const auto [begin, leaving] = at(0.0);
    const auto [end, arriving] = at(1.0);
    if (is_first) points.push_back(begin);
    points.push_back(begin + leaving / 3.0);
    points.push_back(end - arriving / 3.0);
    points.push_back(end);
}

bool is_round(const SweptCurveDescription& curve) {
    return curve.bevel_depth != 0.0 && curve.extrude == 0.0 && curve.offset == 0.0 && !curve.profile &&
           curve.fill == BevelFill::Full;
}

}  // namespace

std::shared_ptr<TriangleMesh> strand_tubes(const Strands& strands, int rings, int sides, FacetLayout layout) {
    require_detail(strands.name(), "rings", rings, 1);
    require_detail(strands.name(), "sides", sides, 3);
    std::vector<float> vertices, ring_normals, normals;
    std::vector<int32_t> triangles, slots;
    TubeBuilder tube(strands, sides, vertices, ring_normals);
    uint32_t segment = 0;
    while (segment < strands.element_count()) {
        const uint32_t strand = strands.strand_of(segment);
        tube.begin();
        const auto first_triangle = triangles.size() / 3;
        tube.add_ring(segment, 0.0);
        const uint32_t first = segment;
        for (; segment < strands.element_count() && strands.strand_of(segment) == strand; ++segment) {
            for (int k = 1; k <= rings; ++k) {
                const auto next = static_cast<int32_t>(vertices.size() / 3);
                tube.add_ring(segment, static_cast<double>(k) / rings);
                add_quads(triangles, next - sides, next, sides);
            }
        }
        LocalHit hit;
        hit.primitive = first;
        const auto slot = static_cast<int32_t>(strands.material_slot(hit));
        slots.insert(slots.end(), triangles.size() / 3 - first_triangle, slot);
    }
    normals.reserve(3 * triangles.size());
    for (const int32_t vertex : triangles)
        for (int axis = 0; axis < 3; ++axis) normals.push_back(ring_normals[3 * size_t(vertex) + axis]);
    TriangleMeshArrays arrays;
    arrays.name = strands.name();
    arrays.vertices = vertices;
    arrays.triangles = triangles;
    arrays.corner_normals = normals;
    arrays.material_slots = slots;
    arrays.layout = layout;
    return std::make_shared<TriangleMesh>(std::move(arrays));
}

std::shared_ptr<Strands> strands_along(const SweptCurveDescription& curve, StrandForm form, int spheres) {
    if (!is_round(curve)) return nullptr;
    const SweptSurface surface(curve);
    const SweepPath& path = surface.path();
    const LocalFrame& frame = surface.frame();
    std::vector<StrandPoint> local;
    std::vector<int32_t> offsets = {0}, slots;
    for (const SweepSpline& spline : path.splines) {
        for (uint32_t i = 0; i < spline.piece_count; ++i)
            add_piece(path, path.pieces[spline.first_piece + i], std::abs(curve.bevel_depth), i == 0, local);
        offsets.push_back(static_cast<int32_t>(local.size()));
        slots.push_back(static_cast<int32_t>(curve.splines[spline.group].material_slot));
    }
    std::vector<double> points;
    std::vector<float> radii;
    for (const StrandPoint& p : local) {
        const Vec3d object = frame.center + axis_point(p) * frame.scale;
        points.insert(points.end(), {object.x, object.y, object.z});
        radii.push_back(static_cast<float>(std::max(p.w, 0.0) * frame.scale));
    }
    StrandArrays arrays;
    arrays.name = curve.name;
    arrays.points = points;
    arrays.radii = radii;
    arrays.offsets = offsets;
    arrays.material_slots = slots;
    arrays.basis = StrandBasis::Bezier;
    arrays.form = form;
    arrays.spheres_per_segment = spheres;
    return std::make_shared<Strands>(std::move(arrays));
}

}  // namespace rayleaf
