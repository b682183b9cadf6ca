// Whether two descriptions show the same.
#include "scene/edits.h"

#include <algorithm>

namespace rayleaf {
namespace {

template <typename T, typename Same>
bool are_same(const std::vector<T>& a, const std::vector<T>& b, const Same& same) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), same);
}

bool same_programs(const std::shared_ptr<const Program>& a, const std::shared_ptr<const Program>& b) {
    if (a == b) return true;
    if (!a || !b) return false;
    ContentHasher of_a, of_b;
    a->add_to(of_a);
    b->add_to(of_b);
    return of_a.value() == of_b.value();
}

bool same_volumes(const std::optional<VolumeVisualisation>& a, const std::optional<VolumeVisualisation>& b) {
    if (!a || !b) return a.has_value() == b.has_value();
    return a->kind == b->kind && a->density == b->density && a->color == b->color;
}

bool same_displacements(const MaterialDisplacement& a, const MaterialDisplacement& b) {
    return same_programs(a.program, b.program) && a.object == b.object && a.world == b.world;
}

bool same_materials(const Material& a, const Material& b) {
    return same_programs(a.surface, b.surface) && same_programs(a.medium, b.medium) && a.pass_index == b.pass_index &&
           a.transparent_shadow == b.transparent_shadow && same_volumes(a.volume, b.volume) &&
           same_displacements(a.displacement, b.displacement);
}

bool same_lamps(const Lamp& a, const Lamp& b) {
    return a.name == b.name && a.kind == b.kind && a.to_world == b.to_world && a.strength == b.strength &&
           a.radius == b.radius && a.soft_falloff == b.soft_falloff && a.angle == b.angle &&
           a.spot_size == b.spot_size && a.spot_blend == b.spot_blend && a.spot_profile == b.spot_profile &&
           a.size_x == b.size_x && a.size_y == b.size_y && a.spread == b.spread && a.casts_shadow == b.casts_shadow &&
           a.visibility == b.visibility && same_programs(a.emission, b.emission) && a.light_group == b.light_group &&
           a.link == b.link;
}

bool same_textures(const SceneDescription& a, const SceneDescription& b) {
    if (a.existing_textures() == b.existing_textures()) return true;
    if (!a.existing_textures() || !b.existing_textures()) return false;
    ContentHasher of_a, of_b;
    a.existing_textures()->add_to(of_a);
    b.existing_textures()->add_to(of_b);
    return of_a.value() == of_b.value();
}

}  // namespace

bool shows_same(const SceneDescription& a, const SceneDescription& b) {
    // An object's own settings say how it is rendered, not what it is: they count as different.
    return a.ray_interpolations.empty() && b.ray_interpolations.empty() && a.texture_memory == b.texture_memory &&
           a.world_resolution == b.world_resolution && a.world_light_group == b.world_light_group &&
           a.world_visibility == b.world_visibility && a.world_lit_by == b.world_lit_by &&
           same_programs(a.world, b.world) && same_programs(a.world_medium, b.world_medium) && same_textures(a, b) &&
           are_same(a.shapes, b.shapes, std::equal_to<>()) && are_same(a.materials, b.materials, same_materials) &&
           are_same(a.material_lists, b.material_lists, std::equal_to<>()) && are_same(a.lamps, b.lamps, same_lamps) &&
           a.instances.size() == b.instances.size() && differing_items(a.instances, b.instances).empty();
}

}  // namespace rayleaf
