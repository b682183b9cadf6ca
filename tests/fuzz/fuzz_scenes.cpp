// Scene descriptions: cameras, lamps, matrices, materials, indices of any numbers: refused with a message, or a tiny
// picture without NaN.
#include "fuzz_scene.h"

using namespace rayleaf;

namespace {

Affine3d matrix(fuzz::Bytes& bytes) {
    Affine3d drawn;
    if (bytes.flag()) return drawn;
    for (Vec3d* column : {&drawn.x, &drawn.y, &drawn.z, &drawn.translation})
        for (int axis = 0; axis < 3; ++axis) (*column)[axis] = bytes.number();
    return drawn;
}

/// To none, to a set of receivers, of blockers, or both.
LightLink link(uint8_t byte) {
    LightLink drawn;
    if (byte % 5 == 2 || byte % 5 == 4) drawn.receivers = static_cast<int8_t>(byte % 3);
    if (byte % 5 >= 3) drawn.blockers = static_cast<int8_t>(byte % 2);
    return drawn;
}

void add_lamp(SceneDescription& scene, fuzz::Bytes& bytes) {
    Lamp lamp;
    lamp.name = "lamp";
    lamp.kind = static_cast<LampKind>(bytes.count(kLampKinds - 1));
    lamp.to_world = matrix(bytes);
    lamp.strength = Color(static_cast<float>(bytes.number()));
    for (double* value :
         {&lamp.radius, &lamp.angle, &lamp.spot_size, &lamp.spot_blend, &lamp.size_x, &lamp.size_y, &lamp.spread})
        if (bytes.flag()) *value = bytes.number();
    lamp.spot_profile = bytes.flag() ? SpotProfile::Even : SpotProfile::Cosine;
    lamp.casts_shadow = bytes.flag();
    const uint8_t seen = bytes.byte();
    lamp.visibility = seen;
    // Of a byte that is there: kept cases mean what they did.
    lamp.soft_falloff = seen % 3 == 1;
    lamp.link = link(seen);
    scene.add_lamp(lamp);
}

Material material(fuzz::Bytes& bytes) {
    constexpr const char* kClosures[] = {"diffuse", "translucent", "transparent", "emission", "glossy", "glass"};
    const size_t kind = bytes.byte() % std::size(kClosures);
    const float value = static_cast<float>(bytes.number()), second = static_cast<float>(bytes.number());
    Material drawn = kind < 3   ? fuzz::plain(kClosures[kind], {})
                     : kind < 5 ? fuzz::plain(kClosures[kind], {value}, kind == 4 ? "GGX" : "")
                                : fuzz::plain(kClosures[kind], {value, second}, "GGX");
    if (bytes.byte() % 4 == 1) {
        drawn.volume = VolumeVisualisation{};
        drawn.volume->kind = static_cast<VolumeVisualisation::Kind>(bytes.count(1));
        drawn.volume->density = static_cast<float>(bytes.number());
        drawn.volume->color = Color(static_cast<float>(bytes.number()));
    }
    return drawn;
}

void add_instance(SceneDescription& scene, fuzz::Bytes& bytes) {
    InstanceDescription instance;
    instance.name = "object";
    instance.shape = bytes.count(4) - 1;
    instance.object_to_world = matrix(bytes);
    instance.material_list = bytes.count(5) - 1;
    const uint8_t seen = bytes.byte();
    instance.visibility = seen;
    instance.linking.as_light = link(seen);
    if (seen % 4 == 3) instance.linking.lit_by = kLightsOfAll | LightSets{seen} % 8;
    if (seen % 4 >= 2) instance.linking.blocks = seen % 3;
    if (bytes.flag()) instance.visibility = kVisibleAll;
    instance.ray_interpolation = bytes.count(2) - 1;
    scene.add_instance(instance);
}

CameraDescription camera(fuzz::Bytes& bytes) {
    CameraDescription drawn;
    drawn.to_world.translation = {0, 0, 3};
    if (bytes.flag()) drawn.to_world = matrix(bytes);
    drawn.kind = bytes.flag() ? CameraKind::Perspective : CameraKind::Orthographic;
    for (double* value : {&drawn.clip_start, &drawn.clip_end, &drawn.aperture_radius, &drawn.focus_distance,
                          &drawn.blade_rotation, &drawn.aperture_ratio, &drawn.window_min.x, &drawn.window_max.y})
        if (bytes.byte() % 4 == 1) *value = bytes.number();
    drawn.blades = static_cast<int8_t>(bytes.byte());
    return drawn;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    fuzz::Bytes bytes(data, size);
    const auto scene = std::make_shared<SceneDescription>();
    scene->add_shape(fuzz::square());
    scene->add_shape(fuzz::patch());
    scene->add_shape(fuzz::strand());
    scene->add_ray_interpolation("object", {});
    fuzz::refusing([&] { scene->add_material_list({scene->add_material(material(bytes)), bytes.count(3) - 1}); });
    fuzz::refusing([&] { scene->add_material_list({scene->add_material(material(bytes))}); });
    for (int i = bytes.count(3); i >= 0; --i) fuzz::refusing([&] { add_instance(*scene, bytes); });
    for (int i = bytes.count(2); i > 0; --i) fuzz::refusing([&] { add_lamp(*scene, bytes); });
    fuzz::refusing([&] {
        auto world = std::make_shared<Program>("world");
        const float strength = static_cast<float>(bytes.number());
        const Register one = world->constant(Vec4f(1, 1, 1, 1)), strong = world->constant(Vec4f(strength));
        world->operation("background", std::vector<Register>{one, one, strong});
        scene->set_world(world, static_cast<int8_t>(bytes.byte()));
    });
    fuzz::refusing([&] {
        scene->set_camera(camera(bytes));
        Settings settings;
        settings.width = settings.height = 4;
        settings.samples = settings.threads = 1;
        settings.integrator = bytes.flag() ? IntegratorKind::Path : IntegratorKind::Distribution;
        fuzz::check_render(scene, settings);
    });
    return 0;
}
