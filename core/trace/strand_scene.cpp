#include "trace/strand_query.h"

#include <algorithm>
#include <limits>
#include <optional>

namespace rayleaf {

StrandSpans StrandScene::spans(const Query& query, const Piece& piece, double needs_leave_before) const {
    if (strands_->form() == StrandForm::Spheres) {
        const StrandSegment in_frame = query.frame.to_frame(segment_of(piece, query.ray->time));
        StrandSpans result;
        if (const auto span =
                ball_span(in_frame.at(static_cast<double>(piece.index) / strands_->spheres_per_segment())))
            result.add(*span);
        return result;
    }
    return round_spans(query.frame.to_frame(segment_of(piece, query.ray->time)).part(piece.level, piece.index),
                       needs_leave_before);
}

/// Pieces and their points lie anywhere in memory, so they are fetched as soon as it is known where they are. Those
/// that the ray meets first are visited first: a hit rules out those behind it.
void StrandScene::visit_leaf(Query& query, uint32_t leaf, float& farthest) const {
    const LeafPieces& pieces = pieces_[leaf];
    prefetch_lines(&pieces, sizeof(pieces));
    Maybe<Capsules> room;
    const Capsules& capsules = this->capsules(leaf, query.ray->time, room);
    float nears[Capsules::kMost];
    uint32_t met = meet_capsules_(capsules, query.float_frame, {-kAlongError, farthest}, nears);
    for_each_lane(met, [&](size_t lane) { strands_->prefetch(pieces.of[lane].place); });
    while (met != 0) {
        auto nearest = static_cast<uint32_t>(__builtin_ctz(met));
        for_each_lane(met, [&](size_t lane) {
            if (nears[lane] < nears[nearest]) nearest = static_cast<uint32_t>(lane);
        });
        met &= ~(1u << nearest);
        if (!(nears[nearest] <= farthest)) return;
        visit(query, pieces.of[nearest]);
        if (query.found) farthest = query.float_farthest();
    }
}

void StrandScene::visit(Query& query, const Piece& piece) const {
    if (piece.segment == query.own_segment) return;
    if (strands_->form() == StrandForm::Ribbon) {
        visit_ribbon(query, piece);
        return;
    }
    constexpr double kNever = -std::numeric_limits<double>::infinity();
    const StrandSpans found = spans(query, piece, query.knows_start() ? kNever : query.begin);
    for (int i = 0; i < found.count; ++i) {
        const StrandSpan& span = found.spans[i];
        if (query.t_of(span.enter) >= query.ray->t_min)
            enter(query, piece, span);
        else if (!query.knows_start() && query.t_of(span.leave) >= query.ray->t_min)
            follow_out(query, strands_->strand_of(piece.segment),
                       {{piece.segment, piece.index}, place_of(piece, span.s_leave), span.leave});
    }
}

/// The parameter along the segment of one along a piece.
double StrandScene::place_of(const Piece& piece, double s) const {
    if (strands_->form() == StrandForm::Spheres)
        return static_cast<double>(piece.index) / strands_->spheres_per_segment();
    return (piece.index + s) / static_cast<double>(1u << piece.level);
}

void StrandScene::enter(Query& query, const Piece& piece, const StrandSpan& span) const {
    const double t = query.t_of(span.enter);
    if (t > query.farthest) return;
    if (query.knows_start()) {
        if (strands_->strand_of(piece.segment) == query.own_strand && neighbours_hold(query, piece, span.enter)) return;
        query.offer({piece.segment, piece.index}, place_of(piece, span.s_enter), span.enter, Crossing::Enters);
        return;
    }
    // Whoever wants any hit stops at this one, so it must be known now whether it lies inside the strand.
    if (query.any || !query.exits.empty()) {
        const uint32_t strand = strands_->strand_of(piece.segment);
        const bool knows_exit = query.any ? starts_inside(query, strand) : query.exit_of(strand) != nullptr;
        if (knows_exit && query.starts_before_exit(strand, t)) return;
    }
    query.offer({piece.segment, piece.index}, place_of(piece, span.s_enter), span.enter, Crossing::Enters);
}

std::optional<StrandSegment> StrandScene::beside(const Query& query, const Piece& piece, int end) const {
    const int64_t index = int64_t{piece.index} + end;
    if (index >= 0 && index < int64_t{1} << piece.level)
        return query.frame.to_frame(segment_of(piece, query.ray->time)).part(piece.level, static_cast<uint32_t>(index));
    const std::optional<uint32_t> next = strands_->neighbour(piece.segment, end);
    if (!next) return std::nullopt;
    return query.frame.to_frame(strands_->segment(*next, query.ray->time));
}

/// Whether the axis, past an end of a piece, comes no nearer to the ray: it ends there, cut straight, or runs on.
bool StrandScene::is_nearest_at_end(const Query& query, const Piece& piece, const StrandSegment& in_frame,
                                    int end) const {
    const std::optional<StrandSegment> other = beside(query, piece, end);
    if (!other) return false;
    const StrandPoint direction = other->derivative(end > 0 ? 0.0 : 1.0);
    return recedes(in_frame.points[end > 0 ? 3 : 0], direction, end);
}

void StrandScene::visit_ribbon(Query& query, const Piece& piece) const {
    const StrandSegment curve = query.frame.to_frame(segment_of(piece, query.ray->time)).part(piece.level, piece.index);
    const RibbonHits found = ribbon_hits(curve);
    for (int i = 0; i < found.count; ++i) {
        const RibbonHit& hit = found.hits[i];
        if (hit.end != 0 && !is_nearest_at_end(query, piece, curve, hit.end)) continue;
        query.offer({piece.segment, piece.index}, place_of(piece, hit.s), hit.distance, Crossing::Enters);
    }
}

/// Whether the best hit is an entry inside a strand that the ray was then found to start in.
bool StrandScene::is_inside(const Query& query) const {
    return query.found && query.best_crossing == Crossing::Enters && !query.exits.empty() &&
           query.starts_before_exit(strands_->strand_of(query.best.facet.primitive), query.farthest);
}

BoxVisitor StrandScene::visitor(BoxVisitor::Visit at_leaf, void* owner) const {
    return {at_leaf, owner, capsules_.data(), static_cast<uint32_t>(sizeof(Capsules) * strands_->steps())};
}

void StrandScene::find(const LocalRay& ray, Query& query) const {
    if (tree_.empty()) return;
    const auto visit_one = [](void* owner, uint32_t leaf, uint32_t, float* farthest) {
        Query& asked = *static_cast<Query*>(owner);
        asked.scene->visit_leaf(asked, leaf, *farthest);
    };
    for (;;) {
        float farthest = ray.float_distance(query.farthest);
        tree_.alone(0, ray.float_origin, ray.float_direction, ray.time, &farthest, visitor(visit_one, &query));
        if (query.any || !is_inside(query)) return;
        query.restart();
    }
}

bool StrandScene::closest(const LocalRay& ray, ShapeHit& hit) const {
    Query query(*this, ray, Wanted::Closest);
    find(ray, query);
    if (!query.found) return false;
    set_normal(query);
    hit = query.best;
    return true;
}

bool StrandScene::occluded(const LocalRay& ray) const {
    Query query(*this, ray, Wanted::Any);
    find(ray, query);
    return query.found;
}

/// The rays of a packet, each as it would be alone.
struct StrandScene::Packet {
    std::array<Maybe<LocalRay>, kPacketSize> rays;
    std::array<std::optional<Query>, kPacketSize> queries;

