#include "integrators/contributions.h"

namespace rayleaf {
namespace {

/// Scaled down so that the mean of the channels' sizes does not pass `limit`, as in Cycles. Light that left the range
/// of floats counts nothing: a single path of a pixel must not spoil the rest.
Color clamped(const Color& light, float limit) {
    if (!is_finite(light)) return Color(0.0f);
    const float size = (std::abs(light.x) + std::abs(light.y) + std::abs(light.z)) / 3.0f;
    return size > limit ? light * (limit / size) : light;
}

constexpr std::array kDirectPasses = {Pass::diffuse_direct, Pass::glossy_direct, Pass::transmission_direct};
constexpr std::array kIndirectPasses = {Pass::diffuse_indirect, Pass::glossy_indirect, Pass::transmission_indirect};

}  // namespace

void Contributions::add_seen(Pass pass, const Color& light, int group) {
    const Color c = clamped(light, settings_.clamp_direct);
    sample.add_to_slot(group, c * settings_.exposure);
    sample.add(Pass::combined, c);
    sample.add(pass, c);
}

void Contributions::add_hidden_world(const Color& light) {
    sample.add(Pass::environment, clamped(light, settings_.clamp_direct));
}

void Contributions::add_split(const Color& light, const ByKind& shares, bool direct, int group) {
    sample.add(Pass::combined, light);
    sample.add_to_slot(group, light * settings_.exposure);
    if (!settings_.light_passes) return;
    if (shares.in_medium) return sample.add(direct ? Pass::volume_direct : Pass::volume_indirect, light);
    const auto& passes = direct ? kDirectPasses : kIndirectPasses;
    for (const LobeKind kind : kLobeKinds) sample.add(passes[static_cast<size_t>(kind)], light * shares[kind]);
}

void Contributions::add_first(const Color& light, const ByKind& shares, int group, float share) {
    add_split(clamped(light, settings_.clamp_direct * share), shares, true, group);
}

void Contributions::add_scattered(const Color& light, int scatterings, const ByKind& first_shares, int group,
                                  float share) {
    const bool direct = scatterings == 1;
    add_split(clamped(light, (direct ? settings_.clamp_direct : settings_.clamp_indirect) * share), first_shares,
              direct, group);
}

void Contributions::add_albedo(const ByKind& albedo) {
    constexpr std::array kColors = {Pass::diffuse_color, Pass::glossy_color, Pass::transmission_color};
    for (const LobeKind kind : kLobeKinds)
        if (is_finite(albedo[kind])) sample.add(kColors[static_cast<size_t>(kind)], albedo[kind]);
}

void Contributions::finish(float alpha) {
    if (settings_.exposure != 1.0f) {
        for (const PassInfo& entry : kPasses) {
            const bool light =
                entry.pass == Pass::combined || entry.pass == Pass::emission || entry.pass == Pass::environment ||
                entry.pass == Pass::volume_direct || entry.pass == Pass::volume_indirect ||
                std::find(kDirectPasses.begin(), kDirectPasses.end(), entry.pass) != kDirectPasses.end() ||
                std::find(kIndirectPasses.begin(), kIndirectPasses.end(), entry.pass) != kIndirectPasses.end();
            if (light) sample[entry.pass] *= settings_.exposure;
        }
    }
    sample[Pass::combined].w = alpha;
}

ByKind shares_of(const ByKind& parts, const Color& total) {
    ByKind shares;
    for (const LobeKind kind : kLobeKinds)
        for (int channel = 0; channel < 3; ++channel)
            if (total[channel] > 0.0f) shares[kind][channel] = parts[kind][channel] / total[channel];
    return shares;
}

}  // namespace rayleaf
