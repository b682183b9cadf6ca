#include "integrators/vertex.h"

namespace rayleaf {

LitLobes lit_together(const Vertex& vertex, const Closures& closures, const LightSample& light) {
    const auto both = closures.evaluate_with_density(vertex.outgoing, light.direction, vertex.point.facet_normal);
    return {both.value, both.density, {}};
}

LitLobes lit_by_kind(const Vertex& vertex, const Closures& closures, const LightSample& light) {
    constexpr std::array kSeenBy = {kVisibleDiffuse, kVisibleGlossy, kVisibleTransmission};
    const Vec3f& facet = vertex.point.facet_normal;
    LitLobes lit;
    ByKind parts;
    for (const LobeKind kind : kLobeKinds) {
        if (!(light.visibility & kSeenBy[static_cast<size_t>(kind)])) continue;
        parts[kind] = closures.evaluate(vertex.outgoing, light.direction, facet, kind);
        lit.value += parts[kind];
    }
    lit.density = closures.density(vertex.outgoing, light.direction, facet);
    lit.shares = shares_of(parts, lit.value);
    return lit;
}

ByKind shares_of_scattering(const Vertex& vertex, const Closures& closures, const LobeSample& sample) {
    ByKind parts;
    if (sample.singular) {
        parts[sample.kind] = Color(1.0f);
        return parts;
    }
    Color total(0.0f);
    for (const LobeKind kind : kLobeKinds) {
        parts[kind] = closures.evaluate(vertex.outgoing, sample.direction, vertex.point.facet_normal, kind);
        total += parts[kind];
    }
    return shares_of(parts, total);
}

}  // namespace rayleaf
