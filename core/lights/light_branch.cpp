#include "lights/light_branch.h"

namespace rayleaf {
namespace {

constexpr float kNearestSquared = 1e-30f;  ///< squared distance, world units²; keeps weights finite
/// Of the cosines at the point, which are means over a node and so less than at best.
constexpr float kLeastMeanCosine = 0.02f;
constexpr float kLeastWeight = 1e-37f;  ///< of what shines

/// The offset of four numbers from one, as floats.
Float4 from(double origin, const std::array<double, LightBranch::kMost>& to) {
    using Doubles = double __attribute__((vector_size(32)));
    return __builtin_convertvector(Doubles{to[0], to[1], to[2], to[3]} - origin, Float4);
}

/// The mean height above a plane of a sphere's points, evenly spread over heights; those below it count as 0.
Float4 mean_height(Float4 of_middle, Float4 radius) {
    const Float4 most = of_middle + radius;
    const Float4 of_part = most > 0.0f ? most * most / (4.0f * radius) : Float4{};
    return of_middle >= radius ? of_middle : of_part;
}

}  // namespace

void LightBranch::set_cone(size_t lane, const LightCone& cone) {
    if (cone.axis == Vec3f(0.0f)) {  // as wide as can be: no direction is outside of it
        no_axis[lane] = 1.0f;
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

LightBranch::Ways LightBranch::ways(const Vec3d& position) const {
    const Float4 to_x = from(position.x, x), to_y = from(position.y, y), to_z = from(position.z, z);
    return {to_x, to_y, to_z, to_x * to_x + to_y * to_y + to_z * to_z};
}

LightBranch::Weights LightBranch::weights(const LitPoint& at, Float4 shining, Float4 sides) const {
    const Vec3f& n = at.normal;
    const float least_at_point =
        n == Vec3f(0.0f) ? 1.0f : kLeastMeanCosine;  // the zero normal stands for all directions
    // Cosines are times the distance, and what is made of two of them times its square: so one division is all it
    // takes.
    const Ways to = ways(at.position);
    const Float4 distance = sqrt4(to.squared);
    const Float4 by_normal = mean_height(to.x * n.x + to.y * n.y + to.z * n.z, radius);
    const Float4 at_point = max4(least_at_point * to.squared, distance * by_normal);
    // The lights' normals lie about the axis, and the nearer all directions are among them, the less it tells.
    const Float4 from_axis = -(to.x * axis_x + to.y * axis_y + to.z * axis_z) * min4(all4(1.0f), 1.0f + spread_cosine);
    const Float4 around = distance * (spread_cosine < 0.0f ? all4(1.0f) : spread_sine) + radius;
    const Float4 ahead = mean_height(from_axis, around), behind = mean_height(-from_axis, around);
    const Float4 by_light = sides == 0.0f ? ahead + behind : sides > 0.0f ? ahead : behind;
    const Float4 at_light = no_axis > 0.0f ? to.squared : max4(kLeastCosine * to.squared, distance * by_light);
    // Inside a node the distance says nothing; half its radius is as good a guess as any.
    const Float4 radius_squared = radius * radius;
    const Float4 falloff = 1.0f / max4(max4(to.squared, 0.25f * radius_squared), all4(kNearestSquared));
    const Float4 cosines = to.squared > radius_squared ? (at_point * falloff) * (at_light * falloff) : all4(1.0f);
    const Float4 weight = max4(all4(kLeastWeight), shining * cosines * falloff);
    return {shining > 0.0f ? weight : Float4{}, shining > 0.0f && to.squared > radius_squared ? cosines : Float4{}};
}

Float4 LightBranch::Weights::evened() const {
    constexpr float kEvenShare = 0.25f;
    const float sum = sum_of(cosines);
    return sum > 0.0f ? numbers * (1.0f - kEvenShare) + cosines * (kEvenShare * sum_of(numbers) / sum) : numbers;
}

uint32_t LightBranch::around(const Vec3d& position) const {
    return at_most(ways(position).squared - radius * radius, 0.0f);
}

}  // namespace rayleaf
