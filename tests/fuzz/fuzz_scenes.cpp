// Settings, cameras, lamps and matrices of any numbers: refused with a message, or a tiny picture without NaN.
#include "fuzz_input.h"
#include "geometry/triangle_mesh.h"
#include "render/session.h"

using namespace rayleaf;

namespace {

Affine3d matrix(fuzz::Bytes& bytes) {
    Affine3d drawn;
    if (bytes.flag()) return drawn;
    for (Vec3d* column : {&drawn.x, &drawn.y, &drawn.z, &drawn.translation})
        for (int axis = 0; axis < 3; ++axis) (*column)[axis] = bytes.number();
    return drawn;
}

std::shared_ptr<Shape> square() {
    static const std::vector<float> places = {-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0};
    static const std::vector<int32_t> corners = {0, 1, 2, 0, 2, 3};
    TriangleMeshArrays arrays;
    arrays.name = "square";
    arrays.vertices = places;
    arrays.triangles = corners;
    return std::make_shared<TriangleMesh>(std::move(arrays));
}

void add_lamp(SceneDescription& scene, fuzz::Bytes& bytes) {
    Lamp lamp;
    lamp.name = "lamp";
    lamp.kind = static_cast<LampKind>(bytes.count(4));
    lamp.to_world = matrix(bytes);
    lamp.strength = Color(static_cast<float>(bytes.number()));
    for (double* value : {&lamp.radius, &lamp.angle, &lamp.spot_size, &lamp.spot_blend, &lamp.size_x, &lamp.size_y,
                          &lamp.spread})
        if (bytes.flag()) *value = bytes.number();
    scene.add_lamp(lamp);
}

Settings settings(fuzz::Bytes& bytes) {
    Settings drawn;
    drawn.width = drawn.height = 4;
    drawn.samples = 1;
    drawn.threads = 1;
    if (bytes.flag()) drawn.filter_width = static_cast<float>(bytes.number());
    if (bytes.flag()) drawn.exposure = static_cast<float>(bytes.number());
    if (bytes.flag()) drawn.clamp_direct = static_cast<float>(bytes.number());
    if (bytes.flag()) drawn.clamp_indirect = static_cast<float>(bytes.number());
    if (bytes.flag()) drawn.max_bounces = static_cast<int8_t>(bytes.byte());
    if (bytes.flag()) drawn.crop_x = static_cast<int8_t>(bytes.byte());
    if (bytes.flag()) drawn.crop_width = drawn.crop_height = static_cast<int8_t>(bytes.byte());
    if (bytes.flag()) drawn.tile_size = static_cast<int8_t>(bytes.byte());
    return drawn;
}

CameraDescription camera(fuzz::Bytes& bytes) {
    CameraDescription drawn;
    drawn.to_world.translation = {0, 0, 3};
    if (bytes.flag()) drawn.to_world = matrix(bytes);
    for (double* value : {&drawn.clip_start, &drawn.clip_end, &drawn.aperture_radius, &drawn.focus_distance,
                          &drawn.blade_rotation, &drawn.aperture_ratio})
        if (bytes.flag()) *value = bytes.number();
    return drawn;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    fuzz::Bytes bytes(data, size);
    auto scene = std::make_shared<SceneDescription>();
    const int shape = scene->add_shape(square());
    for (int i = bytes.count(2); i >= 0; --i)
        fuzz::refusing([&] {
            InstanceDescription instance;
            instance.name = "square";
            instance.shape = bytes.byte() == 7 ? 3 : shape;
            instance.object_to_world = matrix(bytes);
            scene->add_instance(instance);
        });
    for (int i = bytes.count(2); i > 0; --i) fuzz::refusing([&] { add_lamp(*scene, bytes); });
    fuzz::refusing([&] {
        scene->set_camera(camera(bytes));
        Session session(scene, settings(bytes));
        fuzz::require(session.render());
        for (const float value : session.film().pixels(Pass::combined)) fuzz::require(std::isfinite(value));
    });
    return 0;
}
