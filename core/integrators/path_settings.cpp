#include "integrators/path.h"
#include "scene/ray_cache_plan.h"

#include <limits>

namespace rayleaf {
namespace {

float limit_or_infinity(float limit) {
    return limit > 0.0f ? limit : std::numeric_limits<float>::infinity();
}

constexpr uint64_t bit(Pass pass) {
    return uint64_t{1} << static_cast<uint32_t>(pass);
}
static_assert(kPassCount <= 64, "each pass needs a bit of a uint64_t");

constexpr uint64_t kLightPasses = bit(Pass::diffuse_direct) | bit(Pass::diffuse_indirect) | bit(Pass::glossy_direct) |
                                  bit(Pass::glossy_indirect) | bit(Pass::transmission_direct) |
                                  bit(Pass::transmission_indirect) | bit(Pass::volume_direct) |
                                  bit(Pass::volume_indirect);
constexpr uint64_t kFeaturePasses =
    bit(Pass::denoising_normal) | bit(Pass::denoising_albedo) | bit(Pass::denoising_depth);
constexpr uint64_t kColorPasses = bit(Pass::diffuse_color) | bit(Pass::glossy_color) | bit(Pass::transmission_color);
constexpr uint64_t kSurfacePasses = bit(Pass::depth) | bit(Pass::mist) | bit(Pass::position) | bit(Pass::normal) |
                                    bit(Pass::uv) | bit(Pass::vector) | bit(Pass::object_index) |
                                    bit(Pass::material_index) | bit(Pass::ambient_occlusion);
constexpr uint64_t kRayPasses = bit(Pass::mask) | bit(Pass::tree_index) | bit(Pass::mask_colors) |
                                bit(Pass::interpolation_error) | bit(Pass::path_length) | bit(Pass::geometry_level);

}  // namespace

PathSettings::PathSettings(const Settings& s)
    : max_bounces(s.max_bounces),
      diffuse_bounces(s.diffuse_bounces),
      glossy_bounces(s.glossy_bounces),
      transmission_bounces(s.transmission_bounces),
      transparent_bounces(s.transparent_bounces),
      volume_bounces(s.volume_bounces),
      roulette_start(s.roulette_start),
      most_interior_hits(rayleaf::most_interior_hits(s)),
      clamp_direct(limit_or_infinity(s.clamp_direct)),
      clamp_indirect(limit_or_infinity(s.clamp_indirect)),
      occlusion_distance(s.occlusion_distance > 0 ? s.occlusion_distance : std::numeric_limits<double>::infinity()),
      filter_glossy(s.filter_glossy),
      reflective_caustics(s.reflective_caustics),
      refractive_caustics(s.refractive_caustics),
      drops_caustics(!s.reflective_caustics || !s.refractive_caustics),
      exposure(s.exposure),
      film_transparent(s.film_transparent),
      film_glass_roughness(s.film_glass_roughness),
      passes(0),
      slots(0),
      mattes(false),
      mist_start(s.mist_start),
      mist_depth(s.mist_depth),
      mist_falloff(s.mist_falloff),
      importance_levels(s.importance_levels),
      least_mirrored_spread(s.least_mirrored_spread) {
    for (const Pass pass : s.passes) {
        if (is_matte(pass))
            mattes = true;
        else if (is_slot(pass))
            slots = std::max(slots, slot_of(pass) + 1);
        else
            passes |= bit(pass);
    }
    light_passes = (passes & kLightPasses) != 0;
    color_passes = (passes & kColorPasses) != 0;
    ray_passes = (passes & kRayPasses) != 0;
    held_passes = passes | bit(Pass::combined) | (ray_passes ? kRayPasses : 0);
    surface_passes = (passes & kSurfacePasses) != 0 || slots > 0;
    feature_passes = (passes & kFeaturePasses) != 0;
    catches_shadows = wants(Pass::footage_light);
    shows_footage = wants(Pass::footage);
}

RayWidening PathSettings::widening(float importance, bool scattered) const {
    /// One level coarser at most: there are many dim rays, and together they are seen.
    constexpr float kWidest = 4.0f;
    RayWidening widening;
    if (importance_levels && importance < 1.0f)
        widening.factor = std::min(kWidest, 1.0f / std::sqrt(std::max(importance, 1.0f / (kWidest * kWidest))));
    if (scattered) widening.least_spread = least_mirrored_spread;
    return widening;
}

}  // namespace rayleaf
