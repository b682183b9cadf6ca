// The space around a shaded point, by rays.
#pragma once

#include "shading/surroundings.h"
#include "trace/tracer.h"

namespace rayleaf {

class TracedSurroundings : public Surroundings {
  public:
    explicit TracedSurroundings(const Tracer& tracer) : tracer_(tracer) {}

    float openness(const SurfacePoint& point, const Openness& asked, const ProbeNumbers& numbers) const override;
    std::optional<Met> cast(const SurfacePoint& point, const Cast& asked) const override;
    Vec3f rounded_normal(const SurfacePoint& point, float radius, int rays, const ProbeNumbers& numbers) const override;

  private:
    const Tracer& tracer_;
};

}  // namespace rayleaf
