#include "trace/resident_scene.h"

#include "tessellation/level.h"
#include "trace/shape_parts.h"

#include <algorithm>
#include <cstddef>
#include <limits>

namespace rayleaf {
namespace {

/// The level of the geometry cache that is no coarser: of 1, 4 or 16 cells along a side.
SubpatchLevels nearest_levels(const Resolution& resolution) {
    SubpatchLevels levels;
    levels.own = static_cast<uint8_t>((resolution.own + 1) / 2);
    return levels;
}

}  // namespace

ResidentScene::ResidentScene(const Shape& shape, std::vector<DicedSurface> forms, FacetBlocks blocks,
                             const CancelToken& cancel)
    : ShapeScene(shape, FacetKind::Resident),
      kernels_(grid_kernels()),
      packet_kernels_(packet_kernels()),
      meet_facets_(decision_kernel()),
      blocks_(std::move(blocks)) {
    blocks_.fill(diced(forms), cancel);
    for (DicedSurface& form : forms) form.grids = MeasuredGrids();
    BoxTree tree(
        static_cast<uint32_t>(blocks_.block_count()), [&](uint32_t i) { return blocks_.box(i); }, cancel);
    tree_ =
        MovingTree(std::move(tree), shape.steps(), [&](uint32_t i, size_t step) { return blocks_.box_at(i, step); });
    Box3f box;
    for (const DicedSurface& form : forms) box.extendBy(form.box);
    if (!tree_.empty()) set_box(box);
    set_parts(parts_of(tree_.still()));
    if (blocks_.block_count() * shape.steps() * kBlockSize <= kMostPoints) set_points(blocks_.vertices());
    dicer_ = std::move(forms.front().dicer);
}

BlockVertices ResidentScene::vertices(const FacetBlock& block) const {
    if (dicer_->format() == VertexFormat::Float) return {block.vertices[0], nullptr, block.facets};
    static_assert(offsetof(FacetBlock, fixed) + kVertexRoom * sizeof(int32_t) <= sizeof(FacetBlock));
    return {nullptr, block.fixed[0], block.facets};
}

/// A ray alone.
struct ResidentScene::Query {
    const ResidentScene* scene;
    FacetQuery facets;
    GridRay ray;
    Wanted wanted;
};

void ResidentScene::add_candidates(const FacetBlock& block, const GridRay& ray, float t_max,
                                   GridCandidates& candidates) const {
    const BlockVertices held = vertices(block);
    if (held.floats)
        kernels_.add_block_of_floats(held.floats, ray, t_max, candidates);
    else
        kernels_.add_block_of_fixed(held.fixed, ray, t_max, candidates);
}

/// Offers the facets of a block that the ray may meet; the exact hit decides.
bool ResidentScene::visit(Query& query, uint32_t number, float t_max) const {
    FacetBlock moved;
    const FacetBlock& block = blocks_.at(number, query.facets.ray->time, moved);
    GridCandidates candidates;
    add_candidates(block, query.ray, t_max, candidates);
    FacetQuery& facets = query.facets;
    bool found = false;
    while (!candidates.empty()) {
        const auto [t, triangle] = candidates.take_nearest();
        if (found && t > facets.ray->float_distance(facets.farthest)) break;
        if ((block.facets >> triangle & 1u) == 0 || facets.ray->start_facet == facet_number(number, triangle)) continue;
        found |= facets.offer_uncertain({number, triangle}, block.corners(triangle, dicer_->format()));
    }
    return found;
}

bool ResidentScene::find(const LocalRay& ray, ShapeHit& hit, Wanted wanted) const {
    if (tree_.empty()) return false;
    Query query{this, FacetQuery(ray, hit), GridRay(ray.float_origin, ray.float_direction), wanted};
    const auto visit_block = [](void* owner, uint32_t block, uint32_t, float* farthest) {
        Query& asked = *static_cast<Query*>(owner);
        if (!asked.scene->visit(asked, block, *farthest)) return;
        *farthest = asked.wanted == Wanted::Any ? kDone : asked.facets.ray->float_distance(asked.facets.farthest);
    };
    float farthest = ray.float_distance(ray.t_max);
    tree_.alone(ray.root, ray.float_origin, ray.float_direction, ray.time, &farthest, visitor(visit_block, &query));
    return query.facets.found;
}

bool ResidentScene::find_all(const LocalRay& ray, uint32_t instance, PassedHits& passed) const {
    if (tree_.empty()) return false;
    struct Asked {
        const ResidentScene* scene;
        PassingQuery query;
        GridRay grid_ray;
        FacetRay facet_ray;
    } asked{this,
            {&ray, instance, &passed},
            GridRay(ray.float_origin, ray.float_direction),
            {ray.origin, ray.direction, ray.start}};
    const auto visit_block = [](void* owner, uint32_t number, uint32_t, float* farthest) {
        const auto& [scene, query, grid_ray, facet_ray] = *static_cast<const Asked*>(owner);
        FacetBlock moved;
        const FacetBlock& block = scene->blocks_.at(number, query.ray->time, moved);
        GridCandidates candidates;
        scene->add_candidates(block, grid_ray, *farthest, candidates);
        while (!candidates.empty() && *farthest != kDone) {
            const uint32_t triangle = candidates.take_nearest().triangle;
            if ((block.facets >> triangle & 1u) == 0 || query.ray->start_facet == facet_number(number, triangle))
                continue;
            const FacetCorners corners = block.corners(triangle, scene->dicer_->format());
            if (query.take({number, triangle}, facet_ray.meet(corners))) *farthest = kDone;
        }
    };
    float farthest = ray.float_distance(ray.t_max);
    tree_.alone(ray.root, ray.float_origin, ray.float_direction, ray.time, &farthest, visitor(visit_block, &asked));
    return passed.is_closed();
}

bool ResidentScene::closest(const LocalRay& ray, ShapeHit& hit) const {
    return find(ray, hit, Wanted::Closest);
}

bool ResidentScene::occluded(const LocalRay& ray) const {
    ShapeHit hit;
    return find(ray, hit, Wanted::Any);
}

/// The same for lanes of a packet: those that surely hit something nearer, a bit each, and what may be hit is kept.
uint32_t ResidentScene::visit(PacketQuery& packet, uint32_t number, uint32_t lanes, float* farthest) const {
    if (deforms()) return visit_moving(packet, number, lanes, farthest);
    const uint32_t sure =
        packet_kernels_.find(vertices(blocks_[number]), number, packet.rays, lanes, farthest, packet.open);
    uint32_t crowded = 0;
    for_each_lane(lanes, [&](size_t lane) {
        if (packet.open.count[lane] > OpenFacets::kMost) crowded |= 1u << lane;
    });
    if (crowded != 0) decide(packet, crowded, farthest);
    return sure;
}

/// Each lane meets the block of its own time.
uint32_t ResidentScene::visit_moving(PacketQuery& packet, uint32_t number, uint32_t lanes, float* farthest) const {
    uint32_t sure = 0, crowded = 0;
    for_each_lane(lanes, [&](size_t lane) {
        FacetBlock moved;
        const FacetBlock& block = blocks_.at(number, packet.times[lane], moved);
        sure |= packet_kernels_.find(vertices(block), number, packet.rays, 1u << lane, farthest, packet.open);
        if (packet.open.count[lane] > OpenFacets::kMost) crowded |= 1u << lane;
    });
    if (crowded != 0) decide(packet, crowded, farthest);
    return sure;
}

struct ResidentScene::Packet {
    const ResidentScene* scene;
    PacketQuery* query;
};

void ResidentScene::find(PacketQuery& packet, Wanted wanted) const {
    packet.found = 0;
    if (tree_.empty()) return;
    packet.open.clear();
    packet_kernels_.shear(packet.rays, packet.lanes);
    const auto visit_closest = [](void* owner, uint32_t block, uint32_t lanes, float* farthest) {
        const Packet& asked = *static_cast<const Packet*>(owner);
        asked.scene->visit(*asked.query, block, lanes, farthest);
    };
    const auto visit_any = [](void* owner, uint32_t block, uint32_t lanes, float* farthest) {
        const Packet& asked = *static_cast<const Packet*>(owner);
        PacketQuery& query = *asked.query;
        query.found |= asked.scene->visit(query, block, lanes, farthest);
        for_each_lane(query.found & lanes, [&](size_t lane) {
            farthest[lane] = kDone;
            query.open.count[lane] = 0;
        });
    };
    alignas(64) float farthest[kPacketSize];
    std::copy_n(packet.rays.farthest, kPacketSize, farthest);
    Packet asked{this, &packet};
    const BoxVisitor::Visit visit_block = wanted == Wanted::Any ? BoxVisitor::Visit{visit_any} : visit_closest;
    tree_.packet(packet.root, packet.rays, packet.times, packet.lanes, kFewBlockRays, farthest,
                 visitor(visit_block, &asked));
    decide(packet, packet.lanes, farthest);
}

void ResidentScene::find_closest(PacketQuery& packet) const {
    find(packet, Wanted::Closest);
}

void ResidentScene::find_any(PacketQuery& packet) const {
    find(packet, Wanted::Any);
}

/// Takes the nearest of the facets that these lanes may hit.
void ResidentScene::decide(PacketQuery& packet, uint32_t lanes, float* farthest) const {
    FacetLanes facets;
    std::array<OpenFacets::Facet, kPacketSize> taken;
    for (;;) {
        uint32_t asked = 0;
        for_each_lane(lanes, [&](size_t lane) {
            if (!packet.open.take(lane, farthest[lane], taken[lane])) return;
            facets.set(lane, blocks_.corners(taken[lane].block, taken[lane].triangle, packet.times[lane]));
            asked |= 1u << lane;
        });
        if (asked == 0) return;
        for_each_lane(meet_facets_(packet.rays, asked, facets), [&](size_t lane) {
            if (packet.take(lane, {taken[lane].block, taken[lane].triangle}, facets.hits.hit(lane)))
                farthest[lane] = std::min(farthest[lane], packet.float_farthest(lane));
        });
        lanes = asked;
    }
}

LocalHit ResidentScene::local_hit(const ShapeHit& hit) const {
    const FacetBlock& block = blocks_[hit.facet.primitive];
    const Vec2d at = blocks_.place(hit.facet.primitive, hit.facet.part, hit.point.u, hit.point.v);
    const ElementPlace place = dicer_->element_place({block.subpatch, at}, hit.point.position);
    LocalHit local;
    local.primitive = place.element;
    local.u = place.u;
    local.v = place.v;
    local.position = hit.point.position;
    local.normal = Vec3f(hit.point.normal / max_abs(hit.point.normal));  // never zero: the facet was hit
    local.subpatch = block.subpatch;
    local.levels = nearest_levels(blocks_.resolution(block.subpatch)).packed();
    local.facet = facet_number(hit.facet.primitive, hit.facet.part);
    return local;
}

LocalHit ResidentScene::on_facet(const LocalHit& hit) const {
    const std::optional<PlaceInGrid> place = dicer_->place_in_grid({hit.primitive, hit.u, hit.v});
    if (!place) return hit;
    const FacetBlocks::Facet facet = blocks_.facet_at(*place);
    const FacetCorners corners = blocks_.corners(facet.block, facet.triangle, hit.time);
    LocalHit result = hit;
    result.facet = facet_number(facet.block, facet.triangle);
    result.position =
        corners[0] + (corners[1] - corners[0]) * facet.weight1 + (corners[2] - corners[0]) * facet.weight2;
    result.normal = Vec3f(normalized_or(area_vector(corners), Vec3d(hit.normal)));
    return result;
}

}  // namespace rayleaf
