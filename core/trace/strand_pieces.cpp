// How a scene of strands is made: segments cut into pieces, and the tree over them.
#include "trace/shape_parts.h"
#include "trace/strand_scene.h"

#include <algorithm>
#include <array>
#include <limits>

#include <oneapi/tbb/parallel_for.h>

namespace rayleaf {
namespace {

/// So often at most: memory doubles each time.
constexpr uint16_t kMostHalvings = 3;
/// Pieces have boxes along the axes: halving them once more is worth it where that leaves less than this share of their
/// surface. Measured: the last time has to save more to pay for what is built.
constexpr std::array<double, kMostHalvings> kWorthHalving{0.75, 0.75, 0.62};

/// Pieces beside each other that the tree does not part: a leaf holds several anyway, and the tree is built in half
/// the time.
constexpr uint32_t kPiecesOfItem = 2;

}  // namespace

StrandScene::StrandScene(const Strands& strands, const CancelToken& cancel)
    : ShapeScene(strands, FacetKind::Strands), strands_(&strands), meet_capsules_(capsule_kernel()) {
    build_tree(all_pieces(cancel), cancel);
    if (!tree_.empty()) set_box(strands.bounds());
    set_parts(parts_of(tree_.still()));
}

/// Segments are taken in parts, which count first, so that each knows where what it makes belongs.
StrandScene::Pieces StrandScene::all_pieces(const CancelToken& cancel) const {
    constexpr uint32_t kAtOnce = 1u << 12;
    constexpr uint16_t kNone = std::numeric_limits<uint16_t>::max();
    const bool spheres = strands_->form() == StrandForm::Spheres;
    const auto segments = static_cast<uint32_t>(strands_->element_count());
    const uint32_t parts = (segments + kAtOnce - 1) / kAtOnce;
    const auto for_parts = [&](const auto& visit) {
        tbb::parallel_for(uint32_t{0}, parts, [&](uint32_t part) {
            cancel.throw_if_cancelled();
            const uint32_t first = part * kAtOnce, end = std::min(segments, first + kAtOnce);
            for (uint32_t segment = first; segment < end; ++segment) visit(part, segment);
        });
    };
    const auto pieces_of = [&](uint16_t level) -> uint32_t {
        if (level == kNone) return 0;
        return spheres ? static_cast<uint32_t>(strands_->spheres_per_segment()) + 1 : 1u << level;
    };
    struct Room {
        uint32_t pieces = 0, items = 0;
    };
    std::vector<uint16_t> levels(segments, kNone);
    std::vector<Room> rooms(parts + 1);  // of each part, behind that of the part before
    for_parts([&](uint32_t part, uint32_t segment) {
        if (can_be_hit(segment)) levels[segment] = spheres ? 0 : split_level(strands_->segment(segment));
        const uint32_t count = pieces_of(levels[segment]);
        rooms[part + 1].pieces += count;
        rooms[part + 1].items += (count + kPiecesOfItem - 1) / kPiecesOfItem;
    });
    for (uint32_t part = 0; part < parts; ++part) {
        rooms[part + 1].pieces += rooms[part].pieces;
        rooms[part + 1].items += rooms[part].items;
    }
    Pieces found{LargeArray<Piece>(rooms[parts].pieces), LargeArray<uint32_t>(rooms[parts].items + 1)};
    found.items[rooms[parts].items] = rooms[parts].pieces;
    std::vector<Room> next = rooms;
    for_parts([&](uint32_t part, uint32_t segment) {
        const uint16_t level = levels[segment];
        const uint32_t count = pieces_of(level);
        if (count == 0) return;
        const Strands::Place place = strands_->place(segment);
        for (uint32_t index = 0; index < count; ++index) {
            if (index % kPiecesOfItem == 0) found.items[next[part].items++] = next[part].pieces;
            found.all[next[part].pieces++] = {segment, static_cast<uint16_t>(index), level, place};
        }
    });
    return found;
}

bool StrandScene::can_be_hit(uint32_t segment) const {
    const size_t steps = strands_->steps();
    for (size_t step = 0; step < steps; ++step) {
        const float time = steps > 1 ? time_of_step(step, steps) : kMiddleTime;
        for (const StrandPoint& p : strands_->segment(segment, time).points)
            if (p.w != 0.0) return true;
    }
    return false;
}

void StrandScene::build_tree(const Pieces& pieces, const CancelToken& cancel) {
    const LargeArray<uint32_t>& first = pieces.items;
    BoxLeaves leaves;
    const size_t steps = strands_->steps();
    const auto time_of = [steps](size_t step) { return steps > 1 ? time_of_step(step, steps) : kMiddleTime; };
    const auto box_of = [&](uint32_t item) {
        Box3f box;
        for (uint32_t i = first[item]; i < first[item + 1]; ++i)
            for (size_t step = 0; step < steps; ++step) box.extendBy(float_box(pieces.all[i], time_of(step)));
        return box;
    };
    constexpr uint32_t kMostItems = BoxTree::kMostInLeaf / kPiecesOfItem;
    BoxTree tree(static_cast<uint32_t>(first.size() - 1), box_of, cancel, kMostItems, leaves);
    piece_count_ = pieces.all.size();
    pieces_ = LargeArray<LeafPieces>(leaves.count());
    capsules_ = LargeArray<Capsules>(leaves.count() * steps);
    tbb::parallel_for(uint32_t{0}, leaves.count(), [&](uint32_t leaf) {
        cancel.throw_if_cancelled();
        LeafPieces& its = pieces_[leaf] = {};
        uint32_t count = 0;
        for (uint32_t i = leaves.first[leaf]; i < leaves.first[leaf + 1]; ++i)
            for (uint32_t k = first[leaves.items[i]]; k < first[leaves.items[i] + 1]; ++k)
                its.of[count++] = pieces.all[k];
        for (size_t step = 0; step < steps; ++step) {
            Capsules& capsules = capsules_[leaf * steps + step] = {};
            capsules.count = count;
            for (uint32_t lane = 0; lane < count; ++lane) set_capsule(capsules, lane, its.of[lane], time_of(step));
        }
    });
    tree_ = MovingTree(std::move(tree), steps, [&](uint32_t leaf, size_t step) {
        cancel.throw_if_cancelled();
        Box3f box;
        for (uint32_t i = 0; i < capsules_[leaf * steps].count; ++i)
            box.extendBy(float_box(pieces_[leaf].of[i], time_of(step)));
        return box;
    });
}

/// What holds a piece at two times, mixed, holds it in between: its points go along lines, and neither their bend nor
/// the radius is more than the mean of both.
const Capsules& StrandScene::mixed_capsules(uint32_t leaf, float time, Maybe<Capsules>& found) const {
    Capsules& room = found.emplace();
    const StepShare step = step_share(time, strands_->steps());
    const Capsules* from = &capsules_[leaf * strands_->steps() + step.first];
    const Capsules& to = from[1];
    const auto share = static_cast<float>(step.share);
    const auto mix = [share](const float(&a)[Capsules::kMost], const float(&b)[Capsules::kMost], float* out) {
        for (uint32_t lane = 0; lane < Capsules::kMost; ++lane) out[lane] = a[lane] + (b[lane] - a[lane]) * share;
    };
    for (int axis = 0; axis < 3; ++axis) {
        mix(from->begin[axis], to.begin[axis], room.begin[axis]);
        mix(from->way[axis], to.way[axis], room.way[axis]);
    }
    mix(from->radius, to.radius, room.radius);
    room.count = from->count;
    return room;
}

void StrandScene::set_capsule(Capsules& capsules, uint32_t lane, const Piece& piece, float time) const {
    StrandSegment curve;
    if (strands_->form() == StrandForm::Spheres)
        curve.points.fill(ball(piece, time));
    else
        curve = segment_of(piece, time).part(piece.level, piece.index);
    const std::array<StrandPoint, 4>& p = curve.points;
    // |C - chord| <= max|C''| / 8, and |C''| <= 6 max|second difference|.
    const double bend =
        std::max(axis_point(p[0] - p[1] * 2.0 + p[2]).length(), axis_point(p[1] - p[2] * 2.0 + p[3]).length());
    const double radius = std::max(std::max(p[0].w, p[1].w), std::max(p[2].w, p[3].w));
    for (int axis = 0; axis < 3; ++axis) {
        capsules.begin[axis][lane] = static_cast<float>(p[0][axis]);
        capsules.way[axis][lane] = static_cast<float>(p[3][axis] - p[0][axis]);
    }
    capsules.radius[lane] = static_cast<float>(radius + 0.75 * bend + kBoxPadding);
}

uint16_t StrandScene::split_level(const StrandSegment& segment) const {
    std::array<StrandSegment, 1u << kMostHalvings> parts;  // of the level, spread evenly
    parts[0] = segment;
    double area = half_area(segment.bounds());
    for (uint16_t level = 0; level < kMostHalvings; ++level) {
        const size_t whole = parts.size() >> level, half = whole / 2;
        double halved = 0.0;
        for (size_t i = 0; i < parts.size(); i += whole) {
            parts[i].halve(parts[i], parts[i + half]);
            halved += half_area(parts[i].bounds());
            halved += half_area(parts[i + half].bounds());
        }
        if (!(halved < kWorthHalving[level] * area)) return level;
        area = halved;
    }
    return kMostHalvings;
}

StrandPoint StrandScene::ball(const Piece& piece, float time) const {
    return segment_of(piece, time).at(static_cast<double>(piece.index) / strands_->spheres_per_segment());
}

Box3f StrandScene::float_box(const Piece& piece, float time) const {
    const Box3d box = box_at(piece, time);
    const Vec3f padding(static_cast<float>(kBoxPadding));
    return {Vec3f(box.min) - padding, Vec3f(box.max) + padding};
}

Box3d StrandScene::box_at(const Piece& piece, float time) const {
    if (strands_->form() != StrandForm::Spheres) return segment_of(piece, time).part(piece.level, piece.index).bounds();
    const StrandPoint center = ball(piece, time);
    return {axis_point(center) - Vec3d(center.w), axis_point(center) + Vec3d(center.w)};
}

}  // namespace rayleaf
