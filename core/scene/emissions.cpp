#include "scene/emissions.h"

#include "scene/scene.h"

#include <algorithm>

namespace rayleaf {

static_assert(kMostTogether == EmissionRuns::kMost);

void EmissionRuns::run() const {
    const std::span<const Point> points = points_.all();
    uint64_t open = (uint64_t{1} << points.size()) - 1;
    while (open != 0) {
        const Program* program = points[static_cast<size_t>(__builtin_ctzll(open))].program;
        ShortList<const ShadingInputs*, kMost> inputs;
        ShortList<Closures, kMost> closures;
        ShortList<Closures*, kMost> results;
        ShortList<Color*, kMost> emissions;
        for (size_t i = 0; i < points.size(); ++i) {
            if (points[i].program != program) continue;
            open &= ~(uint64_t{1} << i);
            inputs.add(&points[i].inputs);
            results.add(&closures.add());
            emissions.add(points[i].result);
        }
        program->evaluate(inputs.all(), results.all());
        for (size_t i = 0; i < emissions.size(); ++i) *emissions[i] = closures[i].emission;
    }
}

namespace {

/// Calls `visit` with parts of as many points as run together, and where their results go.
template <typename Point, typename Visit>
void in_runs(std::span<const Point> points, Color* results, const Visit& visit) {
    for (size_t first = 0; first < points.size(); first += EmissionRuns::kMost)
        visit(points.subspan(first, std::min(EmissionRuns::kMost, points.size() - first)), results + first);
}

}  // namespace

void Scene::emit_surfaces(std::span<const EmitterPoint> points, Color* radiances) const {
    in_runs(points, radiances, [this](std::span<const EmitterPoint> part, Color* results) {
        EmissionRuns runs;
        for (const EmitterPoint& each : part) {
            const Material& material = this->material(each.point->instance, each.point->local);
            runs.add(*material.surface, *results++) =
                shading_inputs(*each.point, material, each.outgoing, {}, each.path);
        }
        runs.run();
    });
}

void Scene::emit_world(std::span<const WorldDirection> directions, Color* radiances) const {
    in_runs(directions, radiances, [this](std::span<const WorldDirection> part, Color* results) {
        EmissionRuns runs;
        for (const WorldDirection& each : part)
            runs.add(*world_, *results++) = world_inputs(each.direction, {}, each.path);
        runs.run();
    });
}

/// Normals are those of the lamp's frame. Area lamps have parameters, 0 to 1, but no texture coordinates, as in Cycles.
void Scene::place_on_lamp(const LampPoint& lamp, SurfacePoint& point) const {
    const Lamp& description = lamps_[lamp.lamp];
    point.position = point.facet_position = lamp.position;
    point.inside = true;
    point.normal = point.facet_normal = lamp.outgoing;
    if (description.kind == LampKind::Rectangle || description.kind == LampKind::Disk) {
        const Vec3d local = lamp_infos_[lamp.lamp].world_to_object.point(lamp.position);
        point.local.u = static_cast<float>(local.x / description.size_x + 0.5);
        point.local.v = static_cast<float>(local.y / description.size_y + 0.5);
        point.normal = point.facet_normal = Vec3f(normalized_or(-description.to_world.z, Vec3d(0, 0, -1)));
    }
}

void Scene::emit_lamps(std::span<const LampPoint> points, Color* factors) const {
    in_runs(points, factors, [this](std::span<const LampPoint> part, Color* results) {
        EmissionRuns runs;
        ShortList<SurfacePoint, EmissionRuns::kMost> places;
        for (const LampPoint& lamp : part) {
            ShadingInputs& inputs = runs.add(*lamps_[lamp.lamp].emission, *results++);
            SurfacePoint& place = places.add();
            place_on_lamp(lamp, place);
            inputs.point = &place;
            inputs.instance = &lamp_infos_[lamp.lamp];
            inputs.camera = &camera_->info();
            inputs.textures = textures_.get();
            inputs.outgoing = lamp.outgoing;
            inputs.path = lamp.path;
        }
        runs.run();
    });
}

}  // namespace rayleaf
