#include "trace/strand_scene.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace rayleaf {
namespace {

/// How far single precision may move a place along a ray, local units.
constexpr float kAlongError = 0x1p-18f;

/// So few rays are parted at once.
constexpr int kFewStrandRays = 2;

enum class Crossing : uint8_t { Enters, Leaves };

/// A strand that the start of a ray lies in, and where the ray leaves it.
struct StrandExit {
    uint32_t strand = 0;
    StrandLeave place;
};

}  // namespace

/// One ray on its way through the pieces.
struct StrandScene::Query {
    const StrandScene* scene = nullptr;
    const LocalRay* ray = nullptr;
    StrandRay frame;
    CapsuleRay float_frame;
    ShapeHit best;
    double begin = 0;     ///< the true start in the frame, and a little beyond: the rounding of t
    double farthest = 0;  ///< t of the best hit, or the ray's t_max
    Crossing best_crossing = Crossing::Enters;
    bool found = false;
    bool any;                       ///< whether one hit is enough
    std::vector<StrandExit> exits;  ///< of the strands that the ray starts in

    // What `find_holding` looks for and finds.
    uint32_t wanted_strand = 0;
    double wanted_distance = 0;
    bool holds = false;
    StrandLeave last;

    Query(const StrandScene& strand_scene, const LocalRay& local, Wanted wanted)
        : scene(&strand_scene),
          ray(&local),
          frame(local.origin + local.direction * local.start, local.direction / local.speed),
          float_frame{Vec3f(frame.origin), Vec3f(frame.across_x), Vec3f(frame.across_y), Vec3f(frame.along)},
          begin((local.t_min - local.start) * local.speed + kBackstep),
          farthest(local.t_max),
          any(wanted == Wanted::Any) {}

    /// How far the ray needs to be followed still, as the tree sees it.
    float float_farthest() const { return found && any ? kDone : ray->float_distance(farthest); }
    double t_of(double along) const { return ray->start + along / ray->speed; }

    /// Takes a hit if it is the nearest so far.
    void offer(const FacetId& facet, double s, double along, Crossing crossing) {
        if (crossing == Crossing::Leaves && !scene->strands_->has_inside()) return;
        const double t = t_of(along);
        if (!(t >= ray->t_min && t <= farthest)) return;
        if (found && t == farthest && best.facet < facet) return;
        best.facet = facet;
        best.point.t = t;
        best.point.u = s;
        best.point.position = frame.origin + frame.along * along;
        farthest = t;
        found = true;
        best_crossing = crossing;
    }
    /// Takes back all hits, but those that leave.
    void restart() {
        found = false;
        farthest = ray->t_max;
        for (const StrandExit& exit : exits) offer(exit.place, Crossing::Leaves);
    }
    void offer(const StrandLeave& place, Crossing crossing) { offer(place.facet, place.s, place.distance, crossing); }
    /// Whether the ray starts in a strand and a place lies before it has left it.
    bool starts_before_exit(uint32_t strand, double t) const {
        const StrandExit* exit = exit_of(strand);
        return exit != nullptr && t <= t_of(exit->place.distance);
    }
    const StrandExit* exit_of(uint32_t strand) const {
        const auto at =
            std::find_if(exits.begin(), exits.end(), [strand](const StrandExit& e) { return e.strand == strand; });
        return at == exits.end() ? nullptr : &*at;
    }
};

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

/// Pieces and their points lie anywhere in memory, so they are fetched as soon as it is known where they are.
void StrandScene::meet_leaf(const Query& query, uint32_t leaf, float farthest, MetPieces& met) const {
    prefetch_lines(&pieces_[leaf], sizeof(LeafPieces));
    Maybe<Capsules> room;
    const Capsules& capsules = this->capsules(leaf, query.ray->time, room);
    met.lanes = meet_capsules_(capsules, query.float_frame, {-kAlongError, farthest}, met.nears);
    for_each_lane(met.lanes, [&](size_t lane) { strands_->prefetch(pieces_[leaf].of[lane].place); });
}

