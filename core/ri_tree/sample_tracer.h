// One output ray by tracing: the samples of a ray cache, and the answers where it does not interpolate.
//
// The tracer's world is the shape's local space, so samples depend on the shape and its material only: not on camera,
// instance or frame. Facets are as fine as `facet_tolerance` everywhere. Thread-safe; an answer is a pure function of
// the ray.
#pragma once

#include "ri_tree/output_ray.h"
#include "ri_tree/patch_classes.h"
#include "ri_tree/path_changes.h"
#include "trace/tracer.h"

#include <memory>

namespace rayleaf {

/// Default distance between facets and surface, local units.
inline constexpr double kDefaultFacetTolerance = 0x1p-16;

struct SampleSettings {
    OutputKind kind = OutputKind::Mirror;
    double ior = 1.45;  ///< Glass: index of refraction inside over that outside; above 0
    /// Glass: paths of more hits from inside are cut off; 1 to kMostInteriorHits. Long paths are few, but take most of
    /// the time, and change with the line so fast that nothing can be interpolated.
    int most_interior_hits = kMostInteriorHits;
    double facet_tolerance = kDefaultFacetTolerance;
};

class SampleTracer {
  public:
    /// Throws InputError for invalid settings, and Cancelled soon after `cancel` is set.
    SampleTracer(std::shared_ptr<const Shape> shape, const SampleSettings& settings,
                 const CancelToken& cancel = kNeverCancelled);

    const Shape& shape() const { return *shape_; }
    const SampleSettings& settings() const { return settings_; }
    const PatchClasses& classes() const { return classes_; }

    /// The output ray of a ray in local space, from its origin on; its direction is unit. Glass: a ray must start
    /// outside. Volume: one that starts inside counts from there. A miss has the class of a miss.
    OutputRay trace(const Ray& ray) const;
    /// The same, and its derivatives for those of the ray at its origin. On triangles the normal's derivative is known
    /// only where they have texture coordinates.
    OutputRay trace(const Ray& ray, const RayChanges& ray_changes, OutputChanges& changes) const;
    /// Class of the patch hit first, without following the path.
    uint32_t first_hit_class(const Ray& ray) const;
    /// Memory for tracing, without the shape itself.
    uint64_t bytes() const;

  private:
    std::shared_ptr<const Shape> shape_;
    SampleSettings settings_;
    PatchClasses classes_;
    Tracer tracer_;

    struct Point;

    Point point_at(const Ray& ray, const Hit& hit) const;
    template <typename Changes>
    OutputRay trace_path(const Ray& ray, Changes& changes) const;
    template <typename Changes>
    void follow_glass(const Ray& ray, const Point& first, OutputRay& out, Changes& changes) const;
    template <typename Changes>
    void measure_length(const Ray& ray, const Hit& first, OutputRay& out, Changes& changes) const;
};

}  // namespace rayleaf
