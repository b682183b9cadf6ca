#include "trace/grid_scene.h"

#include "geometry/patch_surface.h"

#include <oneapi/tbb/parallel_for.h>

namespace rayleaf {
namespace {

/// Grids diced for their boxes are kept if all of a surface take no more than this; bytes.
constexpr uint64_t kKeptAtBuild = uint64_t{16} << 20;

}  // namespace

GridScene::GridScene(const Shape& shape, std::unique_ptr<const Dicer> dicer, const CancelToken& cancel)
    : ShapeScene(shape, dicer->format() == VertexFormat::Fixed ? FacetKind::FixedGrids : FacetKind::Grids),
      store_(std::move(dicer)),
      add_candidates_(add_candidates_function(store_.dicer().format())) {
    const uint32_t count = store_.subpatch_count();
    if (count == 0) return;
    const bool keep = count * sizeof(Grid) <= kKeptAtBuild;
    boxes_.resize(count);
    tbb::parallel_for(uint32_t{0}, count, [&](uint32_t i) {
        cancel.throw_if_cancelled();
        boxes_[i] = keep ? store_.grid(i).box() : store_.dicer().box(i);
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

void GridScene::bounds_callback(const RTCBoundsFunctionArguments* arguments) {
    const auto& self = *static_cast<const GridScene*>(arguments->geometryUserPtr);
    const Box3f& box = self.boxes_[arguments->primID];
    *arguments->bounds_o = {box.min.x, box.min.y, box.min.z, 0.0f, box.max.x, box.max.y, box.max.z, 0.0f};
}

/// Offers the facets of a grid, nearest first, until one counts. Facets closer together than single precision tells
/// apart, as those of a thin strand, come in no order; all are offered then, for the exact hit decides.
bool GridScene::visit(ShapeQuery& query, uint32_t subpatch, float t_max) const {
    const Grid& grid = store_.grid(subpatch);
    const VertexFormat format = store_.dicer().format();
    GridCandidates candidates;
    add_candidates_(grid, query.grid_ray, t_max, candidates);
    bool found = false;
    while (!candidates.empty()) {
        const uint32_t triangle = candidates.take_nearest().triangle;
        found = query.offer({subpatch, triangle}, grid.corners(triangle, format)) || found;
        if (found && format == VertexFormat::Float) return true;
    }
    return found;
}

void GridScene::closest_callback(const RTCIntersectFunctionNArguments* arguments) {
    if (arguments->valid[0] == 0) return;
    const auto& self = *static_cast<const GridScene*>(arguments->geometryUserPtr);
    ShapeQuery& query = ShapeQuery::of(arguments->context);
    float& t_max = RTCRayN_tfar(RTCRayHitN_RayN(arguments->rayhit, arguments->N), arguments->N, 0);
    if (self.visit(query, arguments->primID, t_max)) t_max = query.ray->float_distance(query.farthest);
}

void GridScene::any_callback(const RTCOccludedFunctionNArguments* arguments) {
    if (arguments->valid[0] == 0) return;
    const auto& self = *static_cast<const GridScene*>(arguments->geometryUserPtr);
    float& t_max = RTCRayN_tfar(arguments->ray, arguments->N, 0);
    if (self.visit(ShapeQuery::of(arguments->context), arguments->primID, t_max))
        t_max = -std::numeric_limits<float>::infinity();
}

LocalHit GridScene::local_hit(const ShapeHit& hit) const {
    const Dicer& dicer = store_.dicer();
    const PlaceInGrid place{hit.facet.primitive, grid_parameters(hit.facet.part, hit.point.u, hit.point.v)};
    const ElementPlace element = dicer.element_place(place, hit.point.position);
    LocalHit local;
    local.primitive = element.element;
    local.u = element.u;
    local.v = element.v;
    local.position = hit.point.position;
    const Vec3d area = area_vector(store_.grid(hit.facet.primitive).corners(hit.facet.part, dicer.format()));
    local.normal = Vec3f(area / max_abs(area));  // never zero: the facet was hit
    return local;
}

LocalHit GridScene::on_facet(const LocalHit& hit) const {
    const std::optional<PlaceInGrid> in_grid = store_.dicer().place_in_grid({hit.primitive, hit.u, hit.v});
    if (!in_grid) return hit;
    const GridPlace place = grid_place(in_grid->at);
    const FacetCorners corners = store_.grid(in_grid->subpatch).corners(place.triangle, store_.dicer().format());
    LocalHit result = hit;
    result.position =
        corners[0] + (corners[1] - corners[0]) * place.weight1 + (corners[2] - corners[0]) * place.weight2;
    result.normal = Vec3f(normalized_or(area_vector(corners), Vec3d(hit.normal)));
    return result;
}

NormalCounters GridScene::limit_normals() const {
    if (shape().kind() != ShapeKind::PatchSurface) return {};
    return static_cast<const PatchSurface&>(shape()).limit_normals();
}

}  // namespace rayleaf
