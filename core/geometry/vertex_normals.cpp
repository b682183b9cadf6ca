#include "geometry/vertex_normals.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

#include <tbb/parallel_for.h>

namespace rayleaf {
namespace {

/// Integers per unit of a sum. A vertex may have some million faces.
constexpr double kUnits = 0x1p40;

/// Along the normal of a polygon, which need not be flat, and as long as twice its area: Newell's method.
Vec3d area_of(std::span<const Vec3f> vertices, std::span<const int32_t> face) {
    const Vec3d origin(vertices[static_cast<size_t>(face.front())]);
    Vec3d sum(0.0), last = Vec3d(vertices[static_cast<size_t>(face.back())]) - origin;
    for (const int32_t corner : face) {
        const Vec3d here = Vec3d(vertices[static_cast<size_t>(corner)]) - origin;
        sum += last.cross(here);
        last = here;
    }
    return sum;
}

/// Of the corner of a face between its neighbours; a right one where an edge has no length.
double angle_at(const Vec3d& before, const Vec3d& here, const Vec3d& after) {
    const Vec3d a = normalized_or(before - here, Vec3d(0.0)), b = normalized_or(after - here, Vec3d(0.0));
    return std::acos(std::clamp(a.dot(b), -1.0, 1.0));
}

}  // namespace

std::vector<Vec3f> vertex_normals(std::span<const Vec3f> vertices, std::span<const int32_t> face_sizes,
                                  std::span<const int32_t> corners) {
    std::vector<size_t> begins(face_sizes.size());
    size_t begin = 0;
    for (size_t i = 0; i < begins.size(); ++i) {
        begins[i] = begin;
        begin += static_cast<size_t>(face_sizes[i]);
    }
    std::vector<std::array<int64_t, 3>> sums(vertices.size());
    tbb::parallel_for(size_t{0}, begins.size(), [&](size_t number) {
        const std::span<const int32_t> face = corners.subspan(begins[number], static_cast<size_t>(face_sizes[number]));
        if (face.size() < 3) return;
        const Vec3d normal = normalized_or(area_of(vertices, face), Vec3d(0.0));
        if (normal == Vec3d(0.0)) return;
        const auto place = [&](size_t i) { return Vec3d(vertices[static_cast<size_t>(face[i % face.size()])]); };
        for (size_t i = 0; i < face.size(); ++i) {
            const Vec3d part = normal * angle_at(place(i + face.size() - 1), place(i), place(i + 1));
            if (!std::isfinite(part.x + part.y + part.z)) continue;  // a face with a vertex that is nowhere
            std::array<int64_t, 3>& sum = sums[static_cast<size_t>(face[i])];
            for (size_t axis = 0; axis < 3; ++axis)
                std::atomic_ref(sum[axis]).fetch_add(std::llround(part[static_cast<int>(axis)] * kUnits),
                                                     std::memory_order_relaxed);
        }
    });
    std::vector<Vec3f> result(vertices.size());
    for (size_t i = 0; i < result.size(); ++i) {
        const auto along = [&](size_t axis) { return static_cast<double>(sums[i][axis]); };
        const Vec3d outwards = normalized_or(Vec3d(vertices[i]), Vec3d(0.0));
        result[i] = Vec3f(normalized_or(Vec3d(along(0), along(1), along(2)), outwards));
    }
    return result;
}

}  // namespace rayleaf
