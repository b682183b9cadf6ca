// A ray cache: answers rays against one object, each by interpolation or by tracing, and says by which.
//
// The cache belongs to a shape and its material; rays and answers are in object space. A mirror's answers hold for
// every instance (reflect about the transformed normal); those of glass only for instances that neither shear nor scale
// their axes differently.
//
// Lines and rays. A cache stores the first hit of a whole line, but a ray has an origin. A ray that starts outside the
// box is a line. For a ray that starts inside: if the line hits nothing, neither does the ray; an interpolated first
// hit is used if it lies beyond the origin by more than its error; all other rays are traced, for their line's first
// hit may lie behind them. Two things only the caller knows: a ray that starts inside glass must not ask, and a ray
// that leaves a convex object need not.
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
    TwoClassMissed,        ///< two classes: the test of the first hit found none
    FollowedMissed,        ///< no cell answers: a plane separates the ray from the convex body
    Followed,              ///< no cell answers: followed through a convex body from one crossing to the next
    TracedManyClasses,     ///< more than two classes, classes that the first hit cannot tell apart, or flat facets
    TracedFewCorners,      ///< too few corners of the class
    TracedAngle,           ///< directions at the corners differ by more than the angular threshold
    TracedOrigin,          ///< starts inside the box, and the interpolated hit is not surely beyond
    TracedLargeCell,       ///< no corner hits, but the cell is too large to trust that
    TracedNotWorthIt,      ///< too few of the frame's rays cross the cell to pay for its samples
    TracedError            ///< a cell of the depth limit is not close enough
};
inline constexpr size_t kAnswerKinds = 15;
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
    uint64_t tracer_bytes = 0;  ///< of the tracer of samples: facets and their tree. Not part of the cache size
};

/// Numbers of answers. Queries are all of them; missed are those that entered the box and hit nothing, found without
/// tracing.
struct RayCacheTotals {
    uint64_t queries = 0, interpolated = 0, followed = 0, traced = 0, missed = 0;
};
RayCacheTotals totals_of(const RayCacheStatistics& statistics);

/// The artist's settings; RI, section 3.2.
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
    /// Largest angle between the true and the interpolated output direction where a cell is tested, radians. Fast tree
    /// only; the paper has no such threshold.
    double direction_threshold = kPi / 180.0;
    /// A cell of several classes of this depth is final: its lines are traced. Fast tree only.
    int mixed_depth_limit = 28;
    /// A cell is sampled if this many of a frame's rays cross it, or half as many did in all earlier frames; 0:
    /// all cells are. Fast tree only. A new cell takes several samples, and shares others with its neighbours; each
    /// takes longer than a traced ray.
    double rays_per_cell = 8.0;

    bool operator==(const RayCacheSettings&) const = default;
};

/// The fast tree's thresholds in terms of one number: the mean distance of RGB values, in [0, 1], that a mirror or
/// glass may be off by in surroundings of some detail. Throws InputError unless it is above 0 and finite.
///
/// The distances grow in proportion to `error`, the angle with its root; per factor of sixteen below the usual error,
/// four more halvings are allowed.
///
/// `./rayleaf bench rays` prints, for several values of `error`, the true error of mirror and glass, and the speed-up
/// over tracing of first and repeated frames. Beyond the usual error the speed-up hardly grows.
///
RayCacheSettings quality_settings(double error);

/// Whether a ray is finite and has a direction.
inline bool is_ray(const Ray& ray) {
    return is_finite(ray.origin) && is_finite(ray.direction) && max_abs(ray.direction) > 0.0;
}

/// Returns the settings; throws InputError, in the given name, if one of them is invalid.
const RayCacheSettings& checked(const std::string& name, const RayCacheSettings& settings);

/// How far the neighbours of a ray in one frame lie from it at the object, object space. The number of rays that cross
/// a cell is estimated from it. Zeros: as close as can be, so that every cell is sampled.
struct RaySpacing {
    float distance = 0;  ///< object units
    float angle = 0;     ///< radians
};

/// What becomes of rays that cannot be interpolated.
enum class Uninterpolated : uint8_t {
    Trace,  ///< traced by the cache
    Leave   ///< reported as traced and left to the caller: the output is that of a miss
};

/// Rays in object space. `t_min` and `t_max` are ignored: answers are for everything beyond the origin.
struct RayQuestions {
    std::span<const Ray> rays;
    std::span<const RaySpacing> spacings;  ///< one a ray, or none: zeros
    Uninterpolated others = Uninterpolated::Trace;
    /// Derivatives of the rays by the picture's x and y, object space: one a ray, or none if those of answers are not
    /// wanted.
    std::span<const RayDifferential> differentials;
};

class RayCache {
  public:
    virtual ~RayCache() = default;

    /// Answers depend on ray, spacing, shape, material and settings, and on the cells that the rays of earlier frames
    /// crossed (`next_frame`), but not on earlier rays of this frame, nor on the cache size. `changes`, object space,
    /// has one entry a differential; they are known only for answers that the fast tree interpolates or follows.
    virtual void ask(const RayQuestions& questions, std::span<CachedAnswer> answers, std::span<HitChanges> changes) = 0;
    void ask(std::span<const Ray> rays, std::span<const RaySpacing> spacings, std::span<CachedAnswer> answers) {
        ask({rays, spacings, Uninterpolated::Trace, {}}, answers, {});
    }
    /// Answers by tracing alone. Thread-safe.
    virtual OutputRay trace(const Ray& object_ray) const = 0;
    virtual RayCacheStatistics statistics() const = 0;
    /// Call it when a frame is complete and the cache is kept for another. No other thread may ask meanwhile.
    virtual void next_frame() {}
};

}  // namespace rayleaf
