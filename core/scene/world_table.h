// The table by which a scene's world is importance sampled: made of the world's program, and kept by its content.
#pragma once

#include "base/cancel.h"
#include "lights/world_light.h"
#include "scene/description.h"
#include "shading/inputs.h"

#include <memory>

namespace rayleaf {

/// `inputs` are those of the world's program but for the direction; `most`: no wider than this. Throws Cancelled soon
/// after `cancel` says so.
std::shared_ptr<const WorldLight> world_table(const SceneDescription& description, const ShadingInputs& inputs,
                                              int most, WorldShare share, const CancelToken& cancel);

}  // namespace rayleaf
