// The plain description of a scene that the add-on fills. Adding validates: what is wrong throws InputError and leaves
// the description as it was, so the rest of the scene can still be rendered.
#pragma once

#include "base/chunked_vector.h"
#include "film/mattes.h"
#include "geometry/shape.h"
#include "lights/light.h"
#include "scene/camera.h"
#include "scene/ray_interpolation.h"
#include "shading/program.h"
#include "textures/texture_store.h"

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

namespace rayleaf {

/// An object shown as an x-ray does: by the length of a line inside it. Such objects should not intersect others.
struct VolumeVisualisation {
    enum class Kind : uint8_t {
        Emission,   ///< adds colour * density * length to the radiance
        Absorption  ///< what lies behind is multiplied by colour^(density * length)
    } kind = Kind::Emission;
    float density = 1;  ///< per world unit, not negative
    Color color{1, 1, 1};
};

/// How far a material moves the points of surfaces: the sum of two vectors that a program leaves in registers.
struct MaterialDisplacement {
    std::shared_ptr<const Program> program;  ///< null: not at all
    Register object = -1, world = -1;        ///< in the object's space and in the world's; -1: none
};

/// Throws InputError, which names the owner, for registers that the program has not.
void check_displacement(const std::string& owner, const MaterialDisplacement& displacement);

struct Material {
    std::string name;
    std::shared_ptr<const Program> surface;  ///< null: a neutral grey diffuse
    float pass_index = 0;
    std::optional<VolumeVisualisation> volume;  ///< in place of the surface
    MaterialDisplacement displacement;          ///< of patches and subdivision surfaces
    /// What fills the space behind the surface (shading/medium.h). Without `surface` there is none to be seen.
    std::shared_ptr<const Program> medium = nullptr;
    bool transparent_shadow =
        true;  ///< where light goes straight through, shadow rays do too; else it is opaque to them
    bool bounds_medium_alone = false;  ///< follows from the programs
};

/// Cycles' for new objects.
inline constexpr float kShadowTerminator = 0.1f;

struct InstanceDescription {
    std::string name;
    int shape = -1;
    Affine3d object_to_world;
    int material_list = -1;  ///< index of a list of materials, one per slot; -1: neutral material everywhere
    float object_index = 0, random = 0;
    uint8_t visibility = kVisibleAll;  ///< with kOfFootage: a shadow catcher
    int ray_interpolation = -1;        ///< index of the object's own; -1: the scene's
    std::vector<InstanceAttribute> attributes = {};
    int light_group = -1;    ///< the slot of the light that it emits (film/pass.h); -1: none
    std::string asset = {};  ///< to which it belongs for Cryptomatte; empty: it is one itself
    /// Where it is while the shutter is open; null: it stands still at `object_to_world`.
    std::shared_ptr<const Motion> motion = nullptr;
    /// Sine of the angle between a light and the surface below which shadow rays start above facets that are shaded
    /// smooth, 0 to 1; 0: never. Cycles' Shadow Terminator Geometry Offset.
    float shadow_terminator = kShadowTerminator;
    LightLinking linking = {};

    bool operator==(const InstanceDescription&) const = default;
};
inline const std::string& asset_of(const InstanceDescription& instance) {
    return instance.asset.empty() ? instance.name : instance.asset;
}
/// The material of what has none, as Cycles calls it.
inline constexpr const char* kNeutralMaterial = "default_surface";

struct SceneParts;  // scene/scene_parts.h

class SceneDescription {
  public:
    /// `kept`: what was made for other renders; null: nothing.
    explicit SceneDescription(std::shared_ptr<SceneParts> kept = nullptr);

    int add_shape(std::shared_ptr<const Shape> shape);
    int add_material(Material material);
    int add_material_list(std::vector<int> materials);
    int add_ray_interpolation(const std::string& object, const RayInterpolation& interpolation);
    int add_instance(InstanceDescription instance);
    int add_lamp(const Lamp& lamp);
    /// `medium` fills the space outside all objects, and them too; null: nothing does.
    void set_world(std::shared_ptr<const Program> world, int sampling_resolution,
                   std::shared_ptr<const Program> medium = nullptr);
    /// Throws InputError for numbers that are no slot's.
    void set_world_light_group(int slot);
    /// Cryptomatte's list of the names of a kind.
    std::string matte_manifest(MatteKind kind) const;
    /// What a file's header says of it; `layer` names the kind's passes without their numbers.
    std::map<std::string, std::string> matte_attributes(MatteKind kind, const std::string& layer) const;
    void set_camera(const CameraDescription& camera);
    /// The camera whose pixels facets are made fine enough for, where it is another: one that moves keeps its facets.
    void set_dicing_camera(const CameraDescription& camera);
    /// The id of an attribute name, new or old; kRestPlace of kRestPlaceName.
    static constexpr const char* kRestPlaceName = "\nrest place";
    AttributeId attribute(const std::string& name);
    /// The scene's textures; created by the first call.
    std::shared_ptr<TextureStore> textures();

    std::vector<std::shared_ptr<const Shape>> shapes;
    std::vector<Material> materials;
    std::vector<std::vector<int>> material_lists;
    std::vector<RayInterpolation> ray_interpolations;
    ChunkedVector<InstanceDescription> instances;
    std::vector<Lamp> lamps;
    std::shared_ptr<const Program> world, world_medium;
    int world_resolution = 0;
    int world_light_group = -1;              ///< the slot of its light; -1: none
    uint8_t world_visibility = kVisibleAll;  ///< which rays see it
    LightSets world_lit_by = kAllLightSets;  ///< of its medium
    size_t texture_memory = size_t{1} << 30;
    std::shared_ptr<SceneParts> parts;  ///< never null

    const std::optional<CameraDescription>& camera() const { return camera_; }
    const std::optional<CameraDescription>& dicing_camera() const { return dicing_camera_ ? dicing_camera_ : camera_; }
    const std::shared_ptr<TextureStore>& existing_textures() const { return textures_; }

  private:
    std::optional<CameraDescription> camera_, dicing_camera_;
    std::unordered_map<std::string, AttributeId> attributes_;
    std::shared_ptr<TextureStore> textures_;
};

}  // namespace rayleaf
