#include "scene/edits.h"

#include "scene/checks.h"

namespace rayleaf {

SceneDescription emptied(const SceneDescription& scene) {
    SceneDescription result = scene;
    result.shapes.clear();
    result.materials.clear();
    result.material_lists.clear();
    result.ray_interpolations.clear();
    result.instances.clear();
    result.lamps.clear();
    result.set_world(nullptr, 0);
    result.world_light_group = -1;
    result.world_visibility = kVisibleAll;
    result.world_lit_by = kAllLightSets;
    return result;
}

void replace_shape(SceneDescription& scene, int index, std::shared_ptr<const Shape> shape) {
    check_index(shape->name(), "shape", index, scene.shapes.size(), 0);
    scene.shapes[static_cast<size_t>(index)] = std::move(shape);
}

void replace_material(SceneDescription& scene, int index, Material material) {
    check_index(material.name, "material", index, scene.materials.size(), 0);
    scene.materials[static_cast<size_t>(index)] = checked_material(std::move(material));
}

void place_instances(SceneDescription& scene, std::span<const int32_t> indices, std::span<const Affine3d> places) {
    for (size_t i = 0; i < indices.size(); ++i) {
        check_index("scene", "instance", indices[i], scene.instances.size(), 0);
        check_matrix(scene.instances[static_cast<size_t>(indices[i])].name, places[i]);
    }
    for (size_t i = 0; i < indices.size(); ++i) {
        InstanceDescription& instance = scene.instances.edit(static_cast<size_t>(indices[i]));
        instance.object_to_world = places[i];
        instance.motion = nullptr;
    }
}

}  // namespace rayleaf
