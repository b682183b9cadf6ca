// Edits: what is replaced keeps its index, so that the rest of a description need not be made again.
#pragma once

#include "scene/description.h"

#include <span>

namespace rayleaf {

/// A description with nothing in it, where names of attributes and textures have the ids that they have in `scene`.
SceneDescription emptied(const SceneDescription& scene);

// Each throws InputError and leaves the scene as it was, where something is not there or cannot be.
void replace_shape(SceneDescription& scene, int index, std::shared_ptr<const Shape> shape);
void replace_material(SceneDescription& scene, int index, Material material);
/// Moves instances; all or none.
void place_instances(SceneDescription& scene, std::span<const int32_t> indices, std::span<const Affine3d> places);

/// Whether two scenes are known to look alike, cameras aside: the very same shapes, equal programs, and equal values of
/// all else. False where it is not known.
bool shows_same(const SceneDescription& a, const SceneDescription& b);

}  // namespace rayleaf
