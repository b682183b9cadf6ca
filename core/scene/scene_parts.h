// What is made of a scene's content and can be used again: by the next frame, by another view, after an edit. Who
// renders more than once makes one and gives it to each description; without, every render makes all anew.
//
// Everything here is identified by its content, so that changes need not be announced, and a picture has the same
// bits with and without.
#pragma once

#include "lights/world_light.h"
#include "scene/material_displacement.h"
#include "scene/placed_instances.h"
#include "textures/converted_textures.h"
#include "trace/traced_shape_store.h"

namespace rayleaf {

struct SceneParts {
    DisplacedSurfaceStore displaced;
    TracedShapeStore shapes;
    PlacedInstancesStore instances;  ///< of scenes that are gone
    WorldLightStore world_lights;
    std::shared_ptr<ConvertedTextures> textures = std::make_shared<ConvertedTextures>();
};

}  // namespace rayleaf
