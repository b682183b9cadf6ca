#include "trace/resident_scene.h"

#include "tessellation/level.h"

#include <algorithm>
#include <bit>
#include <limits>

namespace rayleaf {
namespace {

/// So few rays are tested against a block faster one by one.
constexpr int kFewRays = 3;

/// The level of the geometry cache that is no coarser: of 1, 4 or 16 cells along a side.
SubpatchLevels nearest_levels(const Resolution& resolution) {
    SubpatchLevels levels;
    levels.own = static_cast<uint8_t>((resolution.own + 1) / 2);
    return levels;
}

}  // namespace

ResidentScene::ResidentScene(const Shape& shape, DicedSurface surface, FacetBlocks blocks, const CancelToken& cancel)
    : ShapeScene(shape, FacetKind::Resident),
      dicer_(std::move(surface.dicer)),
      kernels_(grid_kernels()),
      packet_kernels_(packet_kernels()),
      meet_facets_(decision_kernel()),
      blocks_(std::move(blocks)) {
    blocks_.fill(*dicer_, surface.details, cancel);
    if (blocks_.block_count() == 0) return;
    EmbreeScene scene = new_embree_scene(cancel);
    build_embree_scene(
        scene, new_user_geometry(this, blocks_.block_count(), {bounds_callback, closest_callback, any_callback}));
    set_scene(std::move(scene), surface.box);
}

/// A block's vertices in single precision, [3][25].
const float* ResidentScene::float_vertices(const FacetBlock& block, float* room) const {
    if (dicer_->format() == VertexFormat::Float) return block.vertices[0];
    for (int axis = 0; axis < 3; ++axis)
        for (int k = 0; k < kBlockSize; ++k)
            room[axis * kBlockSize + k] = static_cast<float>(block.fixed[axis][k]) * static_cast<float>(kFixedStep);
    return room;
}

/// Offers the facets of a block that the ray may meet; the exact hit decides.
bool ResidentScene::visit(FacetQuery& query, const GridRay& ray, uint32_t number, float t_max) const {
    const FacetBlock& block = blocks_[number];
    float room[3 * kBlockSize];
    GridCandidates candidates;
    kernels_.add_block_of_floats(float_vertices(block, room), ray, t_max, candidates);
    bool found = false;
    while (!candidates.empty()) {
        const auto [t, triangle] = candidates.take_nearest();
        if (found && t > query.ray->float_distance(query.farthest)) break;
        found |= query.offer_uncertain({number, triangle}, block.corners(triangle, dicer_->format()));
    }
    return found;
}

/// The same for lanes of a packet: those that surely hit something nearer, a bit each, and what may be hit is kept.
uint32_t ResidentScene::visit(PacketQuery& packet, uint32_t number, uint32_t lanes, float* farthest) const {
    float room[3 * kBlockSize];
    const FindInBlock find = std::popcount(lanes) <= kFewRays ? packet_kernels_.one_by_one : packet_kernels_.together;
    const uint32_t sure =
        find(float_vertices(blocks_[number], room), number, packet.rays, lanes, farthest, packet.open);
    uint32_t crowded = 0;
    for_each_lane(lanes, [&](size_t lane) {
        if (packet.open.count[lane] > OpenFacets::kMost) crowded |= 1u << lane;
    });
    if (crowded != 0) decide(packet, crowded, farthest);
    return sure;
}

void ResidentScene::begin(PacketQuery& packet) const {
    packet.open.clear();
    packet_kernels_.shear(packet.rays, packet.lanes);
}

void ResidentScene::end(PacketQuery& packet, const float* farthest) const {
    alignas(64) float left[kPacketSize];
    std::copy_n(farthest, kPacketSize, left);
    decide(packet, packet.lanes, left);
}

/// Takes the nearest of the facets that these lanes may hit.
void ResidentScene::decide(PacketQuery& packet, uint32_t lanes, float* farthest) const {
    FacetLanes facets;
    std::array<OpenFacets::Facet, kPacketSize> taken;
    for (;;) {
        uint32_t asked = 0;
        for_each_lane(lanes, [&](size_t lane) {
            if (!packet.open.take(lane, farthest[lane], taken[lane])) return;
            facets.set(lane, blocks_[taken[lane].block].corners(taken[lane].triangle, dicer_->format()));
            asked |= 1u << lane;
        });
        if (asked == 0) return;
        for_each_lane(meet_facets_(packet.rays, asked, facets), [&](size_t lane) {
            if (packet.take(lane, {taken[lane].block, taken[lane].triangle}, facets.hit(lane)))
                farthest[lane] = std::min(farthest[lane], packet.float_farthest(lane));
        });
        lanes = asked;
    }
}

void ResidentScene::bounds_callback(const RTCBoundsFunctionArguments* arguments) {
    const auto& self = *static_cast<const ResidentScene*>(arguments->geometryUserPtr);
    const Box3f box = self.blocks_.box(arguments->primID);
    *arguments->bounds_o = {box.min.x, box.min.y, box.min.z, 0.0f, box.max.x, box.max.y, box.max.z, 0.0f};
}

void ResidentScene::closest_callback(const RTCIntersectFunctionNArguments* arguments) {
    const auto& self = *static_cast<const ResidentScene*>(arguments->geometryUserPtr);
    const uint32_t lanes = lanes_of(arguments->valid, arguments->N);
    if (lanes == 0) return;
    float* t_max = &RTCRayN_tfar(RTCRayHitN_RayN(arguments->rayhit, arguments->N), arguments->N, 0);
    if (arguments->N == 1) {
        ShapeQuery& query = ShapeQuery::of(arguments->context);
        if (self.visit(query.facets, query.grid_ray, arguments->primID, *t_max))
            *t_max = query.ray().float_distance(query.facets.farthest);
        return;
    }
    self.visit(PacketQuery::of(arguments->context), arguments->primID, lanes, t_max);
}

void ResidentScene::any_callback(const RTCOccludedFunctionNArguments* arguments) {
    const auto& self = *static_cast<const ResidentScene*>(arguments->geometryUserPtr);
    const uint32_t lanes = lanes_of(arguments->valid, arguments->N);
    if (lanes == 0) return;
    float* t_max = &RTCRayN_tfar(arguments->ray, arguments->N, 0);
    constexpr float kHit = -std::numeric_limits<float>::infinity();
    if (arguments->N == 1) {
        ShapeQuery& query = ShapeQuery::of(arguments->context);
        if (self.visit(query.facets, query.grid_ray, arguments->primID, *t_max)) *t_max = kHit;
        return;
    }
    PacketQuery& packet = PacketQuery::of(arguments->context);
    packet.found |= self.visit(packet, arguments->primID, lanes, t_max);
    for_each_lane(packet.found & lanes, [&](size_t lane) {
        t_max[lane] = kHit;
        packet.open.count[lane] = 0;
    });
}

LocalHit ResidentScene::local_hit(const ShapeHit& hit) const {
    const FacetBlock& block = blocks_[hit.facet.primitive];
    const Vec2d at = blocks_.place(hit.facet.primitive, hit.facet.part, hit.point.u, hit.point.v);
    const ElementPlace place = dicer_->element_place({block.subpatch, at}, hit.point.position);
    const Vec3d area = area_vector(block.corners(hit.facet.part, dicer_->format()));
    LocalHit local;
    local.primitive = place.element;
    local.u = place.u;
    local.v = place.v;
    local.position = hit.point.position;
    local.normal = Vec3f(area / max_abs(area));  // never zero: the facet was hit
    local.subpatch = block.subpatch;
    local.levels = nearest_levels(blocks_.resolution(block.subpatch)).packed();
    return local;
}

LocalHit ResidentScene::on_facet(const LocalHit& hit) const {
    const std::optional<PlaceInGrid> place = dicer_->place_in_grid({hit.primitive, hit.u, hit.v});
    if (!place) return hit;
    const FacetBlocks::Facet facet = blocks_.facet_at(*place);
    const FacetCorners corners = blocks_[facet.block].corners(facet.triangle, dicer_->format());
    LocalHit result = hit;
    result.position =
        corners[0] + (corners[1] - corners[0]) * facet.weight1 + (corners[2] - corners[0]) * facet.weight2;
    result.normal = Vec3f(normalized_or(area_vector(corners), Vec3d(hit.normal)));
    return result;
}

}  // namespace rayleaf
