// The committed scene: everything a render reads, immutable. Built from a SceneDescription.
#pragma once

#include "film/mattes.h"
#include "lights/light.h"
#include "scene/camera.h"
#include "scene/description.h"
#include "scene/material_optics.h"
#include "scene/motion_vectors.h"
#include "scene/placed_instances.h"
#include "scene/scene_media.h"
#include "scene/settings.h"
#include "scene/traced_surroundings.h"
#include "shading/program.h"
#include "trace/tracer.h"

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace rayleaf {

class Scene {
  public:
    /// Validates, splits, builds. Throws InputError where nothing can be rendered (no camera, zero resolution).
    /// Throws Cancelled soon after `cancel` says so.
    Scene(const SceneDescription& description, const Settings& settings, const CancelToken& cancel = kNeverCancelled);
    ~Scene();
    Scene(const Scene&) = delete;
    Scene& operator=(const Scene&) = delete;

    const Tracer& tracer() const { return *tracer_; }
    const Camera& camera() const { return *camera_; }
    const LightSet& lights() const { return *lights_; }
    const TextureStore* textures() const { return textures_.get(); }

    /// Runs the material at a point.
    void shade(const SurfacePoint& point, const Vec3f& outgoing, const RayDifferential& differential,
               const PathState& path, Closures& result, const ProbeNumbers& probes) const;
    /// The same where a material cannot query its surroundings.
    void shade(const SurfacePoint& point, const Vec3f& outgoing, const RayDifferential& differential,
               const PathState& path, Closures& result) const;
    /// The inputs of a material's program at a point of it, which must outlive them.
    ShadingInputs shading_inputs(const SurfacePoint& point, const Material& material, const Vec3f& outgoing,
                                 const RayDifferential& differential, const PathState& path) const {
        return {.point = &point,
                .instance = &placed_.infos[point.instance],
                .camera = &camera_->info(),
                .textures = textures_.get(),
                .outgoing = outgoing,
                .differential = differential,
                .path = path,
                .material_index = material.pass_index,
                .probes = {}};
    }
    /// For materials that ask what is around.
    void offer_surroundings(ShadingInputs& inputs, const ProbeNumbers& probes) const {
        if (!asks_surroundings_) return;
        inputs.surroundings = &surroundings_.value();
        inputs.probes = probes;
    }
    /// The inputs of the world's program towards `direction`, and that program; null: the scene has none.
    ShadingInputs world_inputs(const Vec3f& direction, const RayDifferential& differential,
                               const PathState& path) const;
    const Program* world_program() const { return world_.get(); }
    /// The world's radiance where it is the same in all directions; else null.
    const Color* even_world() const { return even_world_ ? &*even_world_ : nullptr; }
    /// Radiance of the world seen along `direction`.
    /// `aovs`: where its program writes its AOVs.
    Color world(const Vec3f& direction, const RayDifferential& differential, const PathState& path,
                std::span<Vec4f> aovs = {}) const;
    const Material& material(uint32_t instance, const LocalHit& hit) const;
    /// The materials of an instance by slot, never empty, and a material of such a list.
    const std::vector<int>& material_list(uint32_t instance) const {
        const int list = placed_.lists[instance];
        return list < 0 ? lists_.back() : lists_[static_cast<size_t>(list)];
    }
    const Material& material_at(int index) const { return materials_[static_cast<size_t>(index)]; }

    const RayInterpolation& ray_interpolation(uint32_t instance) const {
        const int own = placed_.interpolations[instance];
        return own < 0 ? interpolation_ : interpolations_[static_cast<size_t>(own)];
    }
    /// What shows the length of rays inside an instance; null for objects with a surface. The first slot decides.
    const VolumeVisualisation* volume(uint32_t instance) const;
    /// Which rays see it.
    uint64_t volume_visibility(uint32_t instance) const {
        return seen_by(placed_.visibility[instance], placed_.linkings[instance].blocks);
    }
    /// Whether an instance shows the shadows that others cast on it, in place of itself.
    bool catches_shadows(uint32_t instance) const { return (placed_.visibility[instance] & kOfFootage) != 0; }
    /// The instances that have one; no ray meets their surface.
    const std::vector<uint32_t>& volumes() const { return volumes_; }
    /// The body of an instance of clear glass whose inside rays skip; null for others.
    const GlassBody* glass_body(uint32_t instance) const {
        return glass_bodies_.empty() || !glass_bodies_[instance] ? nullptr : &*glass_bodies_[instance];
    }
    /// A ray cache of some instances (null: none). Before rendering only.
    void set_ray_cache(std::span<const uint32_t> instances, const std::shared_ptr<const LocalRayCache>& cache);
    /// Whether what is seen by way of an interpolated hit depends on its ray differential.
    bool needs_differentials() const { return textures_ != nullptr || reads_footprints_ || cached_ > 1; }
    /// Whether anything depends on how far apart the rays of a picture are: dicing by the width of rays, textures, ray
    /// caches. If not, it need not be known.
    bool needs_footprints() const { return textures_ != nullptr || reads_footprints_ || needs_widths(); }
    /// Whether it matters how wide rays are: for dicing by their width, and for ray caches.
    bool needs_widths() const { return cached_ > 0 || tracer_->has_levels(); }
    /// The slot of the group to which light belongs (film/pass.h): an instance's, the world's, any sampled light's. -1:
    /// none.
    int light_group(uint32_t instance) const { return placed_.light_groups[instance]; }
    int world_light_group() const { return world_light_group_; }
    /// Whether rays of a kind see the world's light; to the others it is black.
    bool shows_world_to(Visibility kind) const {
        return has_world() && (seen_by(world_visibility_ | kOfFootage) & kind) != 0;
    }
    int light_group(const LightSample& light) const {
        if (light.world) return world_light_group_;
        return light.instance < 0 ? light.lamp_group : placed_.light_groups[static_cast<size_t>(light.instance)];
    }
    /// A point as lights see it: on an instance, or in its medium (SceneMedium's number).
    LitPoint lit(uint32_t instance, const Vec3d& position) const {
        if (!has_light_linking_) return {position};
        return {position, instance == SceneMedium::kWorld ? world_lit_by_ : linking(instance).lit_by};
    }
    LitPoint lit(const SurfacePoint& point) const { return lit(point.instance, point.position); }
    const LightLinking& linking(uint32_t instance) const { return placed_.linkings[instance]; }
    bool has_light_linking() const { return has_light_linking_; }
    /// Whether scattered rays must ask for lights with blockers of their own (integrators/blocked_light.h).
    bool has_blocked_lights() const { return has_blocked_lights_; }
    /// Whether a scattered ray from a point sees what an instance emits, where that is in its way.
    bool shines_openly_on(const LitPoint& from, uint32_t instance) const {
        if (!has_light_linking_) return true;
        const LightLink& link = linking(instance).as_light;
        return link.blockers < 0 && (link.set() & from.lit_by) != 0;
    }
    /// Of the description's instance.
    float shadow_terminator(uint32_t instance) const { return placed_.shadow_terminators[instance]; }
    /// What Cryptomatte calls a surface; where the settings ask for mattes.
    std::array<uint32_t, kMatteKinds> matte_ids(const SurfacePoint& point) const;
    float object_index(uint32_t instance) const { return placed_.infos[instance].object_index; }
    /// Whether any material lets light straight through, so that shadow rays have to ask.
    bool has_transparency() const { return has_transparency_; }
    /// Whether what shadow rays ask can be found by Tracer::pass.
    bool finds_passages() const { return finds_passages_; }
    /// Participating media, where there are any.
    const SceneMedia& media() const { return media_; }
    bool has_media() const { return has_media_; }
    /// World units (scene/settings.h).
    double shadow_bias() const { return shadow_bias_; }
    bool has_world() const { return world_ != nullptr; }
    /// Null where the settings ask for no vectors.
    const MotionVectors* motion_vectors() const { return motion_vectors_ ? &*motion_vectors_ : nullptr; }
    /// Whether anything moves while the shutter is open: then rays need a time.
    bool has_motion() const { return !motion_vectors_ && (camera_->moves() || tracer_->has_motion()); }

  private:
    std::vector<Material> materials_;
    std::shared_ptr<SceneParts> parts_;
    PlacedInstances placed_;
    std::vector<std::vector<int>> lists_;  ///< materials by slot; none empty, none negative; the last is neutral
    std::vector<std::optional<Color>> even_emissions_;  ///< per material, where its emission is known beforehand
    std::shared_ptr<const Program> world_;
    std::optional<Color> even_world_;  ///< the world's radiance, where it is the same in all directions
    std::shared_ptr<const TextureStore> textures_;
    std::unique_ptr<Camera> camera_;
    std::optional<MotionVectors> motion_vectors_;
    std::unique_ptr<Tracer> tracer_;
    std::unique_ptr<LightSet> lights_;
    std::vector<Lamp> lamps_;
    std::vector<InstanceInfo> lamp_infos_;
    RayInterpolation interpolation_;                ///< of instances without their own
    std::vector<RayInterpolation> interpolations_;  ///< their own
    std::vector<uint32_t> volumes_;
    std::vector<std::optional<GlassBody>> glass_bodies_;  ///< per instance, or none at all
    std::optional<TracedSurroundings> surroundings_;
    SceneMedia media_;
    double shadow_bias_ = 0;
    int cached_ = 0;  ///< instances with a ray cache
    int world_light_group_ = -1;
    uint8_t world_visibility_ = kVisibleAll;
    LightSets world_lit_by_ = kAllLightSets;
    bool is_as_described_ = true;     ///< what is placed; then another scene may begin with it
    bool asks_surroundings_ = false;  ///< some material's program does
    bool reads_footprints_ = false;   ///< some material's program does
    bool has_transparency_ = false;
    bool finds_passages_ = false;
    bool has_media_ = false;
    bool has_light_linking_ = false, has_blocked_lights_ = false;
    /// Hashes of names, where the settings ask for mattes.
    struct MatteIds {
        std::vector<uint32_t> objects, assets, materials;
    } matte_ids_;

    void commit_camera(CameraDescription camera, const Settings& settings);
    void commit_instances(const SceneDescription& description);
    void commit_motion(ChunkedVector<TracedInstance>& traced);
    void commit_mattes(const SceneDescription& description);
    void commit_materials();
    void commit_passages();
    void commit_media(const SceneDescription& description, const CancelToken& cancel);
    bool is_in_medium(uint32_t instance) const;
    void commit_glass(const SceneDescription& description, const CancelToken& cancel);
    void emit_surfaces(std::span<const EmitterPoint> points, Color* radiances) const;
    void emit_world(std::span<const WorldDirection> directions, Color* radiances) const;
    void emit_lamps(std::span<const LampPoint> points, Color* factors) const;
    void place_on_lamp(const LampPoint& lamp, SurfacePoint& point) const;
    void commit_lights(const SceneDescription& description, const Settings& settings, const CancelToken& cancel);
    std::vector<EmittingInstance> emitting_instances(const CancelToken& cancel) const;
    const Material& material_of(const std::vector<int>& list, uint32_t slot) const;
};

}  // namespace rayleaf
