// Displacement by materials: programs that say how far points move, and the surfaces they make.
#pragma once

#include "base/kept_by_key.h"
#include "geometry/displaced_surface.h"
#include "scene/description.h"
#include "trace/tracer.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

namespace rayleaf {

/// Displaced surfaces by their content: another view of a scene, or its next frame, finds them.
class DisplacedSurfaceStore final : public KeptByKey<ContentHash, std::shared_ptr<const Shape>> {};

/// What programs read beside the surface.
struct DisplacementSurroundings {
    std::optional<CameraInfo> camera;
    std::shared_ptr<const TextureStore> textures;
};

/// Puts displaced surfaces in place of the shapes of instances whose materials displace them. `list_of`: the materials
/// of an instance by slot. Instances that look alike share one; shapes that cannot be displaced stay as they are.
/// Throws Cancelled soon after `cancel` says so.
void displace(ChunkedVector<TracedInstance>& traced, const SceneDescription& description,
              const std::function<const std::vector<int>&(uint32_t)>& list_of,
              const DisplacementSurroundings& surroundings, const CancelToken& cancel);

/// A shape displaced by one material, as an object that stands untransformed at the origin.
std::shared_ptr<Shape> displaced(std::shared_ptr<const Shape> shape, const MaterialDisplacement& displacement);

}  // namespace rayleaf
