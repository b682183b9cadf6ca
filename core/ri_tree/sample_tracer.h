// One output ray by tracing: what fills a tree, and what answers where a tree does not.
//
// The tracer's world is the shape's local space, so samples depend on the shape and its material alone: not on camera,
// instance or frame. Facets are as fine as `facet_tolerance` everywhere. Thread-safe; an answer is a pure function of
// the ray.
#pragma once

#include "ri_tree/output_ray.h"
#include "ri_tree/patch_classes.h"
#include "ri_tree/path_changes.h"
#include "trace/tracer.h"

#include <memory>

namespace rayleaf {

/// Distance between facets and surface, local units, unless told otherwise.
inline constexpr double kDefaultFacetTolerance = 0x1p-16;

struct SampleSettings {
    OutputKind kind = OutputKind::Mirror;
    double ior = 1.45;  ///< Glass: index of refraction inside over that outside; above 0
    /// Glass: paths of more hits from inside are cut off; 1 to kMostInteriorHits. The long ones are few, but cost most
    /// of the time, and change with the line so fast that nothing can be interpolated.
    int most_interior_hits = kMostInteriorHits;
    double facet_tolerance = kDefaultFacetTolerance;
};

class SampleTracer {
  public:
    /// Throws InputError for settings without meaning, and Cancelled soon after `cancel` says so.
    SampleTracer(std::shared_ptr<const Shape> shape, const SampleSettings& settings,
                 const CancelToken& cancel = kNeverCancelled);

    const Shape& shape() const { return *shape_; }
    const SampleSettings& settings() const { return settings_; }
    const PatchClasses& classes() const { return classes_; }

    /// The output ray of a ray in local space, from its origin on; its direction is unit. Glass: a ray must start
    /// outside. Volume: one that starts inside counts from there. A miss has the class of a miss.
    OutputRay trace(const Ray& ray) const;
    /// The same, and how it changes if the ray changes so at its origin. Of triangles the normal's change is known only
    /// where they have texture coordinates.
    OutputRay trace(const Ray& ray, const RayChanges& ray_changes, OutputChanges& changes) const;
    /// Class of the patch hit first, without following the path.
    uint32_t first_hit_class(const Ray& ray) const;
    /// Held for tracing, beside the shape itself.
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
