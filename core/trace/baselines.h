// What Embree alone would do with the same facets: the measure for the benchmark, used by nothing else.
#pragma once

#include "geometry/patch_surface.h"
#include "geometry/triangle_mesh.h"
#include "rays/ray.h"
#include "trace/embree.h"
#include "trace/tracer.h"

#include <span>
#include <vector>

namespace rayleaf {

enum class EmbreePrimitive : uint8_t { Grid, Triangle };

/// Everything a tracer's patches are diced to, as primitives of Embree: all grids at once, best quality, robust.
class EmbreeBaseline {
  public:
    EmbreeBaseline(const PatchSurface& surface, const DicingView& view, EmbreePrimitive primitive);
    /// A mesh as Embree's triangles.
    explicit EmbreeBaseline(const TriangleMesh& mesh);

    /// t of the nearest hit along a ray in the object's space; infinity without one.
    float closest_t(const Ray& ray) const;
    /// Facet buffers and Embree's tree.
    uint64_t bytes() const { return bytes_; }

  private:
    LocalFrame frame_;
    EmbreeScene scene_;
    uint64_t bytes_ = 0;
};

/// Processor time of this thread, seconds.
double thread_seconds();
/// Traces the rays one after the other; `t` receives the distances. Returns this thread's processor time, seconds.
double time_closest(const Tracer& tracer, std::span<const Ray> rays, std::span<double> t);
double time_closest(const EmbreeBaseline& baseline, std::span<const Ray> rays, std::span<double> t);

}  // namespace rayleaf