    Packet(const StrandScene& scene, const PacketQuery& packet, Wanted wanted) {
        for_each_lane(packet.lanes, [&](size_t lane) {
            LocalRay& ray = rays[lane].emplace();
            const RayPacket& from = packet.rays;
            ray.origin = from.origin_of(lane);
            ray.direction = from.direction_of(lane);
            ray.t_min = from.t_min[lane];
            ray.t_max = from.t_max[lane];
            ray.start = from.start[lane];
            ray.speed = from.speed[lane];
            ray.time = packet.times[lane];
            ray.start_facet = from.start_facet[lane];
            queries[lane].emplace(scene, ray, wanted);
        });
    }
};

void StrandScene::find(PacketQuery& packet, Wanted wanted) const {
    packet.found = 0;
    if (tree_.empty()) return;
    Packet asked(*this, packet, wanted);
    const auto visit_one = [](void* owner, uint32_t leaf, uint32_t lanes, float* farthest) {
        const auto lane = static_cast<size_t>(__builtin_ctz(lanes));
        Query& query = *static_cast<Packet*>(owner)->queries[lane];
        query.scene->visit_leaf(query, leaf, farthest[lane]);
    };
    alignas(64) float farthest[kPacketSize] = {};
    for (uint32_t lanes = packet.lanes; lanes != 0;) {
        for_each_lane(lanes, [&](size_t lane) {
            farthest[lane] = asked.rays[lane]->float_distance(asked.queries[lane]->farthest);
        });
        tree_.in_turn(packet.rays, packet.times, lanes, farthest, visitor(visit_one, &asked));
        uint32_t again = 0;
        for_each_lane(lanes, [&](size_t lane) {
            Query& query = *asked.queries[lane];
            if (query.any || !is_inside(query)) return;
            query.restart();
            again |= 1u << lane;
        });
        lanes = again;
    }
    for_each_lane(packet.lanes, [&](size_t lane) {
        Query& query = *asked.queries[lane];
        if (!query.found) return;
        packet.found |= 1u << lane;
        if (wanted == Wanted::Any) return;
        set_normal(query);
        packet.best[lane].emplace(query.best.facet, query.best.point);
    });
}

void StrandScene::find_closest(PacketQuery& packet) const {
    find(packet, Wanted::Closest);
}

void StrandScene::find_any(PacketQuery& packet) const {
    find(packet, Wanted::Any);
}

void StrandScene::set_normal(Query& query) const {
    const FacetId& facet = query.best.facet;
    const double s = query.best.point.u;
    const StrandSegment curve = strands_->segment(facet.primitive, query.ray->time);
    const Vec3d radius = query.best.point.position - axis_point(curve.at(s));
    const Vec3d towards = -query.frame.along;
    if (strands_->form() != StrandForm::Ribbon) {
        query.best.point.normal = normalized_or(radius, towards);
        return;
    }
    const Vec3d tangent = normalized_or(axis_point(curve.derivative(s)), Vec3d(0.0));
    query.best.point.normal = normalized_or(towards - tangent * tangent.dot(towards), towards);
}

LocalHit StrandScene::local_hit(const ShapeHit& hit) const {
    LocalHit local;
    const StrandSegment curve = strands_->segment(hit.facet.primitive, hit.time);
    const double s = std::clamp(hit.point.u, 0.0, 1.0);
    local.primitive = hit.facet.primitive;
    if (is_hair()) local.subpatch = local.facet = hit.facet.primitive;
    local.u = static_cast<float>(s);
    local.position = hit.point.position;
    local.normal = Vec3f(hit.point.normal);
    const Vec3d tangent = normalized_or(axis_point(curve.derivative(s)), Vec3d(0, 0, 1));
    Vec3d around = hit.point.normal;
    if (strands_->form() == StrandForm::Ribbon) {
        // Shaded as the wall of the round strand at the same place across.
        const Vec3d across = hit.point.position - axis_point(curve.at(s));
        const double sine = std::min(across.length() / curve.at(s).w, 1.0);
        around = normalized_or(across, Vec3d(0.0)) * sine + hit.point.normal * std::sqrt(1.0 - sine * sine);
    }
    local.v = s > 0.0 && s < 1.0 ? wall_angle(tangent, around) : kStrandEnd;
    return local;
}

}  // namespace rayleaf
