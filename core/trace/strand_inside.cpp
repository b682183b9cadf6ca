// Whether rays are inside strands: where they leave those that they start in.
#include "trace/strand_query.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace rayleaf {

/// Whether pieces beside this one hold a place at a distance along the ray.
bool StrandScene::neighbours_hold(const Query& query, const Piece& piece, double distance) const {
    const auto holds = [distance](const StrandSpan& span) { return span.enter < distance && distance < span.leave; };
    for (const int end : {-1, 1}) {
        const std::optional<StrandSegment> other = beside(query, piece, end);
        if (!other) continue;
        const StrandSpans found = round_spans(*other);
        if (std::any_of(found.spans.begin(), found.spans.begin() + found.count, holds)) return true;
    }
    return false;
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
    tree_.alone(0, position, query.float_frame.along, query.ray->time, &reach, {visit_holders, &query});
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

}  // namespace rayleaf
