// The surface one pixel step away from a hit, to first order: where operations run again for image footprints.
#pragma once

#include "shading/inputs.h"

namespace rayleaf {

enum class PixelAxis : uint8_t { X, Y };
/// Named attributes at the neighbour cost several evaluations of the shape, so they are asked for.
enum class NeighbourAttributes : uint8_t { None, Exact };

/// Holds what its inputs point to, so it can neither be copied nor moved.
class Neighbour {
  public:
    Neighbour(const ShadingInputs& inputs, PixelAxis axis, NeighbourAttributes attributes);
    Neighbour(const Neighbour&) = delete;
    Neighbour& operator=(const Neighbour&) = delete;

    const ShadingInputs& inputs() const { return inputs_; }

  private:
    SurfacePoint point_;
    ShadingInputs inputs_;
};

/// Change of the texture coordinate for a step `dp` in space (least squares on the surface's two derivatives); zero
/// where the coordinate has no derivatives.
Vec2f uv_step(const SurfacePoint& point, const Vec3f& dp);

}  // namespace rayleaf
