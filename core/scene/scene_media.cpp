#include "scene/scene_media.h"

#include "base/short_list.h"

#include <array>

namespace rayleaf {
namespace {

/// Cells along a side of the box of a medium that varies, and cells of all of them together.
constexpr int kMostCellsOfSide = 24;
constexpr double kMostCellsInAll = 1 << 17;

/// Lookups across the box of what emits where there is nothing else: fire without smoke.
constexpr double kGlowLookups = 32.0;

/// A little more than a box: the ends of rays in it stay inside, whatever their rounding.
Box3d padded(const Box3d& box) {
    constexpr double kShare = 1e-5;
    return {box.min - box.size() * kShare, box.max + box.size() * kShare};
}

/// Per world unit over per unit of the object's own space, by a direction that favours no axis, as in Cycles.
float density_per_world_unit(const Affine3d& to_world) {
    const double length = to_world.vector(Vec3d(1.0 / std::sqrt(3.0))).length();
    return length > 0.0 ? static_cast<float>(1.0 / length) : 1.0f;
}

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
    const TracedInstance& placed = surroundings_.tracer->instance(instance);
    place->second.voxels = placed.shape->grids();
    if (place->second.voxels != nullptr && place->second.voxels->unit == DensityUnit::Object)
        place->second.density_factor = density_per_world_unit(placed.object_to_world);
    place->second.material_index = material.pass_index;
    if (instances_.empty() || instances_.back() != instance) instances_.push_back(instance);
}

void SceneMedia::commit(const CancelToken& cancel) {
    const auto varies = [](const SceneMedium& medium) {
        return medium.voxels != nullptr || medium.program->varies_in_space();
    };
    size_t varying = 0;
    for (auto& [key, medium] : all_) note_if_even(medium);
    if (world_.program) note_if_even(world_);
    for (const auto& [key, medium] : all_) varying += varies(medium) ? 1 : 0;
    const double each = kMostCellsInAll / static_cast<double>(std::max<size_t>(varying, 1));
    const int cells = static_cast<int>(std::cbrt(each));
    for (auto& [key, medium] : all_)
        if (varies(medium)) bound(medium, std::clamp(cells, 1, kMostCellsOfSide), cancel);
    if (world_.program && world_.program->varies_in_space()) bound(world_, kMostCellsOfSide, cancel);
}

void SceneMedia::note_if_even(SceneMedium& medium) const {
    const Program& program = *medium.program;
    if (medium.voxels != nullptr || !program.has_even_closures() || program.asks_surroundings()) return;
    Closures closures;
    program.evaluate(inputs_at(medium, point_in(medium, Vec3d(0.0), Vec3f(0, 0, 1)), {}), closures);
    medium.even = EvenMedium{closures.medium, closures.emission};
}

void SceneMedia::bound(SceneMedium& medium, int cells, const CancelToken& cancel) const {
    const bool is_world = medium.instance == SceneMedium::kWorld;
    const Tracer& tracer = *surroundings_.tracer;
    const Box3d box = is_world ? widened(tracer.bounds()) : tracer.instance(medium.instance).shape->object_bounds();
    const Affine3d to_world = is_world ? Affine3d() : tracer.instance(medium.instance).object_to_world;
    if (!is_world) medium.glow_rate = static_cast<float>(kGlowLookups / image_of(box, to_world).size().length());
    const auto probed = [&](std::span<const GridProbe> probes, FoundDensity* found) {
        std::array<GridProbe, kMostPoints> world;
        for (size_t i = 0; i < probes.size(); ++i) world[i] = {to_world.point(probes[i].point), probes[i].assumed};
        look_up(medium, {world.data(), probes.size()}, found);
    };
    if (medium.voxels != nullptr) {
        const Box3d around = padded(box);
        medium.grid = std::make_unique<const MajorantGrid>(
            around, cells, grid_majorants(*medium.voxels, medium.program->attributes(), around, cells, probed, cancel));
        return;
    }
    const auto at_points = [&](std::span<const Vec3d> points, FoundDensity* found) {
        std::array<GridProbe, kMostPoints> probes;
        for (size_t i = 0; i < points.size(); ++i) probes[i].point = points[i];
        probed({probes.data(), points.size()}, found);
    };
    medium.grid = std::make_unique<const MajorantGrid>(box, cells, looked_up_cells(box, cells, at_points, cancel));
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
    inputs.material_index = medium.material_index;
    return inputs;
}

void SceneMedia::evaluate(const SceneMedium& medium, const Vec3d& position, const Vec3f& outgoing,
                          const PathState& path, Closures& result) const {
    if (medium.even) {
        result.clear();
        result.medium = medium.even->medium;
        result.emission = medium.even->emission;
        return;
    }
    const SurfacePoint point = point_in(medium, position, outgoing);
    if (is_empty_at(medium, point)) return result.clear();
    medium.program->evaluate(inputs_at(medium, point, path), result);
    if (medium.density_factor != 1.0f) result.medium.scale(medium.density_factor);
}

bool SceneMedia::is_empty_at(const SceneMedium& medium, const SurfacePoint& point) const {
    if (medium.voxels == nullptr) return false;
    return !medium.voxels->holds((*surroundings_.instances)[medium.instance].world_to_object.point(point.position));
}

void SceneMedia::look_up(const SceneMedium& medium, std::span<const GridProbe> probes, FoundDensity* found) const {
    ShortList<SurfacePoint, kMostPoints> places;
    std::array<ShadingInputs, kMostPoints> inputs;
    std::array<const ShadingInputs*, kMostPoints> of_point;
    ShortList<Closures, kMostPoints> closures;
    std::array<Closures*, kMostPoints> results;
    for (size_t i = 0; i < probes.size(); ++i) {
        inputs[i] = inputs_at(medium, places.add(point_in(medium, probes[i].point, Vec3f(0, 0, 1))), PathState());
        inputs[i].assumed = probes[i].assumed;
        of_point[i] = &inputs[i];
        results[i] = &closures.add();
    }
    medium.program->evaluate({of_point.data(), probes.size()}, {results.data(), probes.size()});
    for (size_t i = 0; i < probes.size(); ++i) {
        found[i].extinction = closures[i].medium.extinction * medium.density_factor;
        found[i].scatters = closures[i].medium.scatters();
        // What has no grids is sampled as often as it is dense; only where it is not would its light be overlooked.
        const float largest = max_component(found[i].extinction);
        const bool is_faint = medium.voxels != nullptr ? largest < medium.glow_rate : largest == 0.0f;
        found[i].lookups = is_faint && !is_black(closures[i].emission) ? medium.glow_rate : 0.0f;
    }
}

Affine3d SceneMedia::to_grid(const SceneMedium& medium) const {
    if (medium.instance == SceneMedium::kWorld) return {};
    return (*surroundings_.instances)[medium.instance].world_to_object;
}

}  // namespace rayleaf
