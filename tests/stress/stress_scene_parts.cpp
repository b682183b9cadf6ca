// Scenes that are built and looked at by many threads, with one set of parts among them: each place of the ring wants
// facets of its own, and what is kept is found, replaced and dropped all the time. Each pixel is what it is without
// parts.
#include "base/random.h"
#include "integrators/dimensions.h"
#include "integrators/path.h"
#include "scene/scene.h"
#include "scene/scene_parts.h"
#include "stress.h"

using namespace rayleaf;

namespace {

constexpr int kSide = 4, kEdits = 4, kRounds = 3;

std::shared_ptr<const Program> world(int edit) {
    auto program = std::make_shared<Program>("world");
    const Register one = program->constant(Vec4f(1, 1, 1, 1));
    const Register strength = program->constant(Vec4f(static_cast<float>(1 + edit % 2)));
    program->operation("background", std::vector<Register>{one, program->operation("generated", {}), strength});
    return program;
}

/// The ring nearer or farther, under one of two worlds, with one of two images.
SceneDescription edited(int edit, const std::shared_ptr<SceneParts>& parts) {
    SceneDescription scene(parts);
    const std::vector<float> pixels(16 * 16 * 3, 0.1f * static_cast<float>(edit % 2));
    const TextureId image = scene.textures()->add_pixels("image", pixels, 16, 16, 3, ColorSpace::Linear);
    auto program = std::make_shared<Program>("image");
    const Register one = program->constant(Vec4f(1, 1, 1, 1));
    const int32_t lookup[] = {image, 0, 0};
    const Register color =
        program->operation("image", std::vector<Register>{program->operation("generated", {})}, lookup);
    program->operation("diffuse", std::vector<Register>{one, color});
    InstanceDescription instance;
    instance.name = "ring";
    instance.shape = scene.add_shape(stress::ring());
    instance.object_to_world.translation = {0, 0, -0.7 * edit};
    auto rising = std::make_shared<Program>("rising");
    const MaterialDisplacement displacement{rising, rising->constant(Vec4f(0, 0, 0.1f * static_cast<float>(edit), 1)),
                                            -1};
    const int material =
        scene.add_material({"image", program, 0, std::nullopt, edit < 2 ? MaterialDisplacement{} : displacement});
    instance.material_list = scene.add_material_list({material});
    scene.add_instance(instance);
    scene.set_world(world(edit), 16);
    CameraDescription camera;
    camera.to_world.translation = {0, 0, 6};
    camera.window_min = Vec2d(-0.3, -0.3);
    camera.window_max = Vec2d(0.3, 0.3);
    scene.set_camera(camera);
    return scene;
}

std::vector<Vec4f> picture(int edit, const std::shared_ptr<SceneParts>& parts) {
    Settings settings;
    settings.width = settings.height = kSide;
    settings.samples = 1;
    settings.passes = {Pass::combined};
    settings.resident_megabytes = 100;
    const Scene scene(edited(edit, parts), settings);
    const PathSettings path(settings);
    std::vector<Vec4f> pixels;
    for (int i = 0; i < kSide * kSide; ++i) {
        const Sampler sampler(static_cast<uint32_t>(i), 0, 1);
        const Vec2d place(i % kSide + 0.5, i / kSide + 0.5);
        RayCounts counts;
        const CameraRay ray = scene.camera().ray(place, sampler.get2(kLensDimension));
        pixels.push_back(trace_path(scene, path, ray, sampler, counts)[Pass::combined]);
    }
    return pixels;
}

}  // namespace

int main() {
    const stress::NoOtherThreads alone;
    std::vector<std::vector<Vec4f>> wanted;
    for (int edit = 0; edit < kEdits; ++edit) wanted.push_back(picture(edit, nullptr));
    stress::require(wanted[0] != wanted[1], "edits do not show");
    for (const int threads : {2, 5, 16}) {
        const auto parts = std::make_shared<SceneParts>();
        stress::run_together(threads, [&](int thread) {
            for (int round = 0; round < kRounds; ++round) {
                const int edit = (thread + round) % kEdits;
                stress::require(picture(edit, parts) == wanted[static_cast<size_t>(edit)], "another picture");
            }
        });
    }
}
