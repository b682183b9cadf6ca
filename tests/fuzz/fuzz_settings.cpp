// Settings of any numbers over one scene that uses everything: refused with a message, or a tiny picture without NaN.
#include "fuzz_input.h"
#include "fuzz_scene.h"

using namespace rayleaf;

namespace {

/// Whether a render with these is small: the fuzzer looks for wrong answers, not for long ones.
bool is_small(const Settings& s) {
    return s.width <= 8 && s.height <= 8 && s.samples <= 2 && s.max_bounces <= 24 && s.glossy_rays <= 8 &&
           s.light_rays <= 8 && s.hemisphere_rays <= 32;
}

int drawn_int(fuzz::Bytes& bytes) {
    const uint8_t kind = bytes.byte();
    if (kind < 160) return kind % 12;
    if (kind < 240) return static_cast<int8_t>(bytes.byte());
    return kind < 248 ? std::numeric_limits<int>::max() : std::numeric_limits<int>::min();
}

RayInterpolation interpolation(fuzz::Bytes& bytes) {
    RayInterpolation drawn;
    drawn.mode = static_cast<RayInterpolationMode>(bytes.count(2));
    RayCacheSettings& t = drawn.thresholds;
    for (double* value :
         {&t.distance_threshold, &t.angle_threshold, &t.pruned_share, &t.direction_threshold, &t.rays_per_cell})
        if (bytes.flag()) *value = bytes.number();
    for (int* value : {&t.depth_limit, &t.mixed_depth_limit})
        if (bytes.flag()) *value = drawn_int(bytes);
    t.cache_bytes = bytes.flag() ? uint64_t{1} << bytes.count(24) : uint64_t{1} << 22;
    return drawn;
}

Settings settings(fuzz::Bytes& bytes) {
    Settings s;
    s.width = s.height = 5;
    s.samples = 1;
    s.threads = 1;
    for (int* value : {&s.width, &s.height, &s.crop_x, &s.crop_y, &s.crop_width, &s.crop_height, &s.samples,
                       &s.tile_size, &s.max_bounces, &s.diffuse_bounces, &s.glossy_bounces, &s.transmission_bounces,
                       &s.transparent_bounces, &s.roulette_start, &s.glossy_rays, &s.light_rays, &s.hemisphere_rays})
        if (bytes.byte() % 8 == 1) *value = drawn_int(bytes);
    for (float* value : {&s.clamp_direct, &s.clamp_indirect, &s.filter_width, &s.exposure, &s.film_glass_roughness,
                         &s.irradiance_error, &s.filter_glossy})
        if (bytes.byte() % 4 == 1) *value = static_cast<float>(bytes.number());
    for (double* value : {&s.shadow_bias, &s.occlusion_distance})
        if (bytes.byte() % 4 == 1) *value = bytes.number();
    s.seed = bytes.byte();
    s.film_transparent = bytes.flag();
    s.irradiance_cache = bytes.flag();
    s.filter = static_cast<PixelFilterKind>(bytes.count(2));
    s.integrator = static_cast<IntegratorKind>(bytes.count(1));
    s.indirect = static_cast<IndirectLight>(bytes.count(2));
    s.ray_interpolation = interpolation(bytes);
    for (const PassInfo& each : kPasses)
        if (bytes.flag() && each.pass != Pass::combined) s.passes.push_back(each.pass);
    return s;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    static const std::shared_ptr<const SceneDescription> scene = fuzz::small_scene();
    fuzz::Bytes bytes(data, size);
    fuzz::refusing([&] {
        const Settings drawn = settings(bytes);
        validate(drawn);
        if (is_small(drawn)) fuzz::check_render(scene, drawn);
    });
    return 0;
}
