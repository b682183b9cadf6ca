#include "scene/material_optics.h"

namespace rayleaf {
namespace {

enum class SeenFrom : uint8_t { Outside, Inside };

/// The closures of a program that reads nothing of where it is, on a surface that is seen straight on. The normal is
/// along no axis, so that a program that sets its own normal is recognized.
const Vec3f kSomeNormal(0.36f, 0.48f, 0.8f);

Closures closures_of(const Program& program, SeenFrom side) {
    SurfacePoint point;
    point.normal = point.facet_normal = kSomeNormal;
    const InstanceInfo instance{};
    const CameraInfo camera{};
    ShadingInputs inputs;
    inputs.point = &point;
    inputs.instance = &instance;
    inputs.camera = &camera;
    inputs.outgoing = side == SeenFrom::Outside ? kSomeNormal : -kSomeNormal;
    Closures closures;
    program.evaluate(inputs, closures);
    return closures;
}

bool is_even_singular(const Lobe& lobe) {
    constexpr float kAligned = 0.9999f;
    const bool singular_type =
        lobe.type == LobeType::Reflection || lobe.type == LobeType::Refraction || lobe.type == LobeType::Glass;
    return singular_type && lobe.alpha_x == 0.0f && lobe.alpha_y == 0.0f &&
           std::abs(lobe.normal.dot(kSomeNormal)) > kAligned;
}

/// Empty where the lobes do not agree on an index.
std::optional<double> common_index(const Closures& closures) {
    std::optional<double> index;
    for (int i = 0; i < closures.size(); ++i) {
        if (closures[i].type == LobeType::Reflection && closures[i].fresnel != Lobe::Fresnel::Dielectric) continue;
        const double own = closures[i].ior;
        if (index && std::abs(*index - own) > 1e-6 * own) return std::nullopt;
        index = own;
    }
    return index;
}

}  // namespace

MaterialOptics optics_of(const Program& surface) {
    MaterialOptics optics;
    if (!surface.has_even_closures() || surface.emits() || surface.may_be_transparent()) return optics;
    const Closures outside = closures_of(surface, SeenFrom::Outside);
    bool lets_through = false;
    for (int i = 0; i < outside.size(); ++i) {
        if (!is_even_singular(outside[i])) return optics;
        lets_through |= outside[i].type != LobeType::Reflection;
    }
    if (outside.size() == 0 || outside.holdout > 0.0f) return optics;
    if (!lets_through) {
        optics.surface = SurfaceOptics::Mirror;
        return optics;
    }
    const std::optional<double> index = common_index(outside);
    const Closures inside = closures_of(surface, SeenFrom::Inside);
    if (!index || inside.size() == 0) return optics;
    optics.glass = {*index, Color(0.0f), Color(0.0f)};
    for (int i = 0; i < inside.size(); ++i) {
        const Lobe& lobe = inside[i];
        // Under a film, and where only what is met at right angles is tinted, every angle has a colour of its own.
        const bool has_colors = lobe.film.thickness > 0.0f || lobe.fresnel == Lobe::Fresnel::Schlick;
        if (!is_even_singular(lobe) || has_colors) return optics;
        // A pair weighted by Fresnel's reflectance and the rest adds up to one of its two.
        const bool reflects = lobe.type == LobeType::Reflection;
        if (!reflects || lobe.fresnel == Lobe::Fresnel::None) optics.glass.leaving += lobe.weight * lobe.refracted;
        if (lobe.type != LobeType::Refraction) optics.glass.reflected += lobe.weight;
    }
    optics.surface = SurfaceOptics::Glass;
    return optics;
}

}  // namespace rayleaf
