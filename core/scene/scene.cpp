#include "scene/scene.h"

#include "base/error.h"
#include "scene/material_displacement.h"
#include "scene/occupancy.h"
#include "scene/ray_cache_plan.h"
#include "scene/scene_parts.h"
#include "scene/world_table.h"

namespace rayleaf {
namespace {

/// A lamp may be flat, or as good as.
Affine3d inverse_or_identity(const Affine3d& map) {
    const Affine3d inverse = map.inverse();
    const bool is_sound = is_finite(inverse.x) && is_finite(inverse.y) && is_finite(inverse.z);
    return is_sound && is_finite(inverse.translation) ? inverse : Affine3d();
}

/// What an object without a material looks like: Blender's default grey, diffuse.
std::shared_ptr<const Program> neutral_program() {
    Program program(kNeutralMaterial);
    const Register one = program.constant(Vec4f(1.0f));
    const Register grey = program.constant(Vec4f(0.8f, 0.8f, 0.8f, 1.0f));
    const Register operands[] = {one, grey};
    program.operation("diffuse", operands);
    return std::make_shared<const Program>(std::move(program));
}

/// The surface of an object of which only its medium is to be seen.
std::shared_ptr<const Program> clear_program() {
    Program program("border of a medium");
    const Register one = program.constant(Vec4f(1.0f));
    const Register operands[] = {one, one};
    program.operation("transparent", operands);
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

}  // namespace

Scene::Scene(const SceneDescription& description, const Settings& settings, const CancelToken& cancel)
    : materials_(description.materials),
      parts_(description.parts),
      lists_(description.material_lists),
      world_(description.world),
      textures_(description.existing_textures()),
      interpolation_(settings.ray_interpolation),
      interpolations_(description.ray_interpolations),
      shadow_bias_(settings.shadow_bias) {
    validate(settings);
    if (textures_) textures_->finish(cancel);
    commit_camera(required_camera(description), settings);
    if (wants_vectors(settings)) motion_vectors_.emplace(description, settings);
    commit_materials();
    commit_instances(description);
    ChunkedVector<TracedInstance> traced = placed_.traced;
    for (const uint32_t volume : volumes_) traced.edit(volume).visibility = 0;  // rays meet no surface of theirs
    commit_motion(traced);
    const auto list_of = [this](uint32_t i) -> const std::vector<int>& { return material_list(i); };
    if (!settings.draft) displace(traced, description, list_of, {camera_->info(), textures_}, cancel);
    DicingView view = Camera(*description.dicing_camera(), settings.width, settings.height).dicing_view();
    view.pixels = dicing_pixels(settings);
    view.coarsest = coarsest_tolerance(settings);
    view.coarsest_cached = coarsest_cached_tolerance(settings);
    tracer_ = std::make_unique<Tracer>(std::move(traced), view, cancel, geometry_cache_settings(settings),
                                       &description.parts->shapes);
    commit_passages();
    if (asks_surroundings_) surroundings_.emplace(*tracer_);
    cancel.throw_if_cancelled();
    commit_media(description, cancel);
    commit_lights(description, settings, cancel);
    if (std::any_of(settings.passes.begin(), settings.passes.end(), is_matte)) commit_mattes(description);
    commit_glass(description, cancel);
}

Scene::~Scene() {
    if (is_as_described_) parts_->instances.give_back(std::move(placed_));
}

void Scene::commit_camera(CameraDescription camera, const Settings& settings) {
    if (wants_vectors(settings)) {
        camera.motion.clear();
        camera.windows.clear();
    }
    camera_ = std::make_unique<Camera>(camera, settings.width, settings.height);
}

void Scene::commit_materials() {
    const std::shared_ptr<const Program> neutral = neutral_program();
    materials_.push_back({kNeutralMaterial, neutral, 0, std::nullopt, {}});
    const int neutral_index = static_cast<int>(materials_.size()) - 1;
    for (Material& material : materials_) {
        if (!material.surface) material.surface = material.bounds_medium_alone ? clear_program() : neutral;
        has_transparency_ |= material.surface->may_be_transparent();
        reads_footprints_ |= material.surface->reads_footprint();
        asks_surroundings_ |= material.surface->asks_surroundings();
        even_emissions_.push_back(material.surface->even_emission());
    }
    if (world_) even_world_ = world_->even_emission();
    for (std::vector<int>& list : lists_) {
        if (list.empty()) list.push_back(neutral_index);
        for (int& material : list)
            if (material < 0) material = neutral_index;
    }
    lists_.push_back({neutral_index});
}

void Scene::commit_instances(const SceneDescription& description) {
    const auto likeness = [&](const PlacedInstances& spare) { return spare.likeness(description); };
    if (std::optional<PlacedInstances> spare = parts_->instances.take(likeness)) placed_ = std::move(*spare);
    placed_.update(description);
    const auto is_volume = [](const Material& material) { return material.volume.has_value(); };
    if (!std::any_of(materials_.begin(), materials_.end(), is_volume)) return;
    for (uint32_t i = 0; i < placed_.lists.size(); ++i)
        if (volume(i)) volumes_.push_back(i);
}

/// What is seen as by x-rays, and media that vary, are looked up where the instance is in the middle of the time: these
/// stand still.
void Scene::commit_motion(ChunkedVector<TracedInstance>& traced) {
    if (placed_.moving == 0) return;
    for (uint32_t i = 0; i < traced.size(); ++i) {
        if (!traced[i].motion) continue;
        const std::vector<int>& list = material_list(i);
        const bool varies = std::any_of(list.begin(), list.end(), [this](int index) {
            const Material& material = material_at(index);
            return material.volume || (material.medium && material.medium->varies_in_space());
        });
        if (!varies && !motion_vectors_) continue;
        traced.edit(i).motion = nullptr;
        placed_.infos[i].motion = nullptr;
        is_as_described_ = false;
    }
}

void Scene::commit_passages() {
    if (!has_transparency_) return;
    const auto has_medium = [this](int index) { return material_at(index).medium != nullptr; };
    const auto is_open = [this](int index) { return material_at(index).surface->may_be_transparent(); };
    std::vector<LightPassage> of_lists;
    for (const std::vector<int>& list : lists_)
        of_lists.push_back(std::ranges::any_of(list, has_medium) ? LightPassage::Unknown
                           : std::ranges::any_of(list, is_open)  ? LightPassage::Surface
                                                                 : LightPassage::Closed);
    std::vector<LightPassage> passages;
    for (const int list : placed_.lists)
        passages.push_back(list < 0 ? of_lists.back() : of_lists[static_cast<size_t>(list)]);
    tracer_->set_passages(std::move(passages));
    finds_passages_ = tracer_->finds_passages();
}

void Scene::commit_mattes(const SceneDescription& description) {
    const auto id = [](const std::string& name) { return matte_id(matte_hash(name)); };
    for (const InstanceDescription& instance : description.instances) {
        matte_ids_.objects.push_back(id(instance.name));
        matte_ids_.assets.push_back(id(asset_of(instance)));
    }
    for (const Material& material : materials_) matte_ids_.materials.push_back(id(material.name));
}

std::array<uint32_t, kMatteKinds> Scene::matte_ids(const SurfacePoint& point) const {
    const Material& material = this->material(point.instance, point.local);
    const auto index = static_cast<size_t>(&material - materials_.data());
    return {matte_ids_.objects[point.instance], matte_ids_.materials[index], matte_ids_.assets[point.instance]};
}

void Scene::commit_media(const SceneDescription& description, const CancelToken& cancel) {
    media_.set_surroundings({tracer_.get(), &placed_.infos, &camera_->info(), textures_.get()},
                            description.world_medium);
    const auto holds_medium = [](const Material& material) { return material.medium != nullptr; };
    if (std::any_of(materials_.begin(), materials_.end(), holds_medium))
        for (uint32_t i = 0; i < placed_.lists.size(); ++i)
            for (const int index : material_list(i))
                if (const Material& material = material_at(index); material.medium) media_.add(i, material);
    media_.commit(cancel);
    has_media_ = !media_.empty();
}

/// Whether a medium may lie in the box of an instance, its own or another's.
bool Scene::is_in_medium(uint32_t instance) const {
    if (media_.world()) return true;
    const Box3d box = tracer_->bounds(instance);
    return std::any_of(media_.instances().begin(), media_.instances().end(),
                       [&](uint32_t other) { return box.intersects(tracer_->bounds(other)); });
}

void Scene::commit_glass(const SceneDescription& description, const CancelToken& cancel) {
    const auto is_off = [](const RayInterpolation& each) { return each.mode == RayInterpolationMode::Off; };
    if (is_off(interpolation_) && std::all_of(interpolations_.begin(), interpolations_.end(), is_off)) return;
    std::optional<Occupancy> occupancy;
    for (uint32_t i = 0; i < placed_.lists.size(); ++i) {
        if (is_off(ray_interpolation(i))) continue;
        const std::optional<GlassBody> body = glass_body_of(*this, i);
        if (!body || is_in_medium(i)) continue;
        if (!occupancy) occupancy.emplace(description, *tracer_, cancel);
        if (occupancy->is_occupied(i)) continue;
        glass_bodies_.resize(placed_.lists.size());
        glass_bodies_[i] = body;
    }
}

const VolumeVisualisation* Scene::volume(uint32_t instance) const {
    const Material& first = material_at(material_list(instance).front());
    return first.volume ? &*first.volume : nullptr;
}

void Scene::set_ray_cache(std::span<const uint32_t> instances, const std::shared_ptr<const LocalRayCache>& cache) {
    for (const uint32_t instance : instances) cached_ += (cache ? 1 : 0) - (tracer_->cache(instance) ? 1 : 0);
    tracer_->set_cache(instances, cache);
}

std::vector<EmittingInstance> Scene::emitting_instances(const CancelToken& cancel) const {
    std::vector<uint8_t> list_emits;
    for (const std::vector<int>& list : lists_) {
        const auto emits = [this](int material) { return material_at(material).surface->emits(); };
        list_emits.push_back(std::any_of(list.begin(), list.end(), emits) ? 1 : 0);
    }
    std::vector<EmittingInstance> emitters;
    for (uint32_t i = 0; i < placed_.lists.size(); ++i) {
        const std::vector<int>& list = material_list(i);
        if (list_emits[static_cast<size_t>(&list - lists_.data())] == 0) continue;
        const auto emits = [&](uint32_t slot) { return material_of(list, slot).surface->emits(); };
        std::vector<uint32_t> elements = emitting_elements(*tracer_->instance(i).shape, emits, cancel);
        if (!elements.empty()) emitters.push_back({i, std::move(elements), linking(i).as_light});
    }
    return emitters;
}

void Scene::commit_lights(const SceneDescription& description, const Settings& settings, const CancelToken& cancel) {
    const auto even = [this](uint32_t instance, const LocalHit& hit) {
        const std::optional<Color>& color =
            even_emissions_[static_cast<size_t>(&material(instance, hit) - materials_.data())];
        return color ? &*color : nullptr;
    };
    const bool sampled = world_ && world_->emits() && !world_->is_constant();
    std::shared_ptr<const WorldLight> table;
    // Distribution ray tracing leaves all direct light of diffuse surfaces to sampling.
    const WorldShare share = settings.integrator == IntegratorKind::Path ? WorldShare::AboveMean : WorldShare::All;
    if (sampled && description.world_resolution > 0)
        table = world_table(description, world_inputs(Vec3f(0, 0, 1), {}, sampling_state()),
                            settings.draft ? kDraftWorldWidth : description.world_resolution, share, cancel);
    world_light_group_ = description.world_light_group;
    world_visibility_ = description.world_visibility;
    world_lit_by_ = description.world_lit_by;
    lamps_ = description.lamps;
    for (const Lamp& lamp : lamps_) lamp_infos_.push_back({lamp.to_world, inverse_or_identity(lamp.to_world)});
    Emissions emissions;
    emissions.surface = [this](std::span<const EmitterPoint> points, Color* to) { emit_surfaces(points, to); };
    emissions.even = even;
    // The sides of what shines itself are known by their normals.
    emissions.blocks = [this](uint32_t instance, const LocalHit& hit) {
        const Material& met = material(instance, hit);
        if (met.volume || met.bounds_medium_alone) return false;
        return !met.surface || !(met.surface->emits() || met.surface->may_be_transparent());
    };
    emissions.world = [this](std::span<const WorldDirection> directions, Color* to) { emit_world(directions, to); };
    emissions.lamp = [this](std::span<const LampPoint> points, Color* to) { emit_lamps(points, to); };
    emissions.world_visibility = world_visibility_;
    lights_ = std::make_unique<LightSet>(lamps_, emitting_instances(cancel), *tracer_, std::move(emissions),
                                         std::move(table), cancel);
    has_light_linking_ = placed_.linked > 0 || world_lit_by_ != kAllLightSets || lights_->has_links();
    has_blocked_lights_ = !lights_->emitters_with_blockers().empty() || lights_->has_hittable_lamps_with_blockers();
}

const Material& Scene::material_of(const std::vector<int>& list, uint32_t slot) const {
    // A slot past the list shows the last material, as Blender does.
    const size_t clamped = std::min<size_t>(slot, list.size() - 1);
    return materials_[static_cast<size_t>(list[clamped])];
}

const Material& Scene::material(uint32_t instance, const LocalHit& hit) const {
    const std::vector<int>& list = material_list(instance);
    return material_of(list, list.size() == 1 ? 0 : tracer_->instance(instance).shape->material_slot(hit));
}

void Scene::shade(const SurfacePoint& point, const Vec3f& outgoing, const RayDifferential& differential,
                  const PathState& path, Closures& result, const ProbeNumbers& probes) const {
    const Material& material = this->material(point.instance, point.local);
    ShadingInputs inputs = shading_inputs(point, material, outgoing, differential, path);
    offer_surroundings(inputs, probes);
    material.surface->evaluate(inputs, result);
}

void Scene::shade(const SurfacePoint& point, const Vec3f& outgoing, const RayDifferential& differential,
                  const PathState& path, Closures& result) const {
    const Material& material = this->material(point.instance, point.local);
    material.surface->evaluate(shading_inputs(point, material, outgoing, differential, path), result);
}

ShadingInputs Scene::world_inputs(const Vec3f& direction, const RayDifferential& differential,
                                  const PathState& path) const {
    ShadingInputs inputs;
    inputs.camera = &camera_->info();
    inputs.textures = textures_.get();
    inputs.outgoing = -direction;
    inputs.differential = differential;
    inputs.path = path;
    return inputs;
}

Color Scene::world(const Vec3f& direction, const RayDifferential& differential, const PathState& path,
                   std::span<Vec4f> aovs) const {
    if (!world_) return Color(0.0f);
    if (even_world_ && aovs.empty()) return *even_world_;
    Closures closures;
    closures.aovs = aovs;
    world_->evaluate(world_inputs(direction, differential, path), closures);
    return closures.emission;
}

}  // namespace rayleaf
