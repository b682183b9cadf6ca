#include "scene/ray_cache_plan.h"

#include "geometry/patch_surface.h"
#include "geometry/triangle_mesh.h"
#include "scene/scene.h"

#include <map>
#include <tuple>

namespace rayleaf {
namespace {

/// Names listed of the objects that share a cache.
constexpr size_t kListedObjects = 8;
/// Columns of a map whose lengths and angles differ by less than this scale evenly.
constexpr double kEvenScale = 1e-5;

bool is_flat(const Shape& shape) {
    if (shape.kind() == ShapeKind::TriangleMesh) return !static_cast<const TriangleMesh&>(shape).is_smooth();
    for (const SplinePatches& spline : static_cast<const PatchSurface&>(shape).splines())
        if (spline.smooth) return false;
    return true;
}

/// What the materials of an object have in common.
struct ObjectOptics {
    MaterialOptics first;
    bool even = true;  ///< one material alone
    bool reads_uv = false, reads_generated = false;
    std::string obstacle;
};

ObjectOptics optics_of_object(const Scene& scene, uint32_t instance) {
    ObjectOptics result;
    const std::vector<int>& list = scene.material_list(instance);
    const Material& first = scene.material_at(list.front());
    for (const int index : list) {
        const Program& program = *scene.material_at(index).surface;
        result.even &= index == list.front();
        if (scene.material_at(index).medium) result.obstacle = "holds a volume";
        if (program.emits()) result.obstacle = "emits light";
        if (program.reads_element()) result.obstacle = "reads attributes, named texture coordinates or tangents";
        result.reads_uv |= program.reads_uv();
        result.reads_generated |= program.reads_generated();
    }
    result.first = optics_of(*first.surface);
    return result;
}

/// Point and normal, what a mirror needs, are enough where nothing reads texture coordinates, neither the materials nor
/// a pass.
SampleSettings samples_for(const ObjectOptics& optics, bool is_volume, bool shows_uv, const Settings& settings) {
    SampleSettings samples;
    samples.kind = OutputKind::Mirror;
    if (is_volume) {
        samples.kind = OutputKind::Volume;
    } else if (shows_uv || optics.reads_uv) {
        samples.kind = OutputKind::Simple;
    } else if (optics.even && optics.first.surface == SurfaceOptics::Glass) {
        samples.kind = OutputKind::Glass;
        samples.ior = optics.first.glass.ior;
        samples.most_interior_hits = most_interior_hits(settings);
    }
    return samples;
}

std::string obstacle_of(const Shape& shape, const ObjectOptics& optics, bool is_volume) {
    if (shape.element_count() == 0) return "has no faces";
    if (shape.deforms()) return "deforms while the shutter is open";
    if (shape.kind() != ShapeKind::TriangleMesh && shape.kind() != ShapeKind::PatchSurface)
        return "is neither a spline surface nor a mesh";
    if (is_volume) return {};
    if (is_flat(shape)) return "is shaded flat";
    if (optics.reads_generated && shape.attribute(kRestPlace, {}))
        return "reads Generated coordinates of before it was deformed";
    return optics.obstacle;
}

bool scales_evenly(const Affine3d& m) {
    const double x = m.x.length2(), y = m.y.length2(), z = m.z.length2();
    const double largest = std::max({x, y, z}) * kEvenScale;
    return m.determinant() > 0.0 && std::abs(x - y) <= largest && std::abs(y - z) <= largest &&
           std::abs(m.x.dot(m.y)) <= largest && std::abs(m.y.dot(m.z)) <= largest && std::abs(m.z.dot(m.x)) <= largest;
}

}  // namespace

int most_interior_hits(const Settings& settings) {
    return std::clamp(std::min(settings.max_bounces, settings.glossy_bounces + 1), 1, kMostInteriorHits);
}

std::vector<PlannedRayCache> plan_ray_caches(const SceneDescription& description, const Scene& scene,
                                             const Settings& settings, const CancelToken& cancel) {
    const bool shows_uv = std::find(settings.passes.begin(), settings.passes.end(), Pass::uv) != settings.passes.end();
    using Key = std::tuple<const Shape*, OutputKind, double, int, std::string>;
    std::map<Key, size_t> places;
    std::vector<PlannedRayCache> plan;
    for (uint32_t i = 0; i < description.instances.size(); ++i) {
        cancel.throw_if_cancelled();
        const InstanceDescription& instance = description.instances[i];
        const RayInterpolation& interpolation = scene.ray_interpolation(i);
        if (interpolation.mode == RayInterpolationMode::Off) continue;
        const std::shared_ptr<const Shape>& shape = scene.tracer().instance(i).shape;  // displaced where it is
        const bool is_volume = scene.volume(i) != nullptr;
        const ObjectOptics optics = optics_of_object(scene, i);
        const SampleSettings samples = samples_for(optics, is_volume, shows_uv, settings);
        const std::string obstacle = obstacle_of(*shape, optics, is_volume);
        const Key key{shape.get(), samples.kind, samples.ior, instance.ray_interpolation, obstacle};
        const auto [place, is_new] = places.try_emplace(key, plan.size());
        if (is_new) plan.push_back({shape, samples, interpolation, {}, {}, obstacle, false});
        PlannedRayCache& planned = plan[place->second];
        planned.instances.push_back(i);
        if (samples.kind == OutputKind::Glass && !scene.glass_body(i)) planned.first_hits_only = true;
        if (planned.objects.size() < kListedObjects) planned.objects.push_back(instance.name);
    }
    return plan;
}

/// At all times.
bool scales_evenly(const TracedInstance& instance) {
    if (!scales_evenly(instance.object_to_world)) return false;
    if (!instance.motion) return true;
    for (size_t step = 0; step < instance.motion->steps(); ++step)
        if (!scales_evenly(instance.motion->at(instance.motion->time_of(step)))) return false;
    return true;
}

std::optional<GlassBody> glass_body_of(const Scene& scene, uint32_t instance) {
    const std::vector<int>& list = scene.material_list(instance);
    const ObjectOptics optics = optics_of_object(scene, instance);
    if (!optics.even || optics.first.surface != SurfaceOptics::Glass || scene.volume(instance)) return std::nullopt;
    if (list.empty() || !scales_evenly(scene.tracer().instance(instance))) return std::nullopt;
    return optics.first.glass;
}

}  // namespace rayleaf
