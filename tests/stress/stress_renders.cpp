// Whole paths by many threads: one scene with a geometry cache, ray caches and a texture store that are all too small.
// Each pixel is what one thread makes of it with all the memory it wants.
#include "base/random.h"
#include "integrators/dimensions.h"
#include "integrators/path.h"
#include "render/ray_caches.h"
#include "stress.h"

using namespace rayleaf;

namespace {

constexpr int kSide = 8;

int material(SceneDescription& scene, const std::string& closure, std::initializer_list<float> operands,
             const std::string& text = {}) {
    auto program = std::make_shared<Program>(closure);
    std::vector<Register> read = {program->constant(Vec4f(1, 1, 1, 1)), program->constant(Vec4f(0.8f, 0.7f, 0.6f, 1))};
    for (const float value : operands) read.push_back(program->constant(Vec4f(value, value, value, value)));
    program->operation(closure, read, {}, {}, text);
    return scene.add_material_list({scene.add_material({closure, program, 0, std::nullopt, {}})});
}

std::shared_ptr<SceneDescription> rings() {
    auto scene = std::make_shared<SceneDescription>();
    const int shape = scene->add_shape(stress::ring());
    const int lists[] = {material(*scene, "glass", {0.0f, 1.5f}, "SHARP"), material(*scene, "glossy", {0.0f}, "SHARP"),
                         material(*scene, "diffuse", {})};
    for (int i = 0; i < 3; ++i) {
        InstanceDescription instance;
        instance.name = "ring " + std::to_string(i);
        instance.shape = shape;
        instance.object_to_world.translation = {0, 0, 1.2 * (1 - i)};
        instance.material_list = lists[i];
        scene->add_instance(instance);
    }
    auto world = std::make_shared<Program>("world");
    const Register one = world->constant(Vec4f(1, 1, 1, 1));
    world->operation("background", std::vector<Register>{one, world->operation("generated", {}), one});
    scene->set_world(world, 16);
    CameraDescription camera;
    camera.to_world.translation = {0, 0, 6};
    camera.window_min = Vec2d(-0.3, -0.3);
    camera.window_max = Vec2d(0.3, 0.3);
    scene->set_camera(camera);
    return scene;
}

Settings settings(uint64_t ray_cache_bytes, double geometry_megabytes) {
    Settings result;
    result.width = result.height = kSide;
    result.samples = 2;
    result.passes = {Pass::combined, Pass::mask};
    result.geometry_cache_megabytes = geometry_megabytes;
    result.resident_megabytes = 0;  // all facets go through the cache
    result.ray_interpolation.mode = RayInterpolationMode::On;
    result.ray_interpolation.thresholds.cache_bytes = ray_cache_bytes;
    result.ray_interpolation.thresholds.rays_per_cell = 0;
    result.ray_interpolation.thresholds.depth_limit = 28;
    result.ray_interpolation.thresholds.mixed_depth_limit = 28;
    result.ray_interpolation.thresholds.distance_threshold = 10;
    result.ray_interpolation.thresholds.direction_threshold = 4;
    result.ray_interpolation.thresholds.angle_threshold = 4;
    return result;
}

PixelSample pixel(const Scene& scene, const PathSettings& path, int number) {
    const Sampler sampler(static_cast<uint32_t>(number), 0, 1);
    const Vec2d place(number % kSide + 0.5, number / kSide + 0.5);
    RayCounts counts;
    return trace_path(scene, path, scene.camera().ray(place, sampler.get2(kLensDimension)), sampler, counts);
}

}  // namespace

int main() {
    const stress::NoOtherThreads alone;
    const std::shared_ptr<SceneDescription> description = rings();
    std::vector<PixelSample> wanted;
    for (const auto& [threads, cache_bytes, megabytes] :
         {std::tuple{1, 50'000'000, 100.0}, {3, 200'000, 0.15}, {12, 150'000, 0.4}}) {
        const Settings used = settings(static_cast<uint64_t>(cache_bytes), megabytes);
        Scene scene(*description, used);
        RayCacheStore store;
        const RayCaches caches(*description, scene, used, &store);
        const PathSettings path(used);
        if (threads == 1)
            for (int i = 0; i < kSide * kSide; ++i) wanted.push_back(pixel(scene, path, i));
        stress::run_together(threads, [&](int thread) {
            for (int i = 0; i < kSide * kSide; ++i) {
                const int number = (i + 37 * thread) % (kSide * kSide);
                const PixelSample found = pixel(scene, path, number);
                for (const Pass pass : used.passes)
                    stress::require(found[pass] == wanted[static_cast<size_t>(number)][pass], "another pixel");
            }
            stress::require(caches.report().size() == 2 && store.bytes() > 0, "no caches");
        });
        for (const RayCacheReport& report : caches.report())
            stress::require(totals_of(report.statistics).interpolated > 0, "nothing was interpolated");
    }
}
