// The surface one pixel step away from a hit, to first order: where operations run again for image footprints.
#pragma once

#include "shading/inputs.h"

namespace rayleaf {

/// Attributes at the neighbours cost several evaluations of the shape, so they are optional.
enum class NeighbourAttributes : uint8_t {
    None,
    ExactIfDeformed,  ///< of shapes that know where they were before they were deformed
    Exact
};

/// The inputs one step to the right and one step up, `width` pixels away. Holds what they point to, so it can neither
/// be copied nor moved.
class Neighbours {
  public:
    Neighbours(const ShadingInputs& inputs, NeighbourAttributes attributes, float width = 1.0f);
    Neighbours(const Neighbours&) = delete;
    Neighbours& operator=(const Neighbours&) = delete;

    const ShadingInputs& right() const { return inputs_[0]; }
    const ShadingInputs& above() const { return inputs_[1]; }

  private:
    SurfacePoint points_[2];
    ShadingInputs inputs_[2];
};

/// Change of the texture coordinate for a step `dp` in space (least squares on the surface's two derivatives); zero
/// where the coordinate has no derivatives.
Vec2f uv_step(const SurfacePoint& point, const Vec3f& dp);

}  // namespace rayleaf
