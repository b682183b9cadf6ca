// Operations that read the point, the object, the camera and the path.
#pragma once

#include "shading/bump.h"
#include "shading/closures.h"
#include "shading/inputs.h"
#include "shading/operands.h"
#include "shading/operation.h"

#include <cstdint>
#include <optional>
#include <span>

namespace rayleaf {

/// Unit shading normal and facet normal on the viewer's side; in the world both point at the viewer.
Vec3f facing_normal(const ShadingInputs& inputs);
Vec3f facing_facet_normal(const ShadingInputs& inputs);
/// True where the back of the surface is seen: on which side the viewer is, the facet decides.
bool is_backfacing(const ShadingInputs& inputs);

/// Value of any operation of the family Input. `variant` and `ints` as the program holds them.
Vec4f input_value(Operation operation, uint8_t variant, const Operands& operands, std::span<const int32_t> ints,
                  const ShadingInputs& inputs);

/// The surface's own normal, facing the viewer, and the position in the object's bounding box; object space.
Vec3f object_normal(const ShadingInputs& inputs);
Vec3f generated(const ShadingInputs& inputs);
/// What the grid of a name holds at a point inside a volume; empty where there is no such grid.
std::optional<Vec4f> grid_value(const ShadingInputs& inputs, int32_t id);
/// A named value of the surface, else of a grid, else of the instance; 0 where none has it.
Vec4f attribute(const ShadingInputs& inputs, int32_t id);

/// The operation `bump`, from heights at the point and its neighbours.
Vec4f bump_value(const Operands& operands, bool inverted, const Heights& heights, const ShadingInputs& inputs,
                 Clearing clearing);

}  // namespace rayleaf
