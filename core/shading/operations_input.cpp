#include "shading/operations_input.h"

#include "geometry/volume_grids.h"
#include "shading/fresnel.h"
#include "shading/operations_closure.h"
#include "shading/spaces.h"
#include "shading/tangents.h"
#include "shading/variants.h"

namespace rayleaf {

bool is_backfacing(const ShadingInputs& inputs) {
    return inputs.point != nullptr && inputs.point->facet_normal.dot(inputs.outgoing) < 0.0f;
}

Vec3f facing_normal(const ShadingInputs& inputs) {
    if (inputs.point == nullptr) return inputs.outgoing;
    return is_backfacing(inputs) ? -inputs.point->normal : inputs.point->normal;
}

Vec3f facing_facet_normal(const ShadingInputs& inputs) {
    if (inputs.point == nullptr) return inputs.outgoing;
    return is_backfacing(inputs) ? -inputs.point->facet_normal : inputs.point->facet_normal;
}

namespace {

/// In the world's program every coordinate is the direction of the ray.
Vec3d world_position(const ShadingInputs& inputs) {
    return inputs.point != nullptr ? inputs.point->position : Vec3d(-inputs.outgoing);
}

Vec3d object_position(const ShadingInputs& inputs) {
    const Vec3d position = world_position(inputs);
    const bool has_object = inputs.point != nullptr && inputs.instance != nullptr;
    return has_object ? inputs.world_to_object().point(position) : position;
}

}  // namespace

/// A normal is a covector: it goes to object space by the transpose of the map that takes points out of it.
Vec3f object_normal(const ShadingInputs& inputs) {
    const Vec3f normal = facing_normal(inputs);
    if (inputs.point == nullptr || inputs.instance == nullptr) return normal;
    const Affine3d map = inputs.object_to_world();
    const Vec3d world(normal);
    return Vec3f(normalized_or(Vec3d(map.x.dot(world), map.y.dot(world), map.z.dot(world)), world));
}

/// A patch's parameters; of a triangle the weights of its first two vertices, as Blender counts them.
Vec3f parametric(const ShadingInputs& inputs) {
    if (inputs.point == nullptr) return Vec3f(0.0f);
    const LocalHit& hit = inputs.point->local;
    const bool is_triangle = hit.subpatch == RayAnchor::kNone;
    return is_triangle ? Vec3f(1.0f - hit.u - hit.v, hit.u, 0.0f) : Vec3f(hit.u, hit.v, 0.0f);
}

Vec3f generated(const ShadingInputs& inputs) {
    Vec3d position = object_position(inputs);
    if (inputs.point == nullptr || inputs.point->shape == nullptr) return Vec3f(position);
    if (!inputs.point->inside)
        if (const std::optional<Vec4f> rest = inputs.point->shape->attribute(kRestPlace, inputs.point->local))
            position = Vec3d(rest->x, rest->y, rest->z) + (rest->w == 0.0f ? position : Vec3d(0.0));
    const Box3d& box = inputs.point->shape->texture_space();
    const Vec3d size = box.size();
    const auto share = [](double x, double low, double extent) { return extent > 0.0 ? (x - low) / extent : 0.5; };
    return Vec3f(Vec3d(share(position.x, box.min.x, size.x), share(position.y, box.min.y, size.y),
                       share(position.z, box.min.z, size.z)));
}

std::optional<Vec4f> grid_value(const ShadingInputs& inputs, int32_t id) {
    if (inputs.point == nullptr || !inputs.point->inside || inputs.point->shape == nullptr) return std::nullopt;
    const VolumeGrids* grids = inputs.point->shape->grids();
    const VoxelGrid* grid = grids != nullptr ? grids->find(id) : nullptr;
    if (grid == nullptr) return std::nullopt;
    for (const InstanceAttribute& each : inputs.assumed)
        if (each.id == id) return Vec4f(each.value[0], each.value[1], each.value[2], each.value[3]);
    return grid->at(object_position(inputs));
}

Vec4f attribute(const ShadingInputs& inputs, int32_t id) {
    const Vec4f missing(0.0f, 0.0f, 0.0f, 1.0f);
    if (inputs.point == nullptr || inputs.point->shape == nullptr) return missing;
    if (!inputs.point->inside)
        if (const std::optional<Vec4f> own = inputs.point->shape->attribute(id, inputs.point->local)) return *own;
    if (const std::optional<Vec4f> held = grid_value(inputs, id)) return *held;
    if (inputs.instance != nullptr)
        for (const InstanceAttribute& each : inputs.instance->attributes)
            if (each.id == id) return Vec4f(each.value[0], each.value[1], each.value[2], each.value[3]);
    return missing;
}

namespace {

Vec3f camera_coordinates(const ShadingInputs& inputs) {
    if (inputs.camera == nullptr) return Vec3f(world_position(inputs));
    const Affine3d& to_camera = inputs.camera->world_to_camera;
    const Vec3d position = world_position(inputs);
    const Vec3d p = inputs.point != nullptr ? to_camera.point(position) : to_camera.vector(position);
    return Vec3f(Vec3d(p.x, p.y, -p.z));
}

Vec3f window(const ShadingInputs& inputs) {
    if (inputs.camera == nullptr) return Vec3f(0.0f);
    const CameraInfo& camera = *inputs.camera;
    const Vec3d position = world_position(inputs);
    const Vec3d p =
        inputs.point != nullptr ? camera.world_to_camera.point(position) : camera.world_to_camera.vector(position);
    const double depth = camera.perspective ? -p.z : 1.0;
    if (depth == 0.0) return Vec3f(0.0f);
    const Vec2d on_picture = (Vec2d(p.x, p.y) / depth - camera.window_min) / camera.window_size;
    return {static_cast<float>(on_picture.x), static_cast<float>(on_picture.y), 0.0f};
}

Vec4f uv(const ShadingInputs& inputs, int32_t id) {
    if (id >= 0) {
        const Vec4f value = attribute(inputs, id);
        return Vec4f(value.x, value.y, 0.0f, 1.0f);
    }
    if (inputs.point == nullptr) return extended(Vec3f(0.0f));
    return Vec4f(inputs.point->uv.x, inputs.point->uv.y, 0.0f, 1.0f);
}

Vec3f reflection(const ShadingInputs& inputs) {
    if (inputs.point == nullptr) return -inputs.outgoing;
    const Vec3f normal = facing_normal(inputs);
    return normal * (2.0f * normal.dot(inputs.outgoing)) - inputs.outgoing;
}

float light_path(LightPathVariant variant, const PathState& path) {
    switch (variant) {
        case LightPathVariant::is_camera:
            return path.camera ? 1.0f : 0.0f;
        case LightPathVariant::is_shadow:
            return path.shadow ? 1.0f : 0.0f;
        case LightPathVariant::is_diffuse:
            return path.diffuse ? 1.0f : 0.0f;
        case LightPathVariant::is_glossy:
            return path.glossy ? 1.0f : 0.0f;
        case LightPathVariant::is_singular:
            return path.singular ? 1.0f : 0.0f;
        case LightPathVariant::is_reflection:
            return path.reflection ? 1.0f : 0.0f;
        case LightPathVariant::is_transmission:
            return path.transmission ? 1.0f : 0.0f;
        case LightPathVariant::is_volume:
            return path.volume ? 1.0f : 0.0f;
        case LightPathVariant::ray_length:
            return path.ray_length;
        case LightPathVariant::ray_depth:
            return static_cast<float>(path.depth);
        case LightPathVariant::diffuse_depth:
            return static_cast<float>(path.diffuse_depth);
        case LightPathVariant::glossy_depth:
            return static_cast<float>(path.glossy_depth);
        case LightPathVariant::transparent_depth:
            return static_cast<float>(path.transparent_depth);
        case LightPathVariant::transmission_depth:
            return static_cast<float>(path.transmission_depth);
        case LightPathVariant::portal_depth:
            return static_cast<float>(path.portal_depth);
    }
    return 0.0f;
}

/// Fresnel node: the index turns over where the surface is seen from inside.
float fresnel_node(const ShadingInputs& inputs, float ior, const Vec3f& normal) {
    constexpr float kLeastIndex = 1e-5f;  // as Cycles
    const float inside = std::max(ior, kLeastIndex);
    return dielectric_fresnel(normal.dot(inputs.outgoing), is_backfacing(inputs) ? 1.0f / inside : inside);
}

float layer_weight(LayerWeightVariant variant, const ShadingInputs& inputs, float amount, const Vec3f& normal) {
    const float cosine = normal.dot(inputs.outgoing);
    if (variant == LayerWeightVariant::FRESNEL) {
        constexpr float kLeast = 1e-5f;  // as Cycles
        const float eta = std::max(1.0f - amount, kLeast);
        return dielectric_fresnel(cosine, is_backfacing(inputs) ? eta : 1.0f / eta);
    }
    const float facing = std::abs(cosine);
    if (amount == 0.5f) return 1.0f - facing;
    constexpr float kMost = 1.0f - 1e-5f;  // as Cycles
    const float b = std::clamp(amount, 0.0f, kMost);
    return 1.0f - std::pow(facing, b < 0.5f ? 2.0f * b : 0.5f / (1.0f - b));
}

}  // namespace

Vec4f bump_value(const Operands& operands, bool inverted, const Heights& heights, const ShadingInputs& inputs,
                 Clearing clearing) {
    const Vec3f own = facing_normal(inputs);
    const Vec3f normal = operands.connected(3) ? normalized_or(operands.vector(3), own) : own;
    if (inputs.point == nullptr) return extended(normal);
    const float distance = operands.scalar(2) * (inverted ? -1.0f : 1.0f);
    const Vec3f bent =
        bump_normal(normal, inputs.differential,
                    {heights.here * distance, heights.right * distance, heights.above * distance}, operands.scalar(1));
    return extended(clearing == Clearing::All ? clearing_normal(facing_facet_normal(inputs), inputs.outgoing, bent)
                                              : bent);
}

Vec4f input_value(Operation operation, uint8_t variant, const Operands& operands, std::span<const int32_t> ints,
                  const ShadingInputs& inputs) {
    const auto normal_operand = [&](uint32_t i) {
        const Vec3f own = facing_normal(inputs);
        return operands.connected(i) ? normalized_or(operands.vector(i), own) : own;
    };
    switch (operation) {
        case Operation::position:
            return extended(Vec3f(world_position(inputs)));
        case Operation::normal:
            return extended(facing_normal(inputs));
        case Operation::object_normal:
            return extended(object_normal(inputs));
        case Operation::true_normal:
            return extended(facing_facet_normal(inputs));
        case Operation::tangent:
            return extended(tangent(inputs, ints));
        case Operation::radial_tangent:
            return extended(radial_tangent(inputs, ints[0]));
        case Operation::transform:
            return extended(transform(static_cast<TransformVariant>(variant), inputs, ints, operands.vector(0)));
        case Operation::wireframe:
            return spread(wireframe(inputs, operands.scalar(0), !ints.empty() && ints[0] != 0));
        case Operation::from_tangent_space:
            return extended(from_tangent_space(inputs, operands.vector(0)));
        case Operation::incoming:
            return extended(inputs.outgoing);
        case Operation::parametric:
            return extended(parametric(inputs));
        case Operation::backfacing:
            return spread(is_backfacing(inputs) ? 1.0f : 0.0f);
        case Operation::generated:
            return extended(generated(inputs));
        case Operation::object_coordinates:
            return extended(Vec3f(object_position(inputs)));
        case Operation::camera_coordinates:
            return extended(camera_coordinates(inputs));
        case Operation::window:
            return extended(window(inputs));
        case Operation::reflection:
            return extended(reflection(inputs));
        case Operation::uv:
            return uv(inputs, ints.empty() ? -1 : ints[0]);
        case Operation::attribute:
            return attribute(inputs, ints[0]);
        case Operation::grid_value:
            return grid_value(inputs, ints[0]).value_or(operands.connected(0) ? operands.value(0) : spread(0.0f));
        case Operation::object_location:
            return extended(inputs.instance != nullptr ? Vec3f(inputs.object_to_world().translation) : Vec3f(0.0f));
        case Operation::object_index:
            return spread(inputs.instance != nullptr ? inputs.instance->object_index : 0.0f);
        case Operation::material_index:
            return spread(inputs.material_index);
        case Operation::object_random:
            return spread(inputs.instance != nullptr ? inputs.instance->random : 0.0f);
        case Operation::light_path:
            return spread(light_path(static_cast<LightPathVariant>(variant), inputs.path));
        case Operation::fresnel:
            return spread(fresnel_node(inputs, operands.scalar(0), normal_operand(1)));
        case Operation::layer_weight:
            return spread(
                layer_weight(static_cast<LayerWeightVariant>(variant), inputs, operands.scalar(0), normal_operand(1)));
        case Operation::normal_map:
            return extended(normal_map(static_cast<NormalMapVariant>(variant), inputs, ints, operands.scalar(0),
                                       operands.vector(1)));
        default:
            return spread(0.0f);
    }
}

}  // namespace rayleaf
