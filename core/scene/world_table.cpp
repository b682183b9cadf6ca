#include "scene/world_table.h"

#include "scene/scene_parts.h"

#include <array>

namespace rayleaf {
namespace {

/// Cells are half as wide as the pixels of pictures around, where nothing finer can be seen.
int table_width(const SceneDescription& description) {
    int detail = 0;
    if (const std::shared_ptr<TextureStore>& textures = description.existing_textures())
        for (const int32_t texture : description.world->sole_environments()) {
            const TextureStore::Size size = textures->size(texture);
            detail = std::max({detail, size.width, 2 * size.height});
        }
    return detail > 0 ? std::min(description.world_resolution, 2 * detail) : description.world_resolution;
}

/// Textures are known by their numbers in programs: all of them are part of what a program shows.
WorldLightKey world_light_key(const SceneDescription& description, const CameraInfo& camera) {
    ContentHasher hasher;
    description.world->add_to(hasher);
    if (description.existing_textures()) description.existing_textures()->add_to(hasher);
    if (description.world->reads_camera()) camera.add_to(hasher);
    return {hasher.value(), table_width(description)};
}

/// What a world's program emits along directions; `inputs` are those of all but for the direction.
void emissions_of(const Program& world, const ShadingInputs& inputs, std::span<const Vec3f> directions,
                  Color* radiances) {
    std::vector<ShadingInputs> points(kMostPoints, inputs);
    std::vector<Closures> closures(kMostPoints);
    std::array<const ShadingInputs*, kMostPoints> of_point;
    std::array<Closures*, kMostPoints> results;
    for (size_t i = 0; i < kMostPoints; ++i) {
        of_point[i] = &points[i];
        results[i] = &closures[i];
    }
    for (size_t first = 0; first < directions.size(); first += kMostPoints) {
        const size_t count = std::min(kMostPoints, directions.size() - first);
        for (size_t i = 0; i < count; ++i) points[i].outgoing = -directions[first + i];
        world.evaluate({of_point.data(), count}, {results.data(), count});
        for (size_t i = 0; i < count; ++i) radiances[first + i] = closures[i].emission;
    }
}

}  // namespace

std::shared_ptr<const WorldLight> world_table(const SceneDescription& description, const ShadingInputs& inputs,
                                              int most, WorldShare share, const CancelToken& cancel) {
    WorldLightStore& store = description.parts->world_lights;
    WorldLightKey key = world_light_key(description, *inputs.camera);
    key.width = std::min(key.width, most);
    key.share = share;
    store.next_user();
    std::shared_ptr<const WorldLight> table = store.find(key);
    if (table) return table;
    const auto emissions = [&](std::span<const Vec3f> directions, Color* radiances) {
        emissions_of(*description.world, inputs, directions, radiances);
    };
    table = std::make_shared<const WorldLight>(emissions, description.world->suns(), key.width, share, cancel);
    store.keep(key, table);
    return table;
}

}  // namespace rayleaf
