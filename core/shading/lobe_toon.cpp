#include "shading/lobe_toon.h"

#include "base/circle.h"

namespace rayleaf {
namespace {

/// The cone around its axis: the normal, or the mirror direction.
struct Cone {
    Vec3f axis;
    float full;   ///< angle within which the lobe is whole, radians
    float soft;   ///< over which it falls to nothing beyond that
    float width;  ///< of the cone in all, at most a quarter turn

    Cone(const Lobe& lobe, const Vec3f& outgoing) {
        constexpr float kLeastSize = 1e-5f;
        axis = lobe.type == LobeType::ToonGlossy ? lobe.normal * (2.0f * lobe.normal.dot(outgoing)) - outgoing
                                                 : lobe.normal;
        full = std::max(lobe.roughness, kLeastSize) * 0.5f * kPi;
        soft = lobe.softness * 0.5f * kPi;
        width = std::min(full + soft, 0.5f * kPi);
    }
    float density() const { return 0.5f / (kPi * (1.0f - std::cos(width))); }
    float share_at(float angle) const {
        if (angle < full) return 1.0f;
        return soft > 0.0f && angle < full + soft ? 1.0f - (angle - full) / soft : 0.0f;
    }
};

/// Highlights are not where the normal is bent away from the viewer.
bool is_seen(const Lobe& lobe, const Vec3f& outgoing) {
    return lobe.type == LobeType::ToonDiffuse || lobe.normal.dot(outgoing) > 0.0f;
}

}  // namespace

LobeValue evaluate_toon_lobe(const Lobe& lobe, const Vec3f& outgoing, const Vec3f& incoming, Side side) {
    if (side == Side::Transmitted || !(lobe.normal.dot(incoming) > 0.0f) || !is_seen(lobe, outgoing)) return {};
    const Cone cone(lobe, outgoing);
    const float angle = std::acos(std::clamp(cone.axis.dot(incoming), 0.0f, 1.0f));
    if (angle > cone.width || (lobe.in_front && !(angle < 0.5f * kPi))) return {};
    const float density = cone.density();
    return {lobe.weight * (density * cone.share_at(angle)), density};
}

std::optional<LobeDirection> sample_toon_lobe(const Lobe& lobe, const Vec3f& outgoing, const Vec3f& random) {
    if (!is_seen(lobe, outgoing)) return std::nullopt;
    const Cone cone(lobe, outgoing);
    const float cosine = 1.0f - random.x * (1.0f - std::cos(cone.width));
    const float sine = std::sqrt(std::max(1.0f - cosine * cosine, 0.0f));
    Vec3f across, up;
    const Vec3f axis = normalized_or(cone.axis, lobe.normal);
    orthonormal_basis(axis, across, up);
    const Vec2f at = on_circle(random.y) * sine;
    const Vec3f direction = across * at.x + up * at.y + axis * cosine;
    if (!(lobe.normal.dot(direction) > 0.0f)) return std::nullopt;
    return LobeDirection{direction};
}

}  // namespace rayleaf
