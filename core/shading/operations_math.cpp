#include "shading/operations_math.h"

#include <cfloat>

namespace rayleaf {
namespace {

float safe_divide(float a, float b) {
    return b != 0.0f ? a / b : 0.0f;
}
float safe_modulo(float a, float b) {
    return b != 0.0f ? std::fmod(a, b) : 0.0f;
}
float floored_modulo(float a, float b) {
    return b != 0.0f ? a - std::floor(a / b) * b : 0.0f;
}
/// A negative base has real powers for whole exponents only.
float safe_power(float a, float b) {
    if (a < 0.0f && b != std::trunc(b)) return 0.0f;
    return std::pow(a, b);
}
float safe_logarithm(float a, float base) {
    if (a <= 0.0f || base <= 0.0f) return 0.0f;
    return safe_divide(std::log(a), std::log(base));
}
float wrapped(float value, float high, float low) {
    const float range = high - low;
    return range != 0.0f ? value - range * std::floor((value - low) / range) : low;
}
float ping_pong(float a, float b) {
    if (b == 0.0f) return 0.0f;
    const float phase = (a - b) / (b * 2.0f);
    return std::abs((phase - std::floor(phase)) * b * 2.0f - b);
}
/// Minimum whose edge is rounded over `distance` by a cubic.
float smooth_minimum(float a, float b, float distance) {
    if (distance == 0.0f) return std::min(a, b);
    const float h = std::max(distance - std::abs(a - b), 0.0f) / distance;
    return std::min(a, b) - h * h * h * distance / 6.0f;
}
float sign(float x) {
    return x == 0.0f ? 0.0f : std::copysign(1.0f, x);
}

template <typename Function>
Vec3f each(const Vec3f& a, Function function) {
    return {function(a.x), function(a.y), function(a.z)};
}
template <typename Function>
Vec3f each(const Vec3f& a, const Vec3f& b, Function function) {
    return {function(a.x, b.x), function(a.y, b.y), function(a.z, b.z)};
}

Vec3f reflect(const Vec3f& incident, const Vec3f& normal) {
    const Vec3f unit = normalized_or(normal, Vec3f(0.0f));
    return incident - unit * (2.0f * unit.dot(incident));
}
Vec3f refract(const Vec3f& incident, const Vec3f& normal, float eta) {
    const Vec3f unit = normalized_or(normal, Vec3f(0.0f));
    const float cosine = unit.dot(incident);
    const float k = 1.0f - eta * eta * (1.0f - cosine * cosine);
    return k < 0.0f ? Vec3f(0.0f) : incident * eta - unit * (eta * cosine + std::sqrt(k));
}
Vec3f project(const Vec3f& v, const Vec3f& onto) {
    const float length2 = onto.length2();
    return length2 != 0.0f ? onto * (v.dot(onto) / length2) : Vec3f(0.0f);
}

}  // namespace

float math_value(MathVariant variant, float a, float b, float c) {
    switch (variant) {
        case MathVariant::ADD:
            return a + b;
        case MathVariant::SUBTRACT:
            return a - b;
        case MathVariant::MULTIPLY:
            return a * b;
        case MathVariant::DIVIDE:
            return safe_divide(a, b);
        case MathVariant::MULTIPLY_ADD:
            return a * b + c;
        case MathVariant::POWER:
            return safe_power(a, b);
        case MathVariant::LOGARITHM:
            return safe_logarithm(a, b);
        case MathVariant::SQRT:
            return std::sqrt(std::max(a, 0.0f));
        case MathVariant::INVERSE_SQRT:
            return a > 0.0f ? 1.0f / std::sqrt(a) : 0.0f;
        case MathVariant::ABSOLUTE:
            return std::abs(a);
        case MathVariant::EXPONENT:
            return std::exp(a);
        case MathVariant::MINIMUM:
            return std::fmin(a, b);
        case MathVariant::MAXIMUM:
            return std::fmax(a, b);
        case MathVariant::LESS_THAN:
            return a < b ? 1.0f : 0.0f;
        case MathVariant::GREATER_THAN:
            return a > b ? 1.0f : 0.0f;
        case MathVariant::SIGN:
            return sign(a);
        case MathVariant::COMPARE:
            return a == b || std::abs(a - b) <= std::max(c, FLT_EPSILON) ? 1.0f : 0.0f;
        case MathVariant::SMOOTH_MIN:
            return smooth_minimum(a, b, c);
        case MathVariant::SMOOTH_MAX:
            return -smooth_minimum(-a, -b, c);
        case MathVariant::ROUND:
            return std::floor(a + 0.5f);
        case MathVariant::FLOOR:
            return std::floor(a);
        case MathVariant::CEIL:
            return std::ceil(a);
        case MathVariant::TRUNC:
            return std::trunc(a);
        case MathVariant::FRACT:
            return a - std::floor(a);
        case MathVariant::MODULO:
            return safe_modulo(a, b);
        case MathVariant::FLOORED_MODULO:
            return floored_modulo(a, b);
        case MathVariant::WRAP:
            return wrapped(a, b, c);
        case MathVariant::SNAP:
            return std::floor(safe_divide(a, b)) * b;
        case MathVariant::PINGPONG:
            return ping_pong(a, b);
        case MathVariant::SINE:
            return std::sin(a);
        case MathVariant::COSINE:
            return std::cos(a);
        case MathVariant::TANGENT:
            return std::tan(a);
        case MathVariant::ARCSINE:
            return std::asin(std::clamp(a, -1.0f, 1.0f));
        case MathVariant::ARCCOSINE:
            return std::acos(std::clamp(a, -1.0f, 1.0f));
        case MathVariant::ARCTANGENT:
            return std::atan(a);
        case MathVariant::ARCTAN2:
            return std::atan2(a, b);
        case MathVariant::SINH:
            return std::sinh(a);
        case MathVariant::COSH:
            return std::cosh(a);
        case MathVariant::TANH:
            return std::tanh(a);
        case MathVariant::RADIANS:
            return a * (kPi / 180.0f);
        case MathVariant::DEGREES:
            return a * (180.0f / kPi);
    }
    return 0.0f;
}

Vec4f vector_math_value(VectorMathVariant variant, const Vec3f& a, const Vec3f& b, const Vec3f& c, float scale) {
    using enum VectorMathVariant;
    switch (variant) {
        case ADD:
            return extended(a + b);
        case SUBTRACT:
            return extended(a - b);
        case MULTIPLY:
            return extended(a * b);
        case DIVIDE:
            return extended(each(a, b, safe_divide));
        case MULTIPLY_ADD:
            return extended(a * b + c);
        case CROSS_PRODUCT:
            return extended(a.cross(b));
        case PROJECT:
            return extended(project(a, b));
        case REFLECT:
            return extended(reflect(a, b));
        case REFRACT:
            return extended(refract(a, b, scale));
        case FACEFORWARD:
            return extended(c.dot(b) < 0.0f ? a : -a);
        case DOT_PRODUCT:
            return spread(a.dot(b));
        case DISTANCE:
            return spread((a - b).length());
        case LENGTH:
            return spread(a.length());
        case SCALE:
            return extended(a * scale);
        case NORMALIZE:
            return extended(normalized_or(a, Vec3f(0.0f)));
        case ABSOLUTE:
            return extended(each(a, [](float x) { return std::abs(x); }));
        case MINIMUM:
            return extended(each(a, b, [](float x, float y) { return std::fmin(x, y); }));
        case MAXIMUM:
            return extended(each(a, b, [](float x, float y) { return std::fmax(x, y); }));
        case FLOOR:
            return extended(each(a, [](float x) { return std::floor(x); }));
        case CEIL:
            return extended(each(a, [](float x) { return std::ceil(x); }));
        case FRACTION:
            return extended(each(a, [](float x) { return x - std::floor(x); }));
        case MODULO:
            return extended(each(a, b, safe_modulo));
        case WRAP:
            return extended({wrapped(a.x, b.x, c.x), wrapped(a.y, b.y, c.y), wrapped(a.z, b.z, c.z)});
        case SNAP:
            return extended(each(a, b, [](float x, float y) { return std::floor(safe_divide(x, y)) * y; }));
        case SINE:
            return extended(each(a, [](float x) { return std::sin(x); }));
        case COSINE:
            return extended(each(a, [](float x) { return std::cos(x); }));
        case TANGENT:
            return extended(each(a, [](float x) { return std::tan(x); }));
        case POWER:
            return extended(each(a, b, safe_power));
        case SIGN:
            return extended(each(a, sign));
        case ROUND:
            return extended(each(a, [](float x) { return std::floor(x + 0.5f); }));
    }
    return spread(0.0f);
}

float clamp_value(ClampVariant variant, float value, float low, float high) {
    if (variant == ClampVariant::RANGE && low > high) std::swap(low, high);
    return std::min(std::max(value, low), high);
}

float map_range_value(MapRangeVariant variant, const Operands& operands, bool clamped) {
    const float value = operands.scalar(0), from_low = operands.scalar(1), from_high = operands.scalar(2);
    const float to_low = operands.scalar(3), to_high = operands.scalar(4);
    if (from_high == from_low) return 0.0f;
    float share = (value - from_low) / (from_high - from_low);
    switch (variant) {
        case MapRangeVariant::LINEAR:
            break;
        case MapRangeVariant::STEPPED: {
            const float steps = operands.scalar(5, 4.0f);
            share = steps > 0.0f ? std::floor(share * (steps + 1.0f)) / steps : 0.0f;
            break;
        }
        case MapRangeVariant::SMOOTHSTEP:
            share = saturate(share);
            share = (3.0f - 2.0f * share) * share * share;
            break;
        case MapRangeVariant::SMOOTHERSTEP:
            share = saturate(share);
            share = share * share * share * (share * (share * 6.0f - 15.0f) + 10.0f);
            break;
    }
    const float result = to_low + share * (to_high - to_low);
    const bool limits = clamped && (variant == MapRangeVariant::LINEAR || variant == MapRangeVariant::STEPPED);
    return limits ? clamp_value(ClampVariant::RANGE, result, to_low, to_high) : result;
}

EulerRotation::EulerRotation(const Vec3f& euler) {
    // Most are not turned.
    const auto cosine = [](float angle) { return angle == 0.0f ? 1.0f : std::cos(angle); };
    const auto sine = [](float angle) { return angle == 0.0f ? angle : std::sin(angle); };
    const float cx = cosine(euler.x), cy = cosine(euler.y), cz = cosine(euler.z);
    const float sx = sine(euler.x), sy = sine(euler.y), sz = sine(euler.z);
    x = Vec3f(cy * cz, cy * sz, -sy);
    y = Vec3f(sy * sx * cz - cx * sz, sy * sx * sz + cx * cz, cy * sx);
    z = Vec3f(sy * cx * cz + sx * sz, sy * cx * sz - sx * cz, cy * cx);
}

Vec3f Mapping::of(const Vec3f& vector) const {
    switch (variant) {
        case MappingVariant::POINT:
            return rotation.apply(vector * scale) + location;
        case MappingVariant::TEXTURE:
            return each(rotation.apply_inverse(vector - location), scale, safe_divide);
        case MappingVariant::VECTOR:
            return rotation.apply(vector * scale);
        case MappingVariant::NORMAL:
            return normalized_or(rotation.apply(each(vector, scale, safe_divide)), Vec3f(0.0f));
    }
    return Vec3f(0.0f);
}

Vec3f rotated(const Vec3f& v, const Vec3f& axis, float angle) {
    if (angle == 0.0f) return v;
    const float c = std::cos(angle), s = std::sin(angle);
    return v * c + axis.cross(v) * s + axis * (axis.dot(v) * (1.0f - c));
}

Vec3f vector_rotate_value(VectorRotateVariant variant, const Operands& operands, bool inverted) {
    const Vec3f vector = operands.vector(0), center = operands.vector(1), from_center = vector - center;
    if (variant == VectorRotateVariant::EULER_XYZ) {
        const EulerRotation rotate(operands.vector(4));
        return (inverted ? rotate.apply_inverse(from_center) : rotate.apply(from_center)) + center;
    }
    Vec3f axis(0.0f);
    if (variant == VectorRotateVariant::AXIS_ANGLE)
        axis = normalized_or(operands.vector(2), Vec3f(0.0f));
    else
        axis[static_cast<int>(variant) - static_cast<int>(VectorRotateVariant::X_AXIS)] = 1.0f;
    if (axis == Vec3f(0.0f)) return vector;
    const float angle = operands.scalar(3);
    return rotated(from_center, axis, inverted ? -angle : angle) + center;
}

}  // namespace rayleaf
