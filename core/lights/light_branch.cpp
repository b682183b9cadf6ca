#include "lights/light_branch.h"

namespace rayleaf {
namespace {

constexpr float kNearestSquared = 1e-30f;  ///< squared distance, world units²; keeps weights finite
constexpr float kLeastWeight = 1e-37f;     ///< of what shines

/// The offset of four numbers from one, as floats.
Float4 from(double origin, const std::array<double, LightBranch::kMost>& to) {
    using Doubles = double __attribute__((vector_size(32)));
    return __builtin_convertvector(Doubles{to[0], to[1], to[2], to[3]} - origin, Float4);
}

/// A right triangle with this hypotenuse, by one of its sides: the other.
Float4 other_side(Float4 hypotenuse_squared, Float4 side) {
    return sqrt4(max4(Float4{}, hypotenuse_squared - side * side));
}

/// As `narrowed` (lights/cosines.h): of the cosine and the cone's cosine and sine times a length; the result is times
/// its square.
Float4 narrowed(Float4 length_squared, Float4 cosine, Float4 by_cosine, Float4 by_sine) {
    const Float4 less = cosine * by_cosine + other_side(length_squared, cosine) * by_sine;
    return cosine >= by_cosine ? length_squared : less;
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

LightBranch::Ways LightBranch::ways(const Vec3d& position) const {
    const Float4 to_x = from(position.x, x), to_y = from(position.y, y), to_z = from(position.z, z);
    return {to_x, to_y, to_z, to_x * to_x + to_y * to_y + to_z * to_z};
}

Float4 LightBranch::weights(const LitPoint& at, Float4 shining, Float4 sides) const {
    const Vec3f& n = at.normal;
    const float least_at_point = n == Vec3f(0.0f) ? 1.0f : kLeastCosine;  // the zero normal stands for all directions
    // Sines and cosines are times the distance, and what is made of two of them times its square: so one division is
    // all it takes.
    const Ways to = ways(at.position);
    const Float4 sine = radius, cosine = other_side(to.squared, radius);  // of the half angle under which it is seen
    const Float4 by_normal = to.x * n.x + to.y * n.y + to.z * n.z;
    const Float4 at_point = max4(least_at_point * to.squared, narrowed(to.squared, by_normal, cosine, sine));
    // With the angle between the axis and the lights' normals.
    const Float4 sum_sine = sine * spread_cosine + cosine * spread_sine;
    const Float4 sum_cosine = cosine * spread_cosine - sine * spread_sine;
    const Float4 from_axis = -(to.x * axis_x + to.y * axis_y + to.z * axis_z);
    const Float4 by_axis = sides == 0.0f ? max4(from_axis, -from_axis) : from_axis * sides;
    const Float4 by_light = narrowed(to.squared, by_axis, sum_cosine, sum_sine);
    const Float4 at_light = sum_sine < 0.0f ? to.squared : max4(kLeastCosine * to.squared, by_light);
    // Inside a node the distance says nothing; half its radius is as good a guess as any.
    const Float4 radius_squared = radius * radius;
    const Float4 falloff = 1.0f / max4(max4(to.squared, 0.25f * radius_squared), all4(kNearestSquared));
    const Float4 cosines = to.squared > radius_squared ? (at_point * falloff) * (at_light * falloff) : all4(1.0f);
    const Float4 weight = max4(all4(kLeastWeight), shining * cosines * falloff);
    return shining > 0.0f ? weight : Float4{};
}

uint32_t LightBranch::around(const Vec3d& position) const {
    return at_most(ways(position).squared - radius * radius, 0.0f);
}

}  // namespace rayleaf
