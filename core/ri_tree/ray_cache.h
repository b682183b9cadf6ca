// A ray cache: asked with rays against one object, it answers each by interpolation or by tracing, and says which.
//
// The cache belongs to a shape and its material; rays and answers are in object space. A mirror's answers hold for
// every instance (reflect about the transformed normal); glass refracts alike only where an instance neither shears nor
// scales its axes differently.
//
// Where a line is not a ray. A tree is over whole lines, a ray starts somewhere. Rays that start outside the box are
// lines. For those inside it: a line without any hit has none for any origin, and an interpolated first hit counts if
// it lies beyond the origin by more than its error; all others are traced (in a trial the line's answer was wrong for
// 13 to 44 % of origins inside the box). Two things only the caller knows: a ray that starts inside glass must not ask,
// and a ray that leaves a convex object need not.
#pragma once

#include "rays/hit.h"
#include "rays/ray.h"
#include "rays/ray_differential.h"
#include "ri_tree/output_ray.h"
#include "ri_tree/sample_tracer.h"

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace rayleaf {

/// How a ray was answered.
enum class AnsweredBy : uint8_t {
    NotARay,               ///< not finite, or without a direction: a miss
    BoxMissed,             ///< the ray does not enter the object's box
    CellMissed,            ///< none of the cell's lines hits the object
    Interpolated,          ///< from all corners: one class
    TwoClassInterpolated,  ///< two classes: from the corners of the one that the ray hits first
    TwoClassMissed,        ///< two classes: the test of the first hit found none, or planes part the ray from the body
    Followed,              ///< no cell answers: followed through a convex body from one crossing to the next
    TracedManyClasses,     ///< more than two classes, classes that the first hit cannot tell apart, or flat facets
    TracedFewCorners,      ///< too few corners of the class
    TracedAngle,           ///< directions at the corners differ by more than the angular threshold
    TracedOrigin,          ///< starts inside the box, and the interpolated hit is not surely beyond
    TracedLargeCell,       ///< no corner hits, but the cell is too large to trust that
    TracedNotWorthIt,      ///< too few of the frame's rays cross the cell to pay for its samples
    TracedError            ///< a cell of the depth limit is not close enough
};
inline constexpr size_t kAnswerKinds = 14;
/// "interpolated", ... in the order of the enum, for statistics.
std::span<const char* const> answer_names();
inline bool is_traced(AnsweredBy by) {
    return by >= AnsweredBy::TracedManyClasses;
}

/// Object space.
struct CachedAnswer {
    OutputRay output;
    AnsweredBy by = AnsweredBy::NotARay;
    /// Estimated error where interpolated from all corners: the distance (output_ray.h) at the cell's centre, as a
    /// share of the box's half extent. Followed: what single precision makes of it. 0 elsewhere.
    double error = 0;
    /// Of that, what the points are off by where the line first hits and where the path leaves.
    double position_error = 0;
};

struct RayCacheStatistics {
    std::array<uint64_t, kAnswerKinds> answers{};
    uint64_t samples_taken = 0;  ///< rays traced to fill cells
    uint64_t samples = 0;        ///< held now
    uint64_t nodes = 0;          ///< cells held now, inner ones included
    uint64_t leaves = 0;         ///< final ones among them
    uint64_t bytes = 0;          ///< held now
    uint64_t most_bytes = 0;     ///< ever held
    uint64_t prunes = 0;
    uint64_t tracer_bytes = 0;  ///< of what traces its samples: facets and their tree. No part of the cache size
};

/// Answers by what they cost. Queries are all of them; missed are those that entered the box and hit nothing, known
/// without tracing.
struct RayCacheTotals {
    uint64_t queries = 0, interpolated = 0, followed = 0, traced = 0, missed = 0;
};
RayCacheTotals totals_of(const RayCacheStatistics& statistics);

/// What the artist sets; RI, section 3.2.
struct RayCacheSettings {
    /// Largest distance (output_ray.h) between the true and the interpolated output ray at a cell's centre, as a share
    /// of the box's half extent. The paper's is in the units of its scenes.
    double distance_threshold = 0.01;
    /// Corners whose output directions differ by more, radians, are not interpolated.
    double angle_threshold = kPi / 6.0;
    /// A cell of this depth is final whatever its error.
    int depth_limit = 28;
    uint64_t cache_bytes = 100'000'000;
    /// The share of the cache size that a pruning frees.
    double pruned_share = 0.7;
    /// Largest angle between the true and the interpolated output direction where a cell is tested, radians. The fast
    /// tree's alone; the paper has no such threshold.
    double direction_threshold = kPi / 180.0;
    /// A cell of several classes of this depth is final: its lines are traced. The fast tree's alone.
    int mixed_depth_limit = 28;
    /// So many of a frame's rays must cross a cell for it to be sampled, or half as many in all earlier frames; 0:
    /// all cells are. The fast tree's alone. A new cell takes 5 to 10 samples, each 1.3 to 2 times the time of a traced
    /// ray.
    double rays_per_cell = 8.0;

    bool operator==(const RayCacheSettings&) const = default;
};

/// The fast tree's thresholds in terms of one number: the mean distance of RGB values, in [0, 1], that a mirror or
/// glass may be off by in surroundings of some detail. Throws InputError unless it is above 0 and finite.
///
/// Measured (tests/bench, mirror sheet and gentle glass, 600 x 600), error and speed-up of first and repeated frames
/// over tracing:
///     0.0025    0.0007  2.7  7.5    0.0003  1.3  2.4
///     0.005     0.0019  3.4  8.0    0.0006  1.4  2.6
///     0.01      0.0050  3.8  8.1    0.0014  1.5  2.6
///     0.02      0.012   3.8  8.0    0.0026  1.5  2.6
RayCacheSettings quality_settings(double error);

/// Whether a ray is finite and has a direction.
inline bool is_ray(const Ray& ray) {
    return is_finite(ray.origin) && is_finite(ray.direction) && max_abs(ray.direction) > 0.0;
}

/// The settings themselves; throws InputError, in the name of the shape, for those without meaning.
const RayCacheSettings& checked(const std::string& name, const RayCacheSettings& settings);

/// How far the rays of one frame that are neighbours of a ray lie from it at the object, object space: what tells how
/// many of them will cross a cell. Zeros: as close as can be, so that every cell is worth its samples.
struct RaySpacing {
    float distance = 0;  ///< object units
    float angle = 0;     ///< radians
};

/// What becomes of rays that cannot be interpolated.
enum class Uninterpolated : uint8_t {
    Trace,  ///< traced by the cache
    Leave   ///< said to be traced, and left to the caller: the output is that of a miss
};

/// Rays in object space; `t_min` and `t_max` are not looked at: answers are for everything beyond the origin.
struct RayQuestions {
    std::span<const Ray> rays;
    std::span<const RaySpacing> spacings;  ///< one a ray, or none: zeros
    Uninterpolated others = Uninterpolated::Trace;
    /// How the rays change with a picture's x and y, object space: one a ray, or none, where nobody asks how answers
    /// do.
    std::span<const RayDifferential> differentials;
};

class RayCache {
  public:
    virtual ~RayCache() = default;

    /// What is answered depends on ray, spacing, shape, material and settings, and on which cells the rays of earlier
    /// frames crossed (`next_frame`): not on rays asked before in this frame, nor on the cache size. `changes`, object
    /// space, has one entry a differential; only of what the fast tree interpolates they are known.
    virtual void ask(const RayQuestions& questions, std::span<CachedAnswer> answers, std::span<HitChanges> changes) = 0;
    void ask(std::span<const Ray> rays, std::span<const RaySpacing> spacings, std::span<CachedAnswer> answers) {
        ask({rays, spacings, Uninterpolated::Trace, {}}, answers, {});
    }
    /// The same question answered by tracing alone. Thread-safe.
    virtual OutputRay trace(const Ray& object_ray) const = 0;
    virtual RayCacheStatistics statistics() const = 0;
    /// Tells that a frame is complete, and that the cache is kept for another. No other thread asks meanwhile.
    virtual void next_frame() {}
};

}  // namespace rayleaf
