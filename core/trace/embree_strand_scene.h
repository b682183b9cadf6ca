// Strands as Embree's own round curves, to compare with: what Embree finds counts as it is, in single precision.
#pragma once

#include "geometry/strands.h"
#include "trace/shape_scene.h"

namespace rayleaf {

class EmbreeStrandScene final : public ShapeScene {
  public:
    EmbreeStrandScene(const Strands& strands, const CancelToken& cancel);

    bool closest(const LocalRay& ray, ShapeHit& hit) const override;
    bool occluded(const LocalRay& ray) const override;
    LocalHit local_hit(const ShapeHit& hit) const override;
    LocalHit on_facet(const LocalHit& hit) const override { return hit; }
    uint64_t strand_pieces() const override { return strands_->element_count(); }

  private:
    const Strands* strands_;
};

}  // namespace rayleaf
