#include "shading/split_closures.h"

#include "shading/lobe_frame.h"
#include "shading/lobe_microfacet.h"
#include "shading/lobes.h"

#include <memory>

namespace rayleaf {
namespace {

/// Random numbers that make glass reflect wherever it can, and refract wherever it can.
constexpr float kReflect = 0.0f, kRefract = 1.0f - 0x1p-24f;

}  // namespace

bool is_hemispherical(const Lobe& lobe) {
    switch (lobe.type) {
        case LobeType::Reflection:
        case LobeType::Refraction:
        case LobeType::Glass:
        case LobeType::Sheet:
        case LobeType::Clearcoat:
        case LobeType::ToonGlossy:
        case LobeType::HairReflection:
        case LobeType::HairTransmission:
        case LobeType::HairFibre:
        case LobeType::HairFacets:
            return false;
        default:
            return true;
    }
}

Color hemispherical_albedo(const Lobe& lobe, const Vec3f& outgoing) {
    if (lobe.type == LobeType::Translucent) return lobe.weight;
    if (lobe.type == LobeType::Diffuse && lobe.roughness == 0.0f) return lobe.weight;
    // The mean over a grid of cosine-weighted directions; lobes of this class are smooth.
    constexpr int kRings = 4, kSectors = 8;
    const LobeFrame frame(lobe);
    LobeView view;
    look_at(lobe, outgoing, view);
    Color sum(0.0f);
    for (int ring = 0; ring < kRings; ++ring)
        for (int sector = 0; sector < kSectors; ++sector) {
            const Vec3f local = cosine_hemisphere((static_cast<float>(ring) + 0.5f) / kRings,
                                                  (static_cast<float>(sector) + 0.5f) / kSectors);
            const DirectionPair pair(outgoing, frame.to_world(local), Side::Reflected, true);
            sum += evaluate_lobe(lobe, view, pair).value() * (kPi / local.z);
        }
    return sum / static_cast<float>(kRings * kSectors);
}

Closures* SplitClosures::class_of(const Lobe& lobe) {
    if (lobe.type == LobeType::Subsurface) return &subsurface_;
    if (is_singular(lobe)) return nullptr;
    return is_hemispherical(lobe) ? &diffuse_ : &glossy_;
}

Closures* SplitClosures::class_of_all(const Closures& closures) {
    Closures* result = closures.size() > 0 ? class_of(closures[0]) : nullptr;
    for (int i = 1; i < closures.size() && result; ++i)
        if (class_of(closures[i]) != result) result = nullptr;
    return result;
}

SplitClosures::SplitClosures(const Closures& closures, const Vec3f& outgoing, const Vec3f& facet_normal) {
    if (Closures* alone = class_of_all(closures)) {
        *alone = closures;
    } else {
        diffuse_.smooth_normal = glossy_.smooth_normal = closures.smooth_normal;
        diffuse_.bump_shadow = glossy_.bump_shadow = closures.bump_shadow;
        for (int i = 0; i < closures.size(); ++i)
            if (Closures* of_class = class_of(closures[i]))
                of_class->add(closures[i]);
            else
                add_singular(closures[i], outgoing, facet_normal);
    }
    glossy_view_.look(glossy_, outgoing);
    diffuse_view_.look(diffuse_, outgoing);
}

void SplitClosures::add_singular(const Lobe& lobe, const Vec3f& outgoing, const Vec3f& facet_normal) {
    const bool glass = lobe.type == LobeType::Glass;
    LobeView view;
    look_at(lobe, outgoing, view);
    const float reflected = glass ? glass_shares(lobe, view.cosine).reflects : 1.0f;
    for (const float random : {kReflect, kRefract}) {
        const bool second = random == kRefract;
        const float share = second ? 1.0f - reflected : reflected;
        if (!(share > 0.0f)) continue;
        const std::optional<LobeDirection> direction = sample_lobe(lobe, view, outgoing, Vec3f(random, 0.0f, 0.0f));
        if (!direction) continue;
        LobeSample sample;
        sample.direction = direction->direction;
        sample.transmitted = (facet_normal.dot(outgoing) > 0.0f) != (facet_normal.dot(sample.direction) > 0.0f);
        // A shading normal bent far from the facet may send the ray to the wrong side.
        if (sample.transmitted != (direction->side == Side::Transmitted)) continue;
        if (glass && sample.transmitted != second) continue;
        sample.weight = direction->weight * share;
        sample.kind = kind_of(lobe, sample.transmitted ? Side::Transmitted : Side::Reflected);
        sample.singular = true;
        sample.eta = direction->eta;
        add_singular(sample);
    }
}

void SplitClosures::add_singular(const LobeSample& sample) {
    if (is_black(sample.weight) || !is_finite(sample.weight)) return;
    for (int i = 0; i < singular_count_; ++i) {
        LobeSample& other = singular_[i];
        if (other.direction == sample.direction && other.kind == sample.kind) {
            other.weight += sample.weight;
            return;
        }
    }
    std::construct_at(&singular_[singular_count_++], sample);
}

}  // namespace rayleaf
