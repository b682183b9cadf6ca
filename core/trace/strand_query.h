// One ray on its way through the pieces of strands (trace/strand_scene.h).
#pragma once

#include "trace/strand_scene.h"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace rayleaf {

/// How far single precision may move a place along a ray, local units.
inline constexpr float kAlongError = 0x1p-18f;

enum class Crossing : uint8_t { Enters, Leaves };

/// A strand that the start of a ray lies in, and where the ray leaves it.
struct StrandExit {
    uint32_t strand = 0;
    StrandLeave place;
};

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
    /// Of hair, the segment that it starts on, which it does not meet, and its strand.
    uint32_t own_segment = RayAnchor::kNone, own_strand = RayAnchor::kNone;

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
          any(wanted == Wanted::Any) {
        if (local.start_facet >= scene->strands_->element_count()) return;
        own_segment = local.start_facet;
        own_strand = scene->strands_->strand_of(own_segment);
    }
    bool knows_start() const { return own_segment != RayAnchor::kNone; }

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

}  // namespace rayleaf
