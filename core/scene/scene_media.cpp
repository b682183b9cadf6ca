#include "scene/scene_media.h"

#include <array>

namespace rayleaf {
namespace {

/// Cells along a side of the box of a medium that varies, and cells of all of them together.
constexpr int kMostOccupiedCells = 16;
constexpr double kMostCellsInAll = 1 << 18;

/// The space in which a world's medium is bounded cell by cell is larger than what it surrounds.
Box3d widened(const Box3d& box) {
    if (box.isEmpty()) return {Vec3d(-1.0), Vec3d(1.0)};
    return {box.min - box.size(), box.max + box.size()};
}

}  // namespace

void SceneMedia::set_surroundings(const Surroundings& surroundings, std::shared_ptr<const Program> world) {
    surroundings_ = surroundings;
    world_program_ = std::move(world);
    world_.program = world_program_.get();
}

void SceneMedia::add(uint32_t instance, const Material& material) {
    const Key key{instance, material.medium.get()};
    const auto [place, is_new] = all_.try_emplace(key);
    if (!is_new) return;
    place->second.instance = instance;
    place->second.program = material.medium.get();
    material_indices_[key] = material.pass_index;
    if (instances_.empty() || instances_.back() != instance) instances_.push_back(instance);
}

void SceneMedia::commit(const CancelToken& cancel) {
    size_t varying = 0;
    for (const auto& [key, medium] : all_) varying += medium.program->varies_in_space() ? 1 : 0;
    const double each = kMostCellsInAll / static_cast<double>(std::max<size_t>(varying, 1));
    const int cells = std::clamp(static_cast<int>(std::cbrt(each)), 1, kMostOccupiedCells);
    for (auto& [key, medium] : all_)
        if (medium.program->varies_in_space()) bound(medium, cells, cancel);
    if (world_.program && world_.program->varies_in_space()) bound(world_, kMostOccupiedCells, cancel);
}

void SceneMedia::bound(SceneMedium& medium, int cells, const CancelToken& cancel) const {
    const bool is_world = medium.instance == SceneMedium::kWorld;
    const Tracer& tracer = *surroundings_.tracer;
    const Box3d box = is_world ? widened(tracer.bounds()) : tracer.instance(medium.instance).shape->object_bounds();
    const Affine3d to_world = is_world ? Affine3d() : tracer.instance(medium.instance).object_to_world;
    medium.grid = std::make_unique<const MajorantGrid>(
        box, cells,
        [&](std::span<const Vec3d> points, float* values) {
            std::array<Vec3d, kMostPoints> world;
            for (size_t i = 0; i < points.size(); ++i) world[i] = to_world.point(points[i]);
            extinctions(medium, {world.data(), points.size()}, values);
        },
        cancel);
}

const SceneMedium* SceneMedia::find(uint32_t instance, const Material& material) const {
    const auto found = all_.find({instance, material.medium.get()});
    return found == all_.end() ? nullptr : &found->second;
}

SurfacePoint SceneMedia::point_in(const SceneMedium& medium, const Vec3d& position, const Vec3f& outgoing) const {
    SurfacePoint point;
    point.position = point.facet_position = position;
    point.normal = point.facet_normal = outgoing;
    point.inside = true;
    if (medium.instance == SceneMedium::kWorld) return point;
    point.instance = medium.instance;
    point.shape = surroundings_.tracer->instance(medium.instance).shape.get();
    return point;
}

ShadingInputs SceneMedia::inputs_at(const SceneMedium& medium, const SurfacePoint& point, const PathState& path) const {
    ShadingInputs inputs;
    inputs.point = &point;
    inputs.camera = surroundings_.camera;
    inputs.textures = surroundings_.textures;
    inputs.outgoing = point.normal;
    inputs.path = path;
    if (medium.instance == SceneMedium::kWorld) return inputs;
    inputs.instance = &(*surroundings_.instances)[medium.instance];
    inputs.material_index = material_indices_.at({medium.instance, medium.program});
    return inputs;
}

void SceneMedia::evaluate(const SceneMedium& medium, const Vec3d& position, const Vec3f& outgoing,
                          const PathState& path, Closures& result) const {
    const SurfacePoint point = point_in(medium, position, outgoing);
    medium.program->evaluate(inputs_at(medium, point, path), result);
}

void SceneMedia::extinctions(const SceneMedium& medium, std::span<const Vec3d> points, float* values) const {
    std::array<SurfacePoint, kMostPoints> places;
    std::array<ShadingInputs, kMostPoints> inputs;
    std::array<const ShadingInputs*, kMostPoints> of_point;
    std::array<Closures*, kMostPoints> results;
    std::vector<Closures> closures(points.size());
    const PathState path;
    for (size_t i = 0; i < points.size(); ++i) {
        places[i] = point_in(medium, points[i], Vec3f(0, 0, 1));
        inputs[i] = inputs_at(medium, places[i], path);
        of_point[i] = &inputs[i];
        results[i] = &closures[i];
    }
    medium.program->evaluate({of_point.data(), points.size()}, {results.data(), points.size()});
    for (size_t i = 0; i < points.size(); ++i) values[i] = max_component(closures[i].medium.extinction);
}

Affine3d SceneMedia::to_grid(const SceneMedium& medium) const {
    if (medium.instance == SceneMedium::kWorld) return {};
    return (*surroundings_.instances)[medium.instance].world_to_object;
}

}  // namespace rayleaf
