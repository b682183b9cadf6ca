// What a shader program may read about the point it shades.
#pragma once

#include "base/vector.h"
#include "geometry/surface_point.h"
#include "rays/ray_differential.h"
#include "shading/surroundings.h"

#include <array>
#include <compare>
#include <cstdint>
#include <span>
#include <vector>

namespace rayleaf {

class TextureStore;  // textures/texture_store.h

/// The kind of ray that asks, and how it came here (Blender's Light Path node).
struct PathState {
    bool camera = true, shadow = false, diffuse = false, glossy = false, singular = false, reflection = false,
         transmission = false, volume = false;
    float ray_length = 0;  ///< world units
    int depth = 0, diffuse_depth = 0, glossy_depth = 0, transparent_depth = 0, transmission_depth = 0, volume_depth = 0;
    int portal_depth = 0;  ///< of the transparent ones
};

/// A named value of a whole instance: the object's colour, the particle that it stands for.
struct InstanceAttribute {
    AttributeId id = 0;
    std::array<float, 4> value{};
    auto operator<=>(const InstanceAttribute&) const = default;  // NOLINT(modernize-use-nullptr): it has no pointers
};

/// Facts of the object instance that programs read.
struct InstanceInfo {
    Affine3d object_to_world, world_to_object;
    float object_index = 0;  ///< Blender's pass index
    float random = 0;        ///< 0..1
    std::vector<InstanceAttribute> attributes = {};
    const Motion* motion = nullptr;  ///< null: it stands still
};

/// The camera as far as programs need it (Camera and Window coordinates).
struct CameraInfo {
    Affine3d world_to_camera;  ///< camera looks along its -z, as in Blender
    /// x, y on the picture 0..1 = (p.xy / (perspective ? -p.z : 1) - window_min) / window_size, p in camera space.
    Vec2d window_min{-1, -1}, window_size{2, 2};
    bool perspective = true;

    void add_to(ContentHasher& hasher) const {
        hasher.add(world_to_camera);
        for (const double number : {window_min.x, window_min.y, window_size.x, window_size.y}) hasher.add(number);
        hasher.add(perspective ? 1 : 0);
    }
};

struct ShadingInputs {
    const SurfacePoint* point = nullptr;     ///< null in the world's program
    const InstanceInfo* instance = nullptr;  ///< null in the world's program
    const CameraInfo* camera = nullptr;
    const TextureStore* textures = nullptr;  ///< null if the scene has no textures
    Vec3f outgoing;                ///< unit, from the point towards the viewer; the world: minus the ray's direction
    RayDifferential differential;  ///< transferred to the surface
    PathState path;
    float material_index = 0;                    ///< Blender's pass index
    const Surroundings* surroundings = nullptr;  ///< null where rays cannot be traced
    ProbeNumbers probes;                         ///< for these
    /// What grids are taken to hold, in place of what they do; of the others nothing is known. Empty: what they do.
    std::span<const InstanceAttribute> assumed = {};

    /// The maps of the instance when the point is seen; there must be one.
    Affine3d object_to_world() const { return moves() ? instance->motion->at(point->time) : instance->object_to_world; }
    Affine3d world_to_object() const { return moves() ? object_to_world().inverse() : instance->world_to_object; }

  private:
    bool moves() const { return instance->motion != nullptr && point != nullptr; }
};

}  // namespace rayleaf
