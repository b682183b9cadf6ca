// The way each kind of shape is traced.
#pragma once

#include "tessellation/split_plan.h"
#include "trace/shape_scene.h"

#include <memory>

namespace rayleaf {

/// Builds what a shape is traced by; the tolerance is for shapes that are diced.
std::unique_ptr<ShapeScene> make_scene(const Shape& shape, const FacetTolerance& tolerance, const CancelToken& cancel);

}  // namespace rayleaf
