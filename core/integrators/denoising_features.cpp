#include "integrators/denoising_features.h"

#include <algorithm>

namespace rayleaf {
namespace {

/// Lobes up to this roughness (its square, as lobes have it) show what lies beyond, as in Cycles.
constexpr float kMostClearAlpha = 0.075f;
/// A surface is rough where this part of its lobes' weight is.
constexpr float kRoughShare = 0.25f;

bool is_clear(const Lobe& lobe) {
    switch (lobe.type) {
        case LobeType::Reflection:
        case LobeType::Refraction:
        case LobeType::Glass:
        case LobeType::Sheet:
        case LobeType::Clearcoat:
            return lobe.alpha_x * lobe.alpha_y <= kMostClearAlpha * kMostClearAlpha;
        default:
            return false;
    }
}

/// The lobes of a surface in two parts.
struct Parts {
    Closures clear, rough;
    float clear_weight = 0, rough_weight = 0;
    Vec3f normal{0, 0, 0};  ///< of all lobes by their weights, not unit
};

Parts parts_of(const Closures& closures) {
    Parts parts;
    parts.clear_weight = std::max(average(closures.unscattered()), 0.0f);
    for (int i = 0; i < closures.size(); ++i) {
        const Lobe& lobe = closures[i];
        const float weight = average(lobe.weight);
        const bool clear = is_clear(lobe);
        (clear ? parts.clear : parts.rough).add(lobe);
        (clear ? parts.clear_weight : parts.rough_weight) += weight;
        parts.normal += lobe.normal * weight;
    }
    return parts;
}

Color albedo_of(const Closures& closures, const Vec3f& outgoing) {
    Color albedo(0.0f);
    for (const LobeKind kind : kLobeKinds) albedo += closures.albedo(outgoing, kind);
    return albedo;
}

Color up_to_one(const Color& c) {
    return {std::clamp(c.x, 0.0f, 1.0f), std::clamp(c.y, 0.0f, 1.0f), std::clamp(c.z, 0.0f, 1.0f)};
}

}  // namespace

void DenoisingFeatures::meet(const Scene& scene, const Vertex& vertex, double length, PixelSample& sample) {
    if (is_done_) return;
    const Closures& closures = vertex.closures;
    sample[Pass::denoising_depth].x += share_ * average(passed_) * static_cast<float>(length);
    if (!is_black(closures.emission)) {
        meet_light(closures.emission, sample);
        is_done_ = closures.size() == 0 && is_black(closures.unscattered());
    }
    const Parts parts = parts_of(closures);
    if (parts.rough_weight <= kRoughShare * (parts.rough_weight + parts.clear_weight)) {
        passed_ *= up_to_one(albedo_of(parts.clear, vertex.outgoing) + closures.unscattered());
        return;
    }
    const Vec3d normal(normalized_or(parts.normal, vertex.point.normal));
    end(Vec3f(scene.camera().info().world_to_camera.vector(normal)), sample);
    const Color albedo = passed_ * albedo_of(parts.rough, vertex.outgoing) * share_;
    if (is_finite(albedo)) sample.add(Pass::denoising_albedo, albedo);
}

void DenoisingFeatures::meet_medium(const Color& albedo, PixelSample& sample) {
    if (is_done_) return;
    meet_light(albedo, sample);
    end(Vec3f(0, 0, 1), sample);
}

/// The normal is in camera space; in Cycles' the z axis points forward.
void DenoisingFeatures::end(const Vec3f& normal, PixelSample& sample) {
    is_done_ = true;
    sample[Pass::denoising_normal] += Vec4f(normal.x, normal.y, -normal.z, 0.0f) * share_;
}

void DenoisingFeatures::meet_light(const Color& radiance, PixelSample& sample) {
    if (!is_done_ && is_finite(radiance)) sample.add(Pass::denoising_albedo, passed_ * up_to_one(radiance) * share_);
}

}  // namespace rayleaf
