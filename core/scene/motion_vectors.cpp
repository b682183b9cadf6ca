#include "scene/motion_vectors.h"

#include <algorithm>

namespace rayleaf {

bool wants_vectors(const Settings& settings) {
    return std::find(settings.passes.begin(), settings.passes.end(), Pass::vector) != settings.passes.end();
}

MotionVectors::MotionVectors(const SceneDescription& description, const Settings& settings)
    : camera_(*description.camera(), settings.width, settings.height) {
    instances_.reserve(description.instances.size());
    for (const InstanceDescription& instance : description.instances) {
        const std::shared_ptr<const Shape>& shape = description.shapes[static_cast<size_t>(instance.shape)];
        instances_.push_back({instance.motion, shape->deforms() ? shape : nullptr, instance.object_to_world});
    }
}

/// Where a surface point is at a time, in the world.
Vec3d MotionVectors::place(const SurfacePoint& point, float time) const {
    const Moving& instance = instances_[point.instance];
    if (!instance.motion && !instance.shape) return point.position;
    const Affine3d now = instance.motion ? instance.motion->at(kMiddleTime) : instance.object_to_world;
    const Affine3d then = instance.motion ? instance.motion->at(time) : now;
    if (!instance.shape || point.inside) return then.point(now.inverse().point(point.position));
    const LocalFrame& frame = instance.shape->frame();
    const uint32_t element = instance.shape->element_of(point.local);
    const Vec2f parameters(point.local.u, point.local.v);
    const auto in_object = [&](float at) {
        return frame.to_object().point(Vec3d(instance.shape->element_point_at(element, parameters, at).hit.position));
    };
    return then.point(now.inverse().point(point.position) + in_object(time) - in_object(kMiddleTime));
}

Vec4f MotionVectors::at(const SurfacePoint& point) const {
    const auto seen_at = [&](float time) { return camera_.seen_at(place(point, time), time); };
    const Vec2d now = seen_at(kMiddleTime), from = seen_at(0.0f) - now, to = now - seen_at(1.0f);
    const auto pixels = [](double number) { return finite_or_zero(static_cast<float>(number)); };
    return {pixels(from.x), pixels(from.y), pixels(to.x), pixels(to.y)};
}

}  // namespace rayleaf
