#include "trace/grid_scene.h"

#include <bit>

namespace rayleaf {
namespace {

/// What a tube is enlarged by: four times the rounding of its test.
constexpr float kTubePadding = 0x1p-17f;

/// Whether the line of a float ray misses a tube. The tube is looked at along the ray: its points are moved to the
/// plane across the ray through its origin. With coordinates up to 1, an origin on the box and a unit direction, each
/// of these is off by less than 2^-19, twice of what the box's padding allows for. All lines of the tube at once.
bool passes_beside(const SubpatchBounds::Tube& tube, const Vec3f& origin, const Vec3f& direction) {
    if (tube.radius < 0.0f) return false;
    struct Points {
        Float4 x, y, z;

        Float4 dot(const Points& other) const { return x * other.x + y * other.y + z * other.z; }
    };
    const auto across = [&](int first) {
        const Points from{load4(tube.points[0] + first) - origin.x, load4(tube.points[1] + first) - origin.y,
                          load4(tube.points[2] + first) - origin.z};
        const Float4 along = from.x * direction.x + from.y * direction.y + from.z * direction.z;
        return Points{from.x - along * direction.x, from.y - along * direction.y, from.z - along * direction.z};
    };
    const Points begin = across(0), end = across(1);
    const Points way{end.x - begin.x, end.y - begin.y, end.z - begin.z};
    constexpr float kSmallest = 1e-30f;  // of squares: lines that are points
    const Float4 raw = -begin.dot(way) / max4(way.dot(way), all4(kSmallest));
    const Float4 share = min4(max4(raw, Float4{}), all4(1.0f));
    const Points nearest{begin.x + way.x * share, begin.y + way.y * share, begin.z + way.z * share};
    const float reach = tube.radius + kTubePadding;
    return least_of(nearest.dot(nearest)) > reach * reach;
}

/// Offers a facet of a subpatch without levels.
bool offer_fixed_facet(ShapeQuery& query, const FacetId& facet, const FacetCorners& corners) {
    if (!query.facets.offer(facet, corners)) return false;
    query.best().place = parameters_in_cell(facet.part, query.best().point.u, query.best().point.v);
    query.best().levels = SubpatchLevels{}.packed();
    return true;
}

/// Levels up to a finest one: alike on both sides of a border, for all of a shape has the same.
SubpatchLevels limited(SubpatchLevels levels, int finest) {
    const auto most = static_cast<uint8_t>(finest);
    for (uint8_t& level : levels.border) level = std::min(level, most);
    levels.own = std::min(levels.own, most);
    return levels;
}

}  // namespace

GridScene::GridScene(const Shape& shape, DicedSurface surface, const CancelToken& cancel)
    : ShapeScene(shape, surface.dicer->format() == VertexFormat::Fixed ? FacetKind::FixedGrids : FacetKind::Grids),
      dicer_(std::move(surface.dicer)),
      kernels_(grid_kernels()),
      step_kernels_(step_kernels()),
      details_(std::move(surface.details)),
      boxes_(std::move(surface.boxes)) {
    const uint32_t count = dicer_->subpatch_count();
    if (count == 0) return;
    keep_tubes(std::move(surface.tubes));
    in_steps_ = fits_steps();
    step_ = in_steps_ ? step_length(dicer_->step_shift()) : kFixedStep;
    EmbreeScene scene = new_embree_scene(cancel);
    build_embree_scene(scene, new_user_geometry(this, count, {bounds_callback, closest_callback, any_callback}));
    set_scene(std::move(scene), surface.box);
    boxes_ = {};
}

/// Whether vertices in steps from a subpatch's corner fit 16 bits.
bool GridScene::fits_steps() const {
    if (dicer_->step_shift() == 0) return false;
    const double most = step_length(dicer_->step_shift()) * kMostSteps;
    return std::all_of(boxes_.begin(), boxes_.end(),
                       [most](const Box3f& box) { return max_abs(Vec3d(box.max) - Vec3d(box.min)) <= most; });
}

/// Where few subpatches are thin, boxes do: a table that no one needs is not kept.
void GridScene::keep_tubes(std::vector<SubpatchBounds::Tube> tubes) {
    const auto is_thin = [](const SubpatchBounds::Tube& tube) {
        float squared = 0.0f;
        for (const float(&along)[SubpatchBounds::kLines + 1] : tube.points)
            squared += (along[SubpatchBounds::kLines] - along[0]) * (along[SubpatchBounds::kLines] - along[0]);
        return tube.radius >= 0.0f && squared > 4.0f * tube.radius * tube.radius;
    };
    const auto thin = std::count_if(tubes.begin(), tubes.end(), is_thin);
    if (2 * static_cast<size_t>(thin) > tubes.size()) tubes_ = std::move(tubes);
}

uint64_t GridScene::record_bytes() const {
    return details_.capacity() * sizeof(SubpatchDetail) + tubes_.capacity() * sizeof(SubpatchBounds::Tube) +
           dicer_->bytes();
}

void GridScene::bounds_callback(const RTCBoundsFunctionArguments* arguments) {
    const auto& self = *static_cast<const GridScene*>(arguments->geometryUserPtr);
    const Box3f& box = self.boxes_[arguments->primID];
    *arguments->bounds_o = {box.min.x, box.min.y, box.min.z, 0.0f, box.max.x, box.max.y, box.max.z, 0.0f};
}

void GridScene::prepare(ShapeQuery& query) const {
    const LocalRay& ray = query.ray();
    if (dicer_->format() == VertexFormat::Fixed)
        query.grid_ray.set_fixed(ray.origin + ray.direction * ray.start, ray.direction, ray.speed, step_);
    if (details_.empty()) return;
    const LevelRule& rule = query.reader->rule();
    LevelChooser& levels = query.levels.emplace(LevelSight(rule, ray.origin, ray.direction, ray.beam, ray.stretch));
    if (ray.before)
        levels.see_nearby({rule, ray.before->origin, ray.before->direction, ray.before->beam, ray.stretch}, ray.origin,
                          ray.before->reach);
    for (const RayAnchor& anchor : ray.anchors) {
        if (anchor.instance == RayAnchor::kNone) continue;
        if (anchor.subpatch == RayAnchor::kNoFacet) levels.see_fine();
        if (anchor.subpatch < details_.size()) levels.anchor(details_[anchor.subpatch], anchor.subpatch, anchor.levels);
    }
}

/// Offers the facets that the ray may meet, nearest first, until the others lie behind one that counts. Facets closer
/// together than single precision tells apart come in no order: the exact hit decides.
bool GridScene::offer_facets(ShapeQuery& query, const SnappedGrid& grid, uint32_t subpatch,
                             const SubpatchLevels& levels, float t_max) const {
    GridCandidates candidates;
    if (grid.cells() == 1)
        add_quad_candidates(details_[subpatch], query.grid_ray, t_max, candidates);
    else
        kernels_.add_candidates(grid, query.grid_ray, t_max, candidates);
    bool found = false;
    while (!candidates.empty()) {
        const auto [t, triangle] = candidates.take_nearest();
        if (found && t > query.ray().float_distance(query.facets.farthest)) break;
        const SnappedGrid::Facet facet = grid.facet(triangle);
        if (!query.facets.offer_uncertain({subpatch, triangle}, facet.corners)) continue;
        const int cells_apart = kGridCells / grid.cells();
        query.best().place = facet.place(query.best().point.u, query.best().point.v) * cells_apart;
        query.best().levels = levels.packed();
        query.best().seen_by = query.levels->seen_by(details_[subpatch]);
        found = true;
    }
    return found;
}

/// The same for a grid of fixed numbers, block by block until the rest is farther away. Facets closer together than
/// single precision tells apart, as those of a thin strand, come in no order; all of a block are offered, for the exact
/// hit decides.
bool GridScene::offer_fixed(ShapeQuery& query, uint32_t subpatch, float t_max) const {
    const Grid& grid = query.reader->fine(*dicer_, first_subpatch(), subpatch);
    NearBlocks blocks;
    kernels_.find_near_blocks(grid, query.grid_ray, t_max, blocks);
    bool found = false;
    while (!blocks.empty()) {
        const uint32_t block = blocks.take_nearest();
        if (blocks.near[block] > t_max) break;
        GridCandidates candidates;
        kernels_.add_block(grid, block, query.grid_ray, t_max, candidates);
        while (!candidates.empty()) {
            const auto [t, triangle] = candidates.take_nearest();
            if (t > t_max) break;
            const FacetCorners corners = grid.corners(triangle, VertexFormat::Fixed);
            if (!offer_fixed_facet(query, {subpatch, triangle}, corners)) continue;
            t_max = query.ray().float_distance(query.facets.farthest);
            found = true;
        }
    }
    return found;
}

/// The same for a grid in steps.
bool GridScene::offer_steps(ShapeQuery& query, uint32_t subpatch, float t_max) const {
    const StepGrid& grid = query.reader->steps(*dicer_, first_subpatch(), subpatch);
    NearBlocks blocks;
    step_kernels_.find_near_blocks(grid, query.grid_ray, t_max, blocks);
    if (blocks.empty()) return false;
    const StepRay ray(grid, query.grid_ray);
    bool found = false;
    while (!blocks.empty()) {
        const uint32_t block = blocks.take_nearest();
        if (blocks.near[block] > t_max) break;
        for (uint32_t bits = step_kernels_.find_triangles(grid, block, ray); bits != 0; bits &= bits - 1) {
            const uint32_t triangle = step_triangle(block, static_cast<uint32_t>(std::countr_zero(bits)));
            if (!passes(grid, triangle, query.grid_ray)) continue;
            if (!offer_fixed_facet(query, {subpatch, triangle}, grid.corners(triangle, step_))) continue;
            t_max = query.ray().float_distance(query.facets.farthest);
            found = true;
        }
    }
    return found;
}

/// One ray in the parts of one subpatch.
struct GridScene::PartSearch {
    ShapeQuery& query;
    const Grid& whole;
    uint32_t subpatch;
    SubpatchLevels levels;
    float t_max;

