#include "shading/spaces.h"

namespace rayleaf {
namespace {

/// Cycles' cameras look along +z.
enum class Space : int32_t { World, Object, Camera };

enum class Way { Point, Direction, Normal };

/// Along a map, whose inverse takes normals.
Vec3d moved(const Affine3d& map, const Affine3d& inverse, Way way, const Vec3d& v) {
    if (way == Way::Point) return map.point(v);
    if (way == Way::Direction) return map.vector(v);
    return {inverse.x.dot(v), inverse.y.dot(v), inverse.z.dot(v)};
}

Vec3d to_world(const ShadingInputs& inputs, Space space, Way way, const Vec3d& v) {
    if (space == Space::Object && inputs.instance != nullptr)
        return moved(inputs.object_to_world(), inputs.world_to_object(), way, v);
    if (space != Space::Camera || inputs.camera == nullptr) return v;
    const Affine3d& to_camera = inputs.camera->world_to_camera;
    return moved(to_camera.inverse(), to_camera, way, {v.x, v.y, -v.z});
}

Vec3d from_world(const ShadingInputs& inputs, Space space, Way way, const Vec3d& v) {
    if (space == Space::Object && inputs.instance != nullptr)
        return moved(inputs.world_to_object(), inputs.object_to_world(), way, v);
    if (space != Space::Camera || inputs.camera == nullptr) return v;
    const Affine3d& to_camera = inputs.camera->world_to_camera;
    const Vec3d p = moved(to_camera, to_camera.inverse(), way, v);
    return {p.x, p.y, -p.z};
}

}  // namespace

Vec3f transform(TransformVariant variant, const ShadingInputs& inputs, std::span<const int32_t> ints, const Vec3f& v) {
    const auto from = static_cast<Space>(ints[0]), to = static_cast<Space>(ints[1]);
    const bool keeps_normals = ints.size() > 2 && ints[2] != 0;
    const Way of_normals = keeps_normals ? Way::Normal : Way::Direction;
    const Way way = variant == TransformVariant::POINT    ? Way::Point
                    : variant == TransformVariant::NORMAL ? of_normals
                                                          : Way::Direction;
    Vec3d result(v);
    if (from != to) result = from_world(inputs, to, way, to_world(inputs, from, way, result));
    return variant == TransformVariant::NORMAL ? normalized_or(Vec3f(result), Vec3f(0.0f)) : Vec3f(result);
}

}  // namespace rayleaf