/// The nearest first: a hit rules out those behind it.
void StrandScene::visit_pieces(Query& query, uint32_t leaf, const MetPieces& met, float& farthest) const {
    for (uint32_t lanes = met.lanes; lanes != 0;) {
        auto nearest = static_cast<uint32_t>(__builtin_ctz(lanes));
        for_each_lane(lanes, [&](size_t lane) {
            if (met.nears[lane] < met.nears[nearest]) nearest = static_cast<uint32_t>(lane);
        });
        lanes &= ~(1u << nearest);
        if (!(met.nears[nearest] <= farthest)) return;
        visit(query, pieces_[leaf].of[nearest]);
        if (query.found) farthest = query.float_farthest();
    }
}

void StrandScene::visit(Query& query, const Piece& piece) const {
    if (strands_->form() == StrandForm::Ribbon) {
        visit_ribbon(query, piece);
        return;
    }
    const StrandSpans found = spans(query, piece, query.begin);
    for (int i = 0; i < found.count; ++i) {
        const StrandSpan& span = found.spans[i];
        if (query.t_of(span.enter) >= query.ray->t_min)
            enter(query, piece, span);
        else if (query.t_of(span.leave) >= query.ray->t_min)
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
    // Whoever wants any hit stops at this one, so it must be known now whether it lies inside the strand.
    if (query.any || !query.exits.empty()) {
        const uint32_t strand = strands_->strand_of(piece.segment);
        const bool knows_exit = query.any ? starts_inside(query, strand) : query.exit_of(strand) != nullptr;
        if (knows_exit && query.starts_before_exit(strand, t)) return;
    }
    query.offer({piece.segment, piece.index}, place_of(piece, span.s_enter), span.enter, Crossing::Enters);
}

/// The ray starts in this strand: follows it through all pieces that hold it to where it leaves.
void StrandScene::follow_out(Query& query, uint32_t strand, StrandLeave place) const {
    if (query.exit_of(strand) != nullptr) return;
    while (find_holding(query, strand, place.distance)) place = query.last;
    // Where two pieces share a ball, both are left there: the first of them counts, whichever was met before.
    const double just_before = std::nextafter(place.distance, -std::numeric_limits<double>::infinity());
    if (find_holding(query, strand, just_before) && query.last.distance == place.distance &&
        query.last.facet < place.facet)
        place = query.last;
    query.exits.push_back({strand, place});
    query.offer(place, Crossing::Leaves);
}

/// Whether the ray starts inside the strand; if so, its exit is known then.
bool StrandScene::starts_inside(Query& query, uint32_t strand) const {
    if (query.exit_of(strand) != nullptr) return true;
    if (query.ray->start >= query.ray->t_min) return false;  // it starts outside the whole shape
    const double begin = (query.ray->t_min - query.ray->start) * query.ray->speed;
    if (!find_holding(query, strand, begin)) return false;
    follow_out(query, strand, query.last);
    return true;
}

/// Whether pieces of a strand hold the place at a distance along the ray; `last` is then the one that is left last.
bool StrandScene::find_holding(Query& query, uint32_t strand, double distance) const {
    query.wanted_strand = strand;
    query.wanted_distance = distance;
    query.holds = false;
    const Vec3f position(query.frame.origin + query.frame.along * distance);
    const auto visit_holders = [](void* owner, uint32_t leaf, uint32_t, float*) {
        Query& asked = *static_cast<Query*>(owner);
        asked.scene->visit_holding(asked, leaf);
    };
    float reach = kAlongError;
    tree_.alone(position, query.float_frame.along, query.ray->time, &reach, {visit_holders, &query});
    return query.holds;
}

void StrandScene::visit_holding(Query& query, uint32_t leaf) const {
    Maybe<Capsules> room;
    const Capsules& capsules = this->capsules(leaf, query.ray->time, room);
    const auto place = static_cast<float>(query.wanted_distance);
    float nears[Capsules::kMost];
    const uint32_t met = meet_capsules_(capsules, query.float_frame, {place - kAlongError, place + kAlongError}, nears);
    for_each_lane(met, [&](size_t lane) { hold(query, pieces_[leaf].of[lane]); });
}

void StrandScene::hold(Query& query, const Piece& piece) const {
    if (strands_->strand_of(piece.segment) != query.wanted_strand) return;
    const FacetId facet{piece.segment, piece.index};
    const StrandSpans found = spans(query, piece, std::numeric_limits<double>::infinity());
    for (int i = 0; i < found.count; ++i) {
        const StrandSpan& span = found.spans[i];
        if (!(span.enter <= query.wanted_distance && query.wanted_distance < span.leave)) continue;
        const bool further = !query.holds || span.leave > query.last.distance ||
                             (span.leave == query.last.distance && facet < query.last.facet);
        if (further) query.last = {facet, place_of(piece, span.s_leave), span.leave};
        query.holds = true;
    }
}

/// Whether the axis, past an end of a piece, comes no nearer to the ray: it ends there, cut straight, or runs on.
bool StrandScene::is_nearest_at_end(const Query& query, const Piece& piece, const StrandSegment& in_frame,
                                    int end) const {
    uint32_t segment = piece.segment;
    int64_t index = int64_t{piece.index} + end;
    uint16_t level = piece.level;
    if (index < 0 || index >= int64_t{1} << level) {
        const std::optional<uint32_t> next = strands_->neighbour(segment, end);
        if (!next) return false;
        segment = *next;
        level = 0;
        index = 0;
    }
    const StrandSegment other =
        query.frame.to_frame(strands_->segment(segment, query.ray->time)).part(level, static_cast<uint32_t>(index));
    const StrandPoint direction = other.derivative(end > 0 ? 0.0 : 1.0);
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

void StrandScene::find(const LocalRay& ray, Query& query) const {
    if (tree_.empty()) return;
    const auto visit_one = [](void* owner, uint32_t leaf, uint32_t, float* farthest) {
        Query& asked = *static_cast<Query*>(owner);
        MetPieces met;
        asked.scene->meet_leaf(asked, leaf, *farthest, met);
        asked.scene->visit_pieces(asked, leaf, met, *farthest);
    };
    for (;;) {
        float farthest = ray.float_distance(query.farthest);
        tree_.alone(ray.float_origin, ray.float_direction, ray.time, &farthest,
                    {visit_one, &query, capsules_.data(), static_cast<uint32_t>(sizeof(Capsules) * strands_->steps())});
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
            queries[lane].emplace(scene, ray, wanted);
        });
    }
};