    /// Blocks of a part that hold facets drawn to vertices outside of it: where a border keeps fewer than one a part.
    uint32_t stretched_blocks(const GridPart& place) const {
        const int along = place.parts_along(), last = kGridCells / kBlockCells - 1;
        const bool outer[kBorders] = {place.v == 0, place.u == along - 1, place.v == along - 1, place.u == 0};
        uint32_t blocks = 0;
        for (int border = 0; border < kBorders; ++border) {
            if (!outer[border] || levels.border[border] + kFine >= levels.own) continue;
            for (int k = 0; k <= last; ++k) {
                const int i = border == 1 ? last : border == 3 ? 0 : k, j = border == 0 ? 0 : border == 2 ? last : k;
                blocks |= 1u << (j * (last + 1) + i);
            }
        }
        return blocks;
    }
};

bool GridScene::visit(ShapeQuery& query, uint32_t subpatch, float t_max) const {
    if (details_.empty()) {
        if (!tubes_.empty() && passes_beside(tubes_[subpatch], query.ray().float_origin, query.ray().float_direction))
            return false;
        return in_steps_ ? offer_steps(query, subpatch, t_max) : offer_fixed(query, subpatch, t_max);
    }
    const GeometryCache::Reader& reader = *query.reader;
    const SubpatchLevels levels =
        limited(query.levels->levels(details_[subpatch], subpatch), dicer_->levels()->finest_level());
    switch (levels.own) {
        case kCoarse:
            reader.count_coarse();
            return offer_facets(query, SnappedGrid(details_[subpatch]), subpatch, levels, t_max);
        case kMedium:
            return offer_facets(query, SnappedGrid(reader.medium(*dicer_, first_subpatch(), subpatch), levels),
                                subpatch, levels, t_max);
        case kFine:
            return offer_facets(query, SnappedGrid(reader.fine(*dicer_, first_subpatch(), subpatch), levels), subpatch,
                                levels, t_max);
        default: {
            reader.count_split();
            const Grid& whole = reader.fine(*dicer_, first_subpatch(), subpatch);
            PartSearch search{query, whole, subpatch, levels, t_max};
            return visit_parts(search, whole, {});
        }
    }
}

/// Goes down from a grid to the parts that its blocks stand for.
bool GridScene::visit_parts(PartSearch& search, const Grid& grid, const GridPart& place) const {
    const float distance = fine_facet_distance(details_[search.subpatch]) * kPartDistance;
    const float padding = distance / static_cast<float>(place.parts_along() * place.parts_along());
    uint32_t blocks =
        kernels_.find_blocks(grid, search.query.grid_ray, search.t_max, padding) | search.stretched_blocks(place);
    bool found = false;
    for (; blocks != 0; blocks &= blocks - 1) {
        const int block = __builtin_ctz(blocks);
        constexpr int kAlong = kGridCells / kBlockCells;
        const GridPart part{place.level + 1, place.u * kAlong + block % kAlong, place.v * kAlong + block / kAlong};
        const Grid& below = search.query.reader->part(*dicer_, first_subpatch(), search.subpatch, part);
        found |= part.level == search.levels.own ? offer_part(search, below, part) : visit_parts(search, below, part);
    }
    return found;
}

bool GridScene::offer_part(PartSearch& search, const Grid& grid, const GridPart& place) const {
    ShapeQuery& query = search.query;
    const SnappedGrid snapped(grid, place, search.whole, search.levels);
    if (!offer_facets(query, snapped, search.subpatch, search.levels, search.t_max)) return false;
    query.best().facet.part += place.number() * kGridTriangles;
    query.best().place = (query.best().place + Vec2d(place.u, place.v) * kGridCells) / place.parts_along();
    search.t_max = query.ray().float_distance(query.facets.farthest);
    return true;
}

void GridScene::closest_callback(const RTCIntersectFunctionNArguments* arguments) {
    if (arguments->valid[0] == 0) return;
    const auto& self = *static_cast<const GridScene*>(arguments->geometryUserPtr);
    ShapeQuery& query = ShapeQuery::of(arguments->context);
    float& t_max = RTCRayN_tfar(RTCRayHitN_RayN(arguments->rayhit, arguments->N), arguments->N, 0);
    if (self.visit(query, arguments->primID, t_max)) t_max = query.ray().float_distance(query.facets.farthest);
}

void GridScene::any_callback(const RTCOccludedFunctionNArguments* arguments) {
    if (arguments->valid[0] == 0) return;
    const auto& self = *static_cast<const GridScene*>(arguments->geometryUserPtr);
    float& t_max = RTCRayN_tfar(arguments->ray, arguments->N, 0);
    if (self.visit(ShapeQuery::of(arguments->context), arguments->primID, t_max))
        t_max = -std::numeric_limits<float>::infinity();
}

LocalHit GridScene::local_hit(const ShapeHit& hit) const {
    const ElementPlace place = dicer_->element_place({hit.facet.primitive, hit.place}, hit.point.position);
    LocalHit local;
    local.primitive = place.element;
    local.u = place.u;
    local.v = place.v;
    local.position = hit.point.position;
    local.normal = Vec3f(hit.point.normal / max_abs(hit.point.normal));  // never zero: the facet was hit
    local.subpatch = hit.facet.primitive;
    local.levels = hit.levels;
    local.seen_by = hit.seen_by;
    if (!details_.empty()) local.subpatch_length = longest_line(details_[hit.facet.primitive]);
    return local;
}

FacetCorners GridScene::fine_corners(const GeometryCache::Reader& reader, uint32_t subpatch, uint32_t triangle) const {
    return in_steps_ ? reader.steps(*dicer_, first_subpatch(), subpatch).corners(triangle, step_)
                     : reader.fine(*dicer_, first_subpatch(), subpatch).corners(triangle, dicer_->format());
}

LocalHit GridScene::on_facet(const LocalHit& hit) const {
    const std::optional<PlaceInGrid> place = dicer_->place_in_grid({hit.primitive, hit.u, hit.v});
    if (!place) return hit;
    const GridPlace in_grid = grid_place(place->at);
    const GeometryCache::Reader reader(*geometry_cache());
    const FacetCorners corners = fine_corners(reader, place->subpatch, in_grid.triangle);
    LocalHit result = hit;
    result.position =
        corners[0] + (corners[1] - corners[0]) * in_grid.weight1 + (corners[2] - corners[0]) * in_grid.weight2;
    result.normal = Vec3f(normalized_or(area_vector(corners), Vec3d(hit.normal)));
    result.subpatch = place->subpatch;
    result.levels = SubpatchLevels{}.packed();
    return result;
}

}  // namespace rayleaf
