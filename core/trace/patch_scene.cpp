#include "trace/patch_scene.h"

#include <oneapi/tbb/parallel_for.h>

namespace rayleaf {
namespace {

/// Grids diced for their boxes are kept if all of a surface take no more than this; bytes.
constexpr uint64_t kKeptAtBuild = uint64_t{16} << 20;

}  // namespace

PatchScene::PatchScene(const PatchSurface& surface, const FacetTolerance& tolerance, const CancelToken& cancel)
    : ShapeScene(surface, FacetKind::Grids),
      surface_(&surface),
      store_(surface, SplitPlan(surface, tolerance)),
      add_candidates_(add_candidates_function()) {
    const uint32_t count = store_.subpatch_count();
    if (count == 0) return;
    const bool keep = count * sizeof(Grid) <= kKeptAtBuild;
    boxes_.resize(count);
    tbb::parallel_for(uint32_t{0}, count, [&](uint32_t i) {
        cancel.throw_if_cancelled();
        if (keep) {
            boxes_[i] = store_.grid(i).box();
        } else {
            Grid grid;
            store_.dice_into(i, grid);
            boxes_[i] = grid.box();
        }
    });
    RTCGeometry geometry = rtcNewGeometry(embree_device(), RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, count);
    rtcSetGeometryUserData(geometry, this);
    rtcSetGeometryBoundsFunction(geometry, bounds_callback, nullptr);
    rtcSetGeometryIntersectFunction(geometry, closest_callback);
    rtcSetGeometryOccludedFunction(geometry, any_callback);
    EmbreeScene scene = new_embree_scene(cancel);
    build_embree_scene(scene, geometry);
    Box3f box;
    for (const Box3f& each : boxes_) box.extendBy(each);
    set_scene(std::move(scene), box);
    boxes_ = {};
}

void PatchScene::bounds_callback(const RTCBoundsFunctionArguments* arguments) {
    const auto& self = *static_cast<const PatchScene*>(arguments->geometryUserPtr);
    const Box3f& box = self.boxes_[arguments->primID];
    *arguments->bounds_o = {box.min.x, box.min.y, box.min.z, 0.0f, box.max.x, box.max.y, box.max.z, 0.0f};
}

/// Offers the facets of a grid, nearest first, until one counts.
bool PatchScene::visit(ShapeQuery& query, uint32_t subpatch, float t_max) const {
    const Grid& grid = store_.grid(subpatch);
    GridCandidates candidates;
    add_candidates_(grid, query.grid_ray, t_max, candidates);
    while (!candidates.empty()) {
        const uint32_t triangle = candidates.take_nearest().triangle;
        if (query.offer({subpatch, triangle}, grid.corners(triangle))) return true;
    }
    return false;
}

void PatchScene::closest_callback(const RTCIntersectFunctionNArguments* arguments) {
    if (arguments->valid[0] == 0) return;
    const auto& self = *static_cast<const PatchScene*>(arguments->geometryUserPtr);
    ShapeQuery& query = ShapeQuery::of(arguments->context);
    float& t_max = RTCRayN_tfar(RTCRayHitN_RayN(arguments->rayhit, arguments->N), arguments->N, 0);
    if (self.visit(query, arguments->primID, t_max)) t_max = query.ray->float_distance(query.farthest);
}

void PatchScene::any_callback(const RTCOccludedFunctionNArguments* arguments) {
    if (arguments->valid[0] == 0) return;
    const auto& self = *static_cast<const PatchScene*>(arguments->geometryUserPtr);
    float& t_max = RTCRayN_tfar(arguments->ray, arguments->N, 0);
    if (self.visit(ShapeQuery::of(arguments->context), arguments->primID, t_max))
        t_max = -std::numeric_limits<float>::infinity();
}

LocalHit PatchScene::local_hit(const ShapeHit& hit) const {
    const Subpatch& subpatch = store_.plan().subpatch(hit.facet.primitive);
    const SplineSplit& split = store_.plan().split(subpatch.spline);
    const Vec2d in_grid = grid_parameters(hit.facet.part, hit.point.u, hit.point.v);
    LocalHit local;
    local.primitive = subpatch.patch;
    local.u = static_cast<float>((subpatch.u * kGridCells + in_grid.x) / split.cells_u());
    local.v = static_cast<float>((subpatch.v * kGridCells + in_grid.y) / split.cells_v());
    local.position = hit.point.position;
    const Vec3d area = area_vector(store_.grid(hit.facet.primitive).corners(hit.facet.part));
    local.normal = Vec3f(area / max_abs(area));  // never zero: the facet was hit
    return local;
}

LocalHit PatchScene::on_facet(const LocalHit& hit) const {
    const uint32_t index = store_.plan().index_at(*surface_, hit.primitive, hit.u, hit.v);
    const Subpatch& subpatch = store_.plan().subpatch(index);
    const SplineSplit& split = store_.plan().split(subpatch.spline);
    const GridPlace place = grid_place(Vec2d(double{hit.u} * split.cells_u() - subpatch.u * kGridCells,
                                             double{hit.v} * split.cells_v() - subpatch.v * kGridCells));
    const FacetCorners corners = store_.grid(index).corners(place.triangle);
    LocalHit result = hit;
    result.position =
        corners[0] + (corners[1] - corners[0]) * place.weight1 + (corners[2] - corners[0]) * place.weight2;
    result.normal = Vec3f(normalized_or(area_vector(corners), Vec3d(hit.normal)));
    return result;
}

}  // namespace rayleaf