void StrandScene::find(PacketQuery& packet, Wanted wanted) const {
    packet.found = 0;
    if (tree_.empty()) return;
    Packet asked(*this, packet, wanted);
    const auto visit_lanes = [](void* owner, uint32_t leaf, uint32_t lanes, float* farthest) {
        Packet& all = *static_cast<Packet*>(owner);
        std::array<MetPieces, kPacketSize> met;
        for_each_lane(lanes, [&](size_t lane) {
            const Query& query = *all.queries[lane];
            if (farthest[lane] >= 0.0f) query.scene->meet_leaf(query, leaf, farthest[lane], met[lane]);
        });
        for_each_lane(lanes, [&](size_t lane) {
            Query& query = *all.queries[lane];
            query.scene->visit_pieces(query, leaf, met[lane], farthest[lane]);
        });
    };
    alignas(64) float farthest[kPacketSize] = {};
    for (uint32_t lanes = packet.lanes; lanes != 0;) {
        for_each_lane(lanes, [&](size_t lane) {
            farthest[lane] = asked.rays[lane]->float_distance(asked.queries[lane]->farthest);
        });
        tree_.packet(
            packet.rays, packet.times, lanes, kFewStrandRays, farthest,
            {visit_lanes, &asked, capsules_.data(), static_cast<uint32_t>(sizeof(Capsules) * strands_->steps())});
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
