// Subdivision surfaces that deform: the limits of one cage at even times of the shutter.
#include "base/error.h"
#include "base/largest.h"
#include "geometry/subdivision_surface.h"

namespace rayleaf {
namespace {

Box3d vertices_box(std::span<const float> vertices) {
    Box3d box;
    for (size_t i = 0; i + 2 < vertices.size(); i += 3) {
        const Vec3d vertex(vertices[i], vertices[i + 1], vertices[i + 2]);
        if (is_place(vertex)) box.extendBy(vertex);
    }
    return box;
}

}  // namespace

SubdivisionSurface::SubdivisionSurface(const SubdivisionCage& cage)
    : SubdivisionSurface(cage, vertices_box(cage.moved_vertices)) {
    if (cage.moved_vertices.empty()) return;
    Box3d extent = object_bounds_;
    extent.extendBy(vertices_box(cage.moved_vertices));
    add_moments(cage, extent);
}

void SubdivisionSurface::add_moments(const SubdivisionCage& cage, const Box3d& extent) {
    const size_t size = cage.vertices.size(), steps = size == 0 ? 0 : cage.moved_vertices.size() / size;
    if (steps < 2 || steps * size != cage.moved_vertices.size())
        throw InputError(name(), "moved_vertices", std::to_string(cage.moved_vertices.size()) + " numbers",
                         "two or more times " + std::to_string(size));
    std::vector<std::unique_ptr<const Shape>> shapes;
    SubdivisionCage moved = cage;
    moved.moved_vertices = moved.corner_normals = {};
    moved.material_slots = {};
    moved.uv_maps.clear();
    moved.active_uv = kNoAttribute;
    moved.attributes.clear();
    for (size_t step = 0; step < steps; ++step) {
        moved.vertices = cage.moved_vertices.subspan(step * size, size);
        shapes.push_back(std::unique_ptr<SubdivisionSurface>(new SubdivisionSurface(moved, extent)));
    }
    steps_ = steps;
    moments_ = Moments(std::move(shapes));
    bounds_.extendBy(moments_.bounds());
    ContentHasher hasher;
    for (const uint64_t word : hash_) hasher.add(word);
    moments_.add_to(hasher);
    hash_ = hasher.value();
}

}  // namespace rayleaf
