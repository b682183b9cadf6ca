#include "rivals/embree_baseline.h"

#include "tessellation/patch_dicer.h"
#include "trace/dicing.h"

#include <limits>

#include <oneapi/tbb/parallel_for.h>

namespace rayleaf {
namespace {

Vec3f* new_vertices(RTCGeometry geometry, uint32_t grids) {
    return new_embree_buffer<Vec3f>(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, size_t{grids} * kGridSize);
}

void add_grids(RTCGeometry geometry, uint32_t count) {
    auto* grids = new_embree_buffer<RTCGrid>(geometry, RTC_BUFFER_TYPE_GRID, RTC_FORMAT_GRID, count);
    for (uint32_t i = 0; i < count; ++i) grids[i] = {i * kGridSize, kGridVertices, kGridVertices, kGridVertices};
}

void add_triangles(RTCGeometry geometry, uint32_t count) {
    auto* indices = new_embree_buffer<std::array<uint32_t, 3>>(geometry, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3,
                                                               size_t{count} * kGridTriangles)
                        ->data();
    for (uint32_t grid = 0; grid < count; ++grid) {
        for (int j = 0; j < kGridCells; ++j) {
            for (int i = 0; i < kGridCells; ++i) {
                const uint32_t a = grid * kGridSize + j * kGridVertices + i, c = a + kGridVertices + 1;
                const uint32_t corners[6] = {a, c, a + 1, a, c - 1, c};
                indices = std::copy_n(corners, 6, indices);
            }
        }
    }
}

}  // namespace

EmbreeBaseline::EmbreeBaseline(const PatchSurface& surface, const DicingView& view, EmbreePrimitive primitive)
    : frame_(surface.frame()) {
    const std::shared_ptr<const Shape> shape(std::shared_ptr<const Shape>(), &surface);
    const std::vector<TracedInstance> instances = {{shape, {}, kVisibleAll}};
    const PatchDicer dicer(
        surface, facet_tolerances(instances, std::array{0u}, std::array<uint8_t, 1>{1}, view).front().tolerance);
    const uint32_t count = dicer.subpatch_count();
    const uint64_t before = embree_bytes();
    const RTCGeometryType type =
        primitive == EmbreePrimitive::Grid ? RTC_GEOMETRY_TYPE_GRID : RTC_GEOMETRY_TYPE_TRIANGLE;
    RTCGeometry geometry = rtcNewGeometry(embree_device(), type);
    Vec3f* vertices = new_vertices(geometry, count);
    tbb::parallel_for(uint32_t{0}, count, [&](uint32_t i) {
        Grid grid;
        dicer.dice(i, grid);
        for (int k = 0; k < kGridSize; ++k)
            vertices[size_t{i} * kGridSize + k] = grid.vertex(k % kGridVertices, k / kGridVertices);
    });
    if (primitive == EmbreePrimitive::Grid)
        add_grids(geometry, count);
    else
        add_triangles(geometry, count);
    scene_ = new_embree_scene();
    build_embree_scene(scene_, geometry);
    bytes_ = embree_bytes() - before;
}

EmbreeBaseline::EmbreeBaseline(const TriangleMesh& mesh) : frame_(mesh.frame()) {
    const uint64_t before = embree_bytes();
    RTCGeometry geometry = rtcNewGeometry(embree_device(), RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices =
        new_embree_buffer<Vec3f>(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, mesh.vertices().size());
    std::copy(mesh.vertices().begin(), mesh.vertices().end(), vertices);
    using Triangle = std::array<uint32_t, 3>;
    auto* triangles =
        new_embree_buffer<Triangle>(geometry, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, mesh.triangles().size());
    std::copy(mesh.triangles().begin(), mesh.triangles().end(), triangles);
    scene_ = new_embree_scene();
    build_embree_scene(scene_, geometry);
    bytes_ = embree_bytes() - before;
}

float EmbreeBaseline::closest_t(const Ray& ray) const {
    const Vec3d origin = (ray.origin - frame_.center) / frame_.scale;
    RTCRayHit hit{};
    hit.ray.org_x = static_cast<float>(origin.x);
    hit.ray.org_y = static_cast<float>(origin.y);
    hit.ray.org_z = static_cast<float>(origin.z);
    hit.ray.dir_x = static_cast<float>(ray.direction.x);
    hit.ray.dir_y = static_cast<float>(ray.direction.y);
    hit.ray.dir_z = static_cast<float>(ray.direction.z);
    hit.ray.tnear = static_cast<float>(ray.t_min / frame_.scale);
    hit.ray.tfar = static_cast<float>(ray.t_max / frame_.scale);
    hit.ray.mask = ~0u;
    hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    EmbreeContext context;
    initialize(context);
    embree_closest(scene_.get(), context, hit);
    if (hit.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::numeric_limits<float>::infinity();
    return hit.ray.tfar * static_cast<float>(frame_.scale);
}

}  // namespace rayleaf
