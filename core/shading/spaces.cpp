#include "shading/spaces.h"

namespace rayleaf {
namespace {

/// Cycles' cameras look along +z.
enum class Space : int32_t { World, Object, Camera };

Vec3d moved(const Affine3d& map, TransformVariant variant, const Vec3d& v) {
    return variant == TransformVariant::POINT ? map.point(v) : map.vector(v);
}

Vec3d to_world(const ShadingInputs& inputs, Space space, TransformVariant variant, const Vec3d& v) {
    if (space == Space::Object && inputs.instance != nullptr)
        return moved(inputs.instance->object_to_world, variant, v);
    if (space != Space::Camera || inputs.camera == nullptr) return v;
    return moved(inputs.camera->world_to_camera.inverse(), variant, {v.x, v.y, -v.z});
}

Vec3d from_world(const ShadingInputs& inputs, Space space, TransformVariant variant, const Vec3d& v) {
    if (space == Space::Object && inputs.instance != nullptr)
        return moved(inputs.instance->world_to_object, variant, v);
    if (space != Space::Camera || inputs.camera == nullptr) return v;
    const Vec3d p = moved(inputs.camera->world_to_camera, variant, v);
    return {p.x, p.y, -p.z};
}

}  // namespace

Vec3f transform(TransformVariant variant, const ShadingInputs& inputs, std::span<const int32_t> ints, const Vec3f& v) {
    const auto from = static_cast<Space>(ints[0]), to = static_cast<Space>(ints[1]);
    Vec3d result(v);
    if (from != to) result = from_world(inputs, to, variant, to_world(inputs, from, variant, result));
    return variant == TransformVariant::NORMAL ? normalized_or(Vec3f(result), Vec3f(0.0f)) : Vec3f(result);
}

}  // namespace rayleaf
