#include "scene/scene.h"

#include "base/error.h"
#include "scene/material_displacement.h"
#include "scene/occupancy.h"
#include "scene/ray_cache_plan.h"
#include "scene/scene_parts.h"

namespace rayleaf {
namespace {

/// What an object without a material looks like: Blender's default grey, diffuse.
std::shared_ptr<const Program> neutral_program() {
    Program program("neutral material");
    const Register one = program.constant(Vec4f(1.0f));
    const Register grey = program.constant(Vec4f(0.8f, 0.8f, 0.8f, 1.0f));
    const Register operands[] = {one, grey};
    program.operation("diffuse", operands);
    return std::make_shared<const Program>(std::move(program));
}

/// Elements of a shape whose material emits; `emits` is asked by slot.
template <typename Emits>
std::vector<uint32_t> emitting_elements(const Shape& shape, const Emits& emits, const CancelToken& cancel) {
    std::vector<uint32_t> elements;
    for (uint32_t element = 0; element < shape.element_count(); ++element) {
        cancel.throw_if_cancelled();
        if (emits(shape.material_slot(shape.element_point(element, Vec2f(0.25f, 0.25f)).hit)))
            elements.push_back(element);
    }
    return elements;
}

const CameraDescription& required_camera(const SceneDescription& description) {
    if (!description.camera()) throw InputError("scene", "camera", "missing", "a camera to look through");
    return *description.camera();
}

/// Textures are known by their numbers in programs: all of them are part of what a program shows.
WorldLightKey world_light_key(const SceneDescription& description, const CameraInfo& camera) {
    ContentHasher hasher;
    description.world->add_to(hasher);
    if (description.existing_textures()) description.existing_textures()->add_to(hasher);
    if (description.world->reads_camera()) {
        const Affine3d& m = camera.world_to_camera;
        for (const Vec3d& column : {m.x, m.y, m.z, m.translation})
            for (int axis = 0; axis < 3; ++axis) hasher.add(column[axis]);
        for (const double number :
             {camera.window_min.x, camera.window_min.y, camera.window_size.x, camera.window_size.y})
            hasher.add(number);
    }
    return {hasher.value(), description.world_resolution};
}

std::shared_ptr<const WorldLight> world_light(const SceneDescription& description, const CameraInfo& camera,
                                              const WorldEmission& world, const CancelToken& cancel) {
    WorldLightStore& store = description.parts->world_lights;
    const WorldLightKey key = world_light_key(description, camera);
    store.next_user();
    std::shared_ptr<const WorldLight> table = store.find(key);
    if (table) return table;
    table = std::make_shared<const WorldLight>(world, key.width, cancel);
    store.keep(key, table);
    return table;
}

/// Volume objects have no surface that a ray could meet.
std::vector<TracedInstance> traced_instances(const SceneDescription& description,
                                             const std::vector<uint32_t>& volumes) {
    std::vector<TracedInstance> traced;
    traced.reserve(description.instances.size());
    for (const InstanceDescription& instance : description.instances)
        traced.push_back(
            {description.shapes[static_cast<size_t>(instance.shape)], instance.object_to_world, instance.visibility});
    for (const uint32_t volume : volumes) traced[volume].visibility = 0;
    return traced;
}

}  // namespace

Scene::Scene(const SceneDescription& description, const Settings& settings, const CancelToken& cancel)
    : materials_(description.materials),
      lists_(description.material_lists),
      world_(description.world),
      textures_(description.existing_textures()),
      shadow_bias_(settings.shadow_bias) {
    validate(settings);
    camera_ = std::make_unique<Camera>(required_camera(description), settings.width, settings.height);
    commit_materials(description);
    for (const InstanceDescription& instance : description.instances)
        interpolations_.push_back(
            instance.ray_interpolation < 0
                ? settings.ray_interpolation
                : description.ray_interpolations[static_cast<size_t>(instance.ray_interpolation)]);
    for (const InstanceDescription& instance : description.instances) volume_visibility_.push_back(instance.visibility);
    for (uint32_t i = 0; i < instance_lists_.size(); ++i)
        if (volume(i)) volumes_.push_back(i);
    std::vector<TracedInstance> traced = traced_instances(description, volumes_);
    std::vector<const std::vector<int>*> lists;
    for (uint32_t i = 0; i < traced.size(); ++i) lists.push_back(&material_list(i));
    displace(traced, description, lists, {&camera_->info(), textures_}, cancel);
    tracer_ = std::make_unique<Tracer>(
        std::move(traced), Camera(*description.dicing_camera(), settings.width, settings.height).dicing_view(), cancel,
        geometry_cache_settings(settings), &description.parts->shapes);
    cancel.throw_if_cancelled();
    commit_lights(description, cancel);
    commit_glass(description, cancel);
}

Scene::~Scene() = default;

void Scene::commit_materials(const SceneDescription& description) {
    const std::shared_ptr<const Program> neutral = neutral_program();
    materials_.push_back({"neutral material", neutral, 0, std::nullopt, {}});
    const int neutral_index = static_cast<int>(materials_.size()) - 1;
    for (Material& material : materials_) {
        if (!material.surface) material.surface = neutral;
        has_transparency_ |= material.surface->may_be_transparent();
        reads_footprints_ |= material.surface->reads_footprint();
    }
    for (std::vector<int>& list : lists_)
        for (int& material : list)
            if (material < 0) material = neutral_index;
    lists_.push_back({neutral_index});
    infos_.reserve(description.instances.size());
    instance_lists_.reserve(description.instances.size());
    for (const InstanceDescription& instance : description.instances) {
        infos_.push_back({instance.object_to_world, instance.object_to_world.inverse(), instance.object_index,
                          instance.random, instance.attributes});
        const bool has_list =
            instance.material_list >= 0 && !lists_[static_cast<size_t>(instance.material_list)].empty();
        instance_lists_.push_back(has_list ? instance.material_list : static_cast<int>(lists_.size()) - 1);
    }
}

void Scene::commit_glass(const SceneDescription& description, const CancelToken& cancel) {
    std::optional<Occupancy> occupancy;
    for (uint32_t i = 0; i < interpolations_.size(); ++i) {
        if (interpolations_[i].mode == RayInterpolationMode::Off) continue;
        const std::optional<GlassBody> body = glass_body_of(*this, i);
        if (!body) continue;
        if (!occupancy) occupancy.emplace(description, *tracer_, cancel);
        if (occupancy->is_occupied(i)) continue;
        glass_bodies_.resize(interpolations_.size());
        glass_bodies_[i] = body;
    }
}

const VolumeVisualisation* Scene::volume(uint32_t instance) const {
    const Material& first = material_at(material_list(instance).front());
    return first.volume ? &*first.volume : nullptr;
}

void Scene::set_ray_cache(uint32_t instance, std::shared_ptr<const ObjectCache> cache) {
    cached_ += (cache ? 1 : 0) - (tracer_->cache(instance) ? 1 : 0);
    tracer_->set_cache(instance, std::move(cache));
}

void Scene::commit_lights(const SceneDescription& description, const CancelToken& cancel) {
    std::vector<EmittingInstance> emitters;
    for (uint32_t i = 0; i < instance_lists_.size(); ++i) {
        const std::vector<int>& list = lists_[static_cast<size_t>(instance_lists_[i])];
        const auto emits = [&](uint32_t slot) { return material_of(list, slot).surface->emits(); };
        bool any = false;
        for (uint32_t slot = 0; slot < list.size(); ++slot) any |= emits(slot);
        if (!any) continue;
        std::vector<uint32_t> elements = emitting_elements(*tracer_->instance(i).shape, emits, cancel);
        if (!elements.empty()) emitters.push_back({i, std::move(elements)});
    }
    PathState sampled_light;  // what lights show to those who sample them: not what they show to the camera
    sampled_light.camera = false;
    const auto emission = [this, sampled_light](const SurfacePoint& point, const Vec3f& outgoing) {
        Closures closures;
        shade(point, outgoing, {}, sampled_light, closures);
        return closures.emission;
    };
    const auto world_emission = [this, sampled_light](const Vec3f& direction) {
        return world(direction, {}, sampled_light);
    };
    const bool sampled = world_ && world_->emits() && !world_->is_constant();
    std::shared_ptr<const WorldLight> table;
    if (sampled && description.world_resolution > 0)
        table = world_light(description, camera_->info(), world_emission, cancel);
    lights_ = std::make_unique<LightSet>(description.lamps, emitters, *tracer_, emission, world_emission,
                                         std::move(table), cancel);
}

const Material& Scene::material_of(const std::vector<int>& list, uint32_t slot) const {
    // A slot past the list shows the last material, as Blender does.
    const size_t clamped = std::min<size_t>(slot, list.size() - 1);
    return materials_[static_cast<size_t>(list[clamped])];
}

const Material& Scene::material(uint32_t instance, const LocalHit& hit) const {
    const std::vector<int>& list = lists_[static_cast<size_t>(instance_lists_[instance])];
    return material_of(list, list.size() == 1 ? 0 : tracer_->instance(instance).shape->material_slot(hit));
}

ShadingInputs Scene::shading_inputs(const SurfacePoint& point, const Vec3f& outgoing,
                                    const RayDifferential& differential, const PathState& path) const {
    ShadingInputs inputs;
    inputs.point = &point;
    inputs.instance = &infos_[point.instance];
    inputs.camera = &camera_->info();
    inputs.textures = textures_.get();
    inputs.outgoing = outgoing;
    inputs.differential = differential;
    inputs.path = path;
    inputs.material_index = material(point.instance, point.local).pass_index;
    return inputs;
}

void Scene::shade(const SurfacePoint& point, const Vec3f& outgoing, const RayDifferential& differential,
                  const PathState& path, Closures& result) const {
    material(point.instance, point.local)
        .surface->evaluate(shading_inputs(point, outgoing, differential, path), result);
}

Color Scene::world(const Vec3f& direction, const RayDifferential& differential, const PathState& path) const {
    if (!world_) return Color(0.0f);
    ShadingInputs inputs;
    inputs.camera = &camera_->info();
    inputs.textures = textures_.get();
    inputs.outgoing = -direction;
    inputs.differential = differential;
    inputs.path = path;
    Closures closures;
    world_->evaluate(inputs, closures);
    return closures.emission;
}

}  // namespace rayleaf
