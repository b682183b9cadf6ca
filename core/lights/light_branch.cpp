#include "lights/light_branch.h"

namespace rayleaf {
namespace {

constexpr float kNearestSquared = 1e-30f;  ///< squared distance, world units²; keeps weights finite
constexpr float kLeastWeight = 1e-37f;     ///< of what shines

/// As `narrowed` (lights/cosines.h), without a branch.
inline float narrowed_lane(float cosine, float by_cosine, float by_sine) {
    const float less = cosine * by_cosine + std::sqrt(std::max(0.0f, 1.0f - cosine * cosine)) * by_sine;
    return cosine >= by_cosine ? 1.0f : less;
}

}  // namespace

void LightBranch::set_cone(size_t lane, const LightCone& cone) {
    if (cone.axis == Vec3f(0.0f)) {  // as wide as can be: no direction is outside of it
        spread_cosine[lane] = -1.0f;
        return;
    }
    axis_x[lane] = cone.axis.x;
    axis_y[lane] = cone.axis.y;
    axis_z[lane] = cone.axis.z;
    const HalfAngle spread = HalfAngle::of_cosine(std::clamp(cone.cosine, -1.0f, 1.0f));
    spread_cosine[lane] = spread.cosine;
    spread_sine[lane] = spread.sine;
    if (!cone.ahead || !cone.back) side[lane] = cone.ahead ? 1.0f : -1.0f;
}

LightBranch::Lanes LightBranch::weights(const LitPoint& at, const Lanes& shining, const Lanes& sides) const {
    const Vec3d& p = at.position;
    const Vec3f& n = at.normal;
    const float least_at_point = n == Vec3f(0.0f) ? 1.0f : kLeastCosine;  // the zero normal stands for all directions
    Lanes result;
    // The same steps in each lane, which compilers make vectors of.
    for (size_t i = 0; i < kMost; ++i) {
        const auto to_x = static_cast<float>(x[i] - p.x), to_y = static_cast<float>(y[i] - p.y),
                   to_z = static_cast<float>(z[i] - p.z);
        const float distance_squared = to_x * to_x + to_y * to_y + to_z * to_z;
        const float radius_squared = radius[i] * radius[i];
        const float inverse = 1.0f / std::sqrt(distance_squared);
        // The half angle under which the sphere is seen.
        const float sine = std::min(radius[i] * inverse, 1.0f), cosine = std::sqrt(std::max(0.0f, 1.0f - sine * sine));
        const float by_normal = (to_x * n.x + to_y * n.y + to_z * n.z) * inverse;
        const float at_point = std::max(least_at_point, narrowed_lane(by_normal, cosine, sine));
        // With the angle between the axis and the lights' normals.
        const float sum_sine = sine * spread_cosine[i] + cosine * spread_sine[i];
        const float sum_cosine = cosine * spread_cosine[i] - sine * spread_sine[i];
        const float from_axis = -(to_x * axis_x[i] + to_y * axis_y[i] + to_z * axis_z[i]) * inverse;
        const float by_axis = sides[i] == 0.0f ? std::abs(from_axis) : from_axis * sides[i];
        const float narrowed = narrowed_lane(by_axis, sum_cosine, sum_sine);
        const float at_light = std::max(kLeastCosine, sum_sine < 0.0f ? 1.0f : narrowed);
        // Inside a node the distance says nothing; half its radius is as good a guess as any.
        const float cosines = distance_squared > radius_squared ? at_point * at_light : 1.0f;
        const float falloff = 1.0f / std::max(std::max(distance_squared, 0.25f * radius_squared), kNearestSquared);
        const float weight = std::max(kLeastWeight, shining[i] * cosines * falloff);
        result[i] = shining[i] > 0.0f ? weight : 0.0f;
    }
    return result;
}

}  // namespace rayleaf
