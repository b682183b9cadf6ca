#include "scene/description.h"

#include "base/error.h"
#include "scene/checks.h"
#include "scene/scene_parts.h"

namespace rayleaf {
namespace {

constexpr const char* kScene = "scene";

void check_strength(const Lamp& lamp) {
    if (!is_finite(lamp.strength)) throw InputError(lamp.name, "strength", "not finite", "finite numbers");
    const double sizes[] = {lamp.radius,    lamp.angle,      lamp.size_x, lamp.size_y,
                            lamp.spot_size, lamp.spot_blend, lamp.spread};
    for (const double size : sizes)
        if (!std::isfinite(size) || size < 0)
            throw InputError(lamp.name, "size", number_text(size), "0 or a positive finite number");
}

}  // namespace

void check_displacement(const std::string& owner, const MaterialDisplacement& displacement) {
    if (!displacement.program) return;
    for (const Register target : {displacement.object, displacement.world})
        if (target < -1 || target >= displacement.program->register_count())
            throw InputError(owner, "displacement", std::to_string(target), "-1 or a register of its program");
}

SceneDescription::SceneDescription(std::shared_ptr<SceneParts> kept)
    : parts(kept ? std::move(kept) : std::make_shared<SceneParts>()) {}

int SceneDescription::add_shape(std::shared_ptr<const Shape> shape) {
    shapes.push_back(std::move(shape));
    return static_cast<int>(shapes.size()) - 1;
}

int SceneDescription::add_material(Material material) {
    materials.push_back(checked_material(std::move(material)));
    return static_cast<int>(materials.size()) - 1;
}

int SceneDescription::add_material_list(std::vector<int> list) {
    for (const int material : list) check_index(kScene, "material", material, materials.size(), -1);
    material_lists.push_back(std::move(list));
    return static_cast<int>(material_lists.size()) - 1;
}

int SceneDescription::add_ray_interpolation(const std::string& object, const RayInterpolation& interpolation) {
    validate(object, interpolation);
    ray_interpolations.push_back(interpolation);
    return static_cast<int>(ray_interpolations.size()) - 1;
}

int SceneDescription::add_instance(InstanceDescription instance) {
    check_index(instance.name, "shape", instance.shape, shapes.size(), 0);
    check_index(instance.name, "material list", instance.material_list, material_lists.size(), -1);
    check_index(instance.name, "ray interpolation", instance.ray_interpolation, ray_interpolations.size(), -1);
    check_light_group(instance.name, instance.light_group);
    check_matrix(instance.name, instance.object_to_world);
    if (!(instance.shadow_terminator >= 0.0f && instance.shadow_terminator <= 1.0f))
        throw InputError(instance.name, "shadow terminator", number_text(instance.shadow_terminator), "0 to 1");
    instances.push_back(std::move(instance));
    return static_cast<int>(instances.size()) - 1;
}

int SceneDescription::add_lamp(const Lamp& lamp) {
    const Affine3d& m = lamp.to_world;
    if (!is_finite(m.x) || !is_finite(m.y) || !is_finite(m.z) || !is_finite(m.translation))
        throw InputError(lamp.name, "matrix", "not finite", "finite numbers");
    check_strength(lamp);
    check_light_group(lamp.name, lamp.light_group);
    lamps.push_back(lamp);
    return static_cast<int>(lamps.size()) - 1;
}

std::map<std::string, std::string> SceneDescription::matte_attributes(MatteKind kind, const std::string& layer) const {
    return rayleaf::matte_attributes(layer, matte_manifest(kind));
}

void SceneDescription::set_world_light_group(int slot) {
    check_light_group("world", slot);
    world_light_group = slot;
}

std::string SceneDescription::matte_manifest(MatteKind kind) const {
    std::vector<std::string> names;
    if (kind == MatteKind::Material) {
        for (const Material& material : materials) names.push_back(material.name);
        names.emplace_back(kNeutralMaterial);
    } else {
        for (const InstanceDescription& instance : instances)
            names.push_back(kind == MatteKind::Object ? instance.name : asset_of(instance));
    }
    return rayleaf::matte_manifest(std::move(names));
}

void SceneDescription::set_world(std::shared_ptr<const Program> program, int sampling_resolution,
                                 std::shared_ptr<const Program> medium) {
    constexpr int kLargest = 8192;
    if (sampling_resolution < 0 || sampling_resolution > kLargest)
        throw InputError("world", "sampling resolution", std::to_string(sampling_resolution),
                         "a number from 0 to 8192");
    world = std::move(program);
    world_medium = std::move(medium);
    world_resolution = sampling_resolution;
}

void SceneDescription::set_camera(const CameraDescription& camera) {
    validate(camera);
    camera_ = camera;
}

void SceneDescription::set_dicing_camera(const CameraDescription& camera) {
    validate(camera);
    dicing_camera_ = camera;
}

AttributeId SceneDescription::attribute(const std::string& name) {
    if (name == kRestPlaceName) return kRestPlace;
    return attributes_.try_emplace(name, static_cast<AttributeId>(attributes_.size())).first->second;
}

std::shared_ptr<TextureStore> SceneDescription::textures() {
    if (!textures_) textures_ = std::make_shared<TextureStore>(texture_memory, parts->textures);
    return textures_;
}

}  // namespace rayleaf
