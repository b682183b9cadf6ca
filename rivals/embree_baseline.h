// Embree alone with the same facets: the baseline for measurements of tracing.
#pragma once

#include "geometry/patch_surface.h"
#include "geometry/triangle_mesh.h"
#include "rays/ray.h"
#include "trace/embree.h"
#include "trace/tracer.h"

#include <cstdint>

namespace rayleaf {

enum class EmbreePrimitive : uint8_t { Grid, Triangle };

/// All facets of a tracer's patches as primitives of Embree: all grids at once, best quality, robust.
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

}  // namespace rayleaf
