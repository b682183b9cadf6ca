#include "shading/closure_view.h"

#include "shading/fresnel.h"
#include "shading/lobes.h"

namespace rayleaf {
namespace {

Side side_of(const Vec3f& outgoing, const Vec3f& incoming, const Vec3f& facet_normal) {
    const bool same = (facet_normal.dot(outgoing) > 0.0f) == (facet_normal.dot(incoming) > 0.0f);
    return same ? Side::Reflected : Side::Transmitted;
}

/// 0 for singular lobes.
LobeValue evaluate_one(const Closures& closures, int i, const LobeView& view, const DirectionPair& pair) {
    LobeValue result = evaluate_lobe(closures[i], view, pair);
    if (view.bent) {
        const float shadow =
            bump_shadow(closures.bump_shadow, closures.smooth_normal, closures[i].normal, pair.incoming);
        result.numbers *= Float4{shadow, shadow, shadow, 1.0f};
    }
    return result;
}

/// Value and density of all lobes, or only of those that are sampled together; but for `without`.
LobeValue evaluate_all(const Closures& closures, const ClosureView& view, const Vec3f& incoming, Side side,
                       bool together = false, int without = -1) {
    const DirectionPair pair(view.outgoing, incoming, side, view.halves);
    LobeValue sum;
    for (int i = 0; i < closures.size(); ++i)
        if (i != without && !(together && is_alone(closures[i])))
            sum.numbers += evaluate_one(closures, i, view.lobes[i], pair).numbers *
                           Float4{1.0f, 1.0f, 1.0f, view.lobes[i].probability};
    return sum;
}

/// The density of those lobes that are sampled by themselves.
float density_alone(const Closures& closures, const ClosureView& view) {
    float sum = 0.0f;
    for (int i = 0; i < closures.size(); ++i)
        if (is_alone(closures[i])) sum += view.lobes[i].probability * kDensityAlone;
    return sum;
}

/// What a direction that one of the lobes chose carries: value over density of those that are sampled with it, and the
/// density of all.
struct Scattering {
    Color weight;
    float density;
};

Scattering scattering(const Closures& closures, const ClosureView& view, int chosen, const LobeDirection& by,
                      Side side) {
    Color own = by.weight;
    if (view.lobes[chosen].bent)
        own *= bump_shadow(closures.bump_shadow, closures.smooth_normal, closures[chosen].normal, by.direction);
    const float alone = density_alone(closures, view);
    if (is_alone(closures[chosen])) {
        const LobeValue others = evaluate_all(closures, view, by.direction, side, true);
        return {own * (1.0f / view.lobes[chosen].probability), others.density() + alone};
    }
    const bool counts = by.weighed && by.side == side;
    if (by.weighed && closures.size() == 1) return {own, counts ? by.density : 0.0f};
    LobeValue all = evaluate_all(closures, view, by.direction, side, true, by.weighed ? chosen : -1);
    if (counts) all.numbers += LobeValue(own * by.density, by.density * view.lobes[chosen].probability).numbers;
    return {all.value() * (1.0f / all.density()), all.density() + alone};
}

/// The lobe that a number in [0,1) chooses; `random` becomes what the choice leaves of it.
int chosen_lobe(const ClosureView& view, int count, float& random) {
    if (count == 1) return 0;
    int chosen = 0;
    while (chosen + 1 < count && random >= view.lobes[chosen].probability) random -= view.lobes[chosen++].probability;
    constexpr float kBelowOne = 1.0f - 6e-8f;
    random = std::min(random / view.lobes[chosen].probability, kBelowOne);
    return chosen;
}

/// Of a lobe by which light enters a body.
Color entry_weight(const Lobe& lobe, float cosine) {
    return lobe.fresnel == Lobe::Fresnel::Schlick ? lobe.weight * (1.0f - 0.5f * schlick_weight(cosine)) : lobe.weight;
}

}  // namespace

void ClosureView::look(const Closures& closures, const Vec3f& from) {
    outgoing = from;
    halves = false;
    const int count = closures.size();
    if (count == 1) {
        look_at(closures[0], from, lobes[0]);
        lobes[0].bent = is_bent(closures[0], closures);
        lobes[0].probability = 1.0f;
        any = true;
        halves = uses_half(closures[0]);
        return;
    }
    for (int i = 0; i < count; ++i) {
        look_at(closures[i], from, lobes[i]);
        lobes[i].bent = is_bent(closures[i], closures);
        halves |= uses_half(closures[i]);
    }
    weigh(closures);
}

void ClosureView::weigh(const Closures& closures) {
    const int count = closures.size();
    if (count == 1) return;
    float sum = 0.0f;
    for (int i = 0; i < count; ++i) {
        lobes[i].probability = choice_weight(closures[i], lobes[i].cosine) + glint_weight(closures[i], lobes[i]);
        sum += lobes[i].probability;
    }
    any = sum > 0.0f;
    const float scale = any ? 1.0f / sum : 0.0f;
    for (int i = 0; i < count; ++i) lobes[i].probability *= scale;
}

Color Closures::evaluate(const Vec3f& outgoing, const Vec3f& incoming, const Vec3f& facet_normal) const {
    return evaluate_with_density({*this, outgoing}, incoming, facet_normal).value;
}

Color Closures::evaluate(const Vec3f& outgoing, const Vec3f& incoming, const Vec3f& facet_normal, LobeKind kind) const {
    return evaluate_by_kind({*this, outgoing}, incoming, facet_normal).values[static_cast<size_t>(kind)];
}

Closures::Evaluation Closures::evaluate_with_density(const ClosureView& view, const Vec3f& incoming,
                                                     const Vec3f& facet_normal) const {
    const LobeValue all = evaluate_all(*this, view, incoming, side_of(view.outgoing, incoming, facet_normal));
    return {all.value(), all.density()};
}

Closures::EvaluationByKind Closures::evaluate_by_kind(const ClosureView& view, const Vec3f& incoming,
                                                      const Vec3f& facet_normal) const {
    const Side side = side_of(view.outgoing, incoming, facet_normal);
    const DirectionPair pair(view.outgoing, incoming, side, view.halves);
    EvaluationByKind sum;
    for (int i = 0; i < count_; ++i) {
        const LobeValue lobe = evaluate_one(*this, i, view.lobes[i], pair);
        sum.values[static_cast<size_t>(kind_of(lobes_[i], side))] += lobe.value();
        sum.density += view.lobes[i].probability * lobe.density();
    }
    return sum;
}

float Closures::density(const Vec3f& outgoing, const Vec3f& incoming, const Vec3f& facet_normal) const {
    return evaluate_with_density({*this, outgoing}, incoming, facet_normal).density;
}

std::optional<LobeSample> Closures::sample(const Vec3f& outgoing, const Vec3f& facet_normal,
                                           const Vec3f& random) const {
    return sample({*this, outgoing}, facet_normal, random);
}

std::optional<LobeSample> Closures::sample(const ClosureView& view, const Vec3f& facet_normal,
                                           const Vec3f& random) const {
    if (!view.any) return std::nullopt;
    Vec3f reused = random;
    const int chosen = chosen_lobe(view, count_, reused.x);
    const float probability = view.lobes[chosen].probability;
    if (!(probability > 0.0f)) return std::nullopt;

    const Lobe& lobe = lobes_[chosen];
    const std::optional<LobeDirection> direction = sample_lobe(lobe, view.lobes[chosen], view.outgoing, reused);
    if (!direction) return std::nullopt;
    const Side side = side_of(view.outgoing, direction->direction, facet_normal);
    LobeSample sample;
    sample.direction = direction->direction;
    sample.kind = kind_of_ray(lobe, side);
    sample.singular = is_singular(lobe);
    sample.transmitted = side == Side::Transmitted;
    sample.eta = direction->eta;
    sample.roughness = lobe_width(lobe);
    sample.fibre = is_fibre(lobe);
    if (sample.fibre) sample.transmitted = direction->through;
    if (lobe.type == LobeType::Subsurface) {
        sample.subsurface = &lobe;
        sample.weight = entry_weight(lobe, view.lobes[chosen].cosine) / probability;
    } else if (sample.singular) {
        // A shading normal bent far from the facet may send the ray to the wrong side.
        if (side != direction->side) return std::nullopt;
        sample.weight = direction->weight / probability;
    } else {
        const Scattering all = scattering(*this, view, chosen, *direction, side);
        if (!(all.density > 0.0f)) return std::nullopt;
        sample.density = all.density;
        sample.weight = all.weight;
    }
    if (is_black(sample.weight) || !is_finite(sample.weight)) return std::nullopt;
    return sample;
}

}  // namespace rayleaf
