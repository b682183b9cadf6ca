#include "scene/placed_instances.h"

#include <numeric>

namespace rayleaf {

size_t PlacedInstances::likeness(const SceneDescription& description) const {
    if (instances_.size() != description.instances.size()) return 0;
    size_t alike = 0;
    for (size_t chunk = 0; chunk < instances_.chunk_count(); ++chunk)
        alike += instances_.shares(chunk, description.instances) ? 1 : 0;
    return alike;
}

void PlacedInstances::update(const SceneDescription& description) {
    const size_t count = description.instances.size();
    std::vector<uint32_t> changed;
    if (instances_.size() == count) {
        changed = differing_items(description.instances, instances_);
    } else {
        *this = {};
        resize(count);
        changed.resize(count);
        std::iota(changed.begin(), changed.end(), 0u);
    }
    instances_ = description.instances;
    const std::vector<std::shared_ptr<const Shape>> before = std::move(shapes_);
    shapes_ = description.shapes;
    for (const uint32_t i : changed) place(i);
    const auto is_replaced = [&](int shape) {
        const auto number = static_cast<size_t>(shape);
        return number >= before.size() || shapes_[number] != before[number];
    };
    for (uint32_t i = 0; i < count; ++i)
        if (is_replaced(shape_of_[i])) traced.edit(i).shape = shapes_[static_cast<size_t>(shape_of_[i])];
}

void PlacedInstances::resize(size_t count) {
    infos.resize(count);
    lists.resize(count);
    interpolations.resize(count);
    light_groups.resize(count);
    shadow_terminators.resize(count);
    visibility.resize(count);
    linkings.resize(count);
    shape_of_.resize(count);
    for (size_t i = 0; i < count; ++i) traced.push_back({});
}

void PlacedInstances::place(uint32_t index) {
    const InstanceDescription& instance = instances_[index];
    moving -= infos[index].motion ? 1 : 0;
    moving += instance.motion ? 1 : 0;
    linked -= linkings[index] == LightLinking() ? 0 : 1;
    linked += instance.linking == LightLinking() ? 0 : 1;
    infos[index] = {instance.object_to_world, instance.object_to_world.inverse(),
                    instance.object_index,    instance.random,
                    instance.attributes,      instance.motion.get()};
    lists[index] = instance.material_list;
    interpolations[index] = instance.ray_interpolation;
    light_groups[index] = instance.light_group;
    shadow_terminators[index] = instance.shadow_terminator;
    visibility[index] = instance.visibility;
    linkings[index] = instance.linking;
    shape_of_[index] = instance.shape;
    traced.edit(index) = {shapes_[static_cast<size_t>(instance.shape)], instance.object_to_world,
                          seen_by(instance.visibility, instance.linking.blocks), instance.motion};
}

}  // namespace rayleaf
