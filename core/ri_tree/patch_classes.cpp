#include "ri_tree/patch_classes.h"

#include "base/joined_sets.h"
#include "geometry/patch_surface.h"
#include "geometry/triangle_mesh.h"
#include "ri_tree/output_ray.h"

#include <array>
#include <map>

namespace rayleaf {
namespace {

/// Cosine of the angle from which on two normals make an edge, 1e-3 radians: above the rounding of float normals and of
/// limit normals, below any edge that an artist models.
constexpr float kSmoothCosine = 1.0f - 0.5e-6f;
/// Texture coordinates further apart than this do not join.
constexpr float kUvTolerance = 1e-5f;
/// Where along a border the normals of two patches are compared.
constexpr std::array<float, 5> kBorderParameters = {0.05f, 0.25f, 0.5f, 0.75f, 0.95f};

/// The side of a patch at the end, or at the start, of a direction.
Vec2f border_point(PatchDirection across, float end, float along) {
    return across == PatchDirection::U ? Vec2f(end, along) : Vec2f(along, end);
}

bool smooth_border(const PatchSurface& surface, uint32_t before, uint32_t after, PatchDirection across) {
    for (const float along : kBorderParameters) {
        const Vec3f a = surface.element_point(before, border_point(across, 1.0f, along)).normal;
        const Vec3f b = surface.element_point(after, border_point(across, 0.0f, along)).normal;
        if (!(a.dot(b) >= kSmoothCosine)) return false;
    }
    return true;
}

/// The patches of a spline, seen along one direction: patch (i, j) is number `first + i * step + j * other_step`.
struct PatchRows {
    PatchDirection along;
    const std::vector<SplineSpan>& spans;  ///< along that direction
    uint32_t first, step, other_count, other_step;
};

/// Joins the neighbours along one direction of a spline.
void join_along(const PatchSurface& surface, const PatchRows& rows, TextureSeams seams, JoinedSets& joined,
                const CancelToken& cancel) {
    const auto& [along, spans, first, step, other_count, other_step] = rows;
    const auto count = static_cast<uint32_t>(spans.size());
    for (uint32_t i = 0; i < count; ++i) {
        cancel.throw_if_cancelled();
        const bool seam = i + 1 == count;
        if (spans[i].continuity_after < 0 || (seam && (count == 1 || seams == TextureSeams::Parted))) continue;
        for (uint32_t j = 0; j < other_count; ++j) {
            const uint32_t before = first + i * step + j * other_step;
            const uint32_t after = first + (seam ? 0 : i + 1) * step + j * other_step;
            if (smooth_border(surface, before, after, along)) joined.join(before, after);
        }
    }
}

void join_patches(const PatchSurface& surface, TextureSeams seams, JoinedSets& joined, const CancelToken& cancel) {
    for (const SplinePatches& spline : surface.splines()) {
        if (!spline.smooth) continue;
        const auto count_u = static_cast<uint32_t>(spline.spans_u.size());
        const auto count_v = static_cast<uint32_t>(spline.spans_v.size());
        join_along(surface, {PatchDirection::U, spline.spans_u, spline.first_patch, 1, count_v, count_u}, seams, joined,
                   cancel);
        join_along(surface, {PatchDirection::V, spline.spans_v, spline.first_patch, count_u, count_u, 1}, seams, joined,
                   cancel);
    }
}

/// The surface at a corner of a triangle.
LocalSurface at_corner(const TriangleMesh& mesh, uint32_t triangle, int corner) {
    LocalHit hit;
    hit.primitive = triangle;
    hit.u = corner == 1 ? 1.0f : 0.0f;
    hit.v = corner == 2 ? 1.0f : 0.0f;
    const FacetCorners corners = mesh.corners(triangle);
    hit.position = corners[corner];
    hit.normal = Vec3f(normalized_or(area_vector(corners), Vec3d(0, 0, 1)));
    return mesh.surface(hit);
}

bool agree(const LocalSurface& a, const LocalSurface& b, TextureSeams seams) {
    if (!(a.normal.dot(b.normal) >= kSmoothCosine)) return false;
    return seams == TextureSeams::Joined ||
           (std::abs(a.uv.x - b.uv.x) <= kUvTolerance && std::abs(a.uv.y - b.uv.y) <= kUvTolerance);
}

/// One triangle at an edge, with its corners at the edge's lower and upper vertex.
struct EdgeSide {
    uint32_t triangle;
    int low_corner, high_corner;
};

bool smooth_edge(const TriangleMesh& mesh, const EdgeSide& a, const EdgeSide& b, TextureSeams seams) {
    LocalHit hit_a, hit_b;
    hit_a.primitive = a.triangle;
    hit_b.primitive = b.triangle;
    return mesh.material_slot(hit_a) == mesh.material_slot(hit_b) &&
           agree(at_corner(mesh, a.triangle, a.low_corner), at_corner(mesh, b.triangle, b.low_corner), seams) &&
           agree(at_corner(mesh, a.triangle, a.high_corner), at_corner(mesh, b.triangle, b.high_corner), seams);
}

void join_triangles(const TriangleMesh& mesh, TextureSeams seams, JoinedSets& joined, const CancelToken& cancel) {
    std::map<std::pair<uint32_t, uint32_t>, EdgeSide> first_at_edge;
    const std::vector<std::array<uint32_t, 3>>& triangles = mesh.triangles();
    for (uint32_t i = 0; i < triangles.size(); ++i) {
        cancel.throw_if_cancelled();
        for (int corner = 0; corner < 3; ++corner) {
            const int next = (corner + 1) % 3;
            const uint32_t a = triangles[i][corner], b = triangles[i][next];
            if (a == b) continue;  // without area, never hit
            const EdgeSide side = a < b ? EdgeSide{i, corner, next} : EdgeSide{i, next, corner};
            const auto [found, added] = first_at_edge.try_emplace(std::pair(std::min(a, b), std::max(a, b)), side);
            if (!added && smooth_edge(mesh, found->second, side, seams)) joined.join(found->second.triangle, i);
        }
    }
}

}  // namespace

PatchClasses::PatchClasses(const Shape& shape, TextureSeams seams, const CancelToken& cancel)
    : class_of_(shape.element_count(), kFacetedClass) {
    // Strands are too thin for rays to be interpolated between; rays against other surfaces are traced too.
    const bool is_mesh = shape.kind() == ShapeKind::TriangleMesh;
    if (!is_mesh && shape.kind() != ShapeKind::PatchSurface) return;
    JoinedSets joined(shape.element_count());
    if (is_mesh)
        join_triangles(static_cast<const TriangleMesh&>(shape), seams, joined, cancel);
    else
        join_patches(static_cast<const PatchSurface&>(shape), seams, joined, cancel);
    for (uint32_t i = 0; i < class_of_.size(); ++i) {
        if (!is_mesh && !static_cast<const PatchSurface&>(shape).spline_of(i).smooth) continue;
        const uint32_t root = joined.root(i);
        class_of_[i] = root == i ? ++count_ : class_of_[root];
    }
}

}  // namespace rayleaf
