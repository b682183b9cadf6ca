#include "scene/motion_vectors.h"

#include <algorithm>

namespace rayleaf {

bool wants_vectors(const Settings& settings) {
    return std::find(settings.passes.begin(), settings.passes.end(), Pass::vector) != settings.passes.end();
}

MotionVectors::MotionVectors(const SceneDescription& description, const Settings& settings)
    : camera_(*description.camera(), settings.width, settings.height) {
    motions_.reserve(description.instances.size());
    for (const InstanceDescription& instance : description.instances) motions_.push_back(instance.motion);
}

Vec4f MotionVectors::at(const SurfacePoint& point) const {
    const Motion* motion = motions_[point.instance].get();
    const auto seen_at = [&](float time) {
        if (!motion) return camera_.seen_at(point.position, time);
        const Vec3d in_object = motion->at(kMiddleTime).inverse().point(point.position);
        return camera_.seen_at(motion->at(time).point(in_object), time);
    };
    const Vec2d now = seen_at(kMiddleTime), from = seen_at(0.0f) - now, to = now - seen_at(1.0f);
    const auto pixels = [](double number) { return finite_or_zero(static_cast<float>(number)); };
    return {pixels(from.x), pixels(from.y), pixels(to.x), pixels(to.y)};
}

}  // namespace rayleaf
