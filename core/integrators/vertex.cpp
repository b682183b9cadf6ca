#include "integrators/vertex.h"

#include <algorithm>

namespace rayleaf {
namespace {

/// The rays that see a light which lights lobes of a kind.
constexpr std::array kSeenBy = {kVisibleDiffuse, kVisibleGlossy, kVisibleTransmission};

/// The density by which the vertex sends rays towards a light: none to where its facet faces away.
float density_towards(const Vertex& vertex, const LightSample& light, float density) {
    const Vec3f& facet = vertex.point.facet_normal;
    return light.direction.dot(facet) * light.direction.dot(side_normal(vertex)) < 0.0f ? 0.0f : density;
}

}  // namespace

const Vec3f& side_normal(const Vertex& vertex) {
    const SurfacePoint& point = vertex.point;
    const bool seen = point.normal.dot(vertex.outgoing) * point.facet_normal.dot(vertex.outgoing) > 0.0f;
    return point.shape && seen ? point.normal : point.facet_normal;
}

bool lights_all_kinds(const LightSample& light) {
    return std::all_of(kSeenBy.begin(), kSeenBy.end(),
                       [&light](Visibility kind) { return (light.visibility & kind) != 0; });
}

LitLobes lit_together(const Vertex& vertex, const Closures& closures, const ClosureView& view,
                      const LightSample& light) {
    const auto both = closures.evaluate_with_density(view, light.direction, side_normal(vertex));
    return {both.value, density_towards(vertex, light, both.density), {}};
}

LitLobes lit_as_foreseen(const Vertex& vertex, const LightSample& light, size_t number) {
    const Closures::Evaluation& both = vertex.lit_by_lights[number];
    return {both.value, density_towards(vertex, light, both.density), {}};
}

LitLobes lit_by_kind(const Vertex& vertex, const Closures& closures, const ClosureView& view,
                     const LightSample& light) {
    const auto lobes = closures.evaluate_by_kind(view, light.direction, side_normal(vertex));
    LitLobes lit;
    ByKind parts;
    for (const LobeKind kind : kLobeKinds) {
        if (!(light.visibility & kSeenBy[static_cast<size_t>(kind)])) continue;
        parts[kind] = lobes.values[static_cast<size_t>(kind)];
        lit.value += parts[kind];
    }
    lit.density = density_towards(vertex, light, lobes.density);
    lit.shares = shares_of(parts, lit.value);
    return lit;
}

ByKind shares_of_scattering(const Vertex& vertex, const Closures& closures, const LobeSample& sample) {
    ByKind parts;
    if (sample.singular) {
        parts[sample.kind] = Color(1.0f);
        return parts;
    }
    const auto lobes =
        closures.evaluate_by_kind({closures, vertex.outgoing}, sample.direction, vertex.point.facet_normal);
    Color total(0.0f);
    for (const LobeKind kind : kLobeKinds) {
        parts[kind] = lobes.values[static_cast<size_t>(kind)];
        total += parts[kind];
    }
    return shares_of(parts, total);
}

}  // namespace rayleaf
