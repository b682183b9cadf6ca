#include "film/pixel_sums.h"

#include <algorithm>
#include <limits>

namespace rayleaf {
namespace {

/// Sums of all passes in double precision.
using RoundedSums = PerPass<Vec4d>;

constexpr uint64_t kFirstSamplePasses = [] {
    uint64_t passes = 0;
    for (const Pass pass : {Pass::depth, Pass::position, Pass::vector, Pass::object_index, Pass::material_index,
                            Pass::mask, Pass::tree_index, Pass::geometry_level})
        passes |= uint64_t{1} << static_cast<uint32_t>(pass);
    return passes;
}();

bool is_of_first_sample(Pass pass) {
    return static_cast<size_t>(pass) < kPassCount && (kFirstSamplePasses >> static_cast<uint32_t>(pass) & 1u) != 0;
}

Vec4f value(Pass pass, const RoundedSums& sums, int count, bool as_means) {
    const PassRuleInfo info = rule(pass);
    const Vec4d& sum = sums[pass];
    if (info.rule == PassRule::FirstSample) return Vec4f(sum);
    if (info.rule == PassRule::Count) return Vec4f(static_cast<float>(count));
    if (info.rule == PassRule::Divided && !as_means) return divided(sum, sums[info.color]);
    Vec4f mean(sum / std::max(count, 1));
    if (const std::optional<size_t> share = share_of_light(pass); share && !as_means) {
        float& limited = mean[static_cast<int>(*share)];
        limited = std::clamp(limited, 0.0f, 1.0f);
    }
    return mean;
}

}  // namespace

std::optional<size_t> share_of_light(Pass pass) {
    if (pass == Pass::combined) return 3;
    return pass == Pass::mist ? std::optional<size_t>(0) : std::nullopt;
}

Vec4f divided(const Vec4d& light, const Vec4d& color) {
    constexpr double kLargest = std::numeric_limits<float>::max();
    Vec4f value(0.0f);
    for (int i = 0; i < 3; ++i)
        if (color[i] > 0.0) value[i] = static_cast<float>(std::clamp(light[i] / color[i], -kLargest, kLargest));
    return value;
}

PassRuleInfo rule(Pass pass) {
    if (is_of_first_sample(pass)) return {PassRule::FirstSample, pass};
    switch (pass) {
        case Pass::diffuse_direct:
        case Pass::diffuse_indirect:
            return {PassRule::Divided, Pass::diffuse_color};
        case Pass::glossy_direct:
        case Pass::glossy_indirect:
            return {PassRule::Divided, Pass::glossy_color};
        case Pass::transmission_direct:
        case Pass::transmission_indirect:
            return {PassRule::Divided, Pass::transmission_color};
        case Pass::sample_count:
            return {PassRule::Count, pass};
        default:
            return {PassRule::Mean, pass};
    }
}

std::vector<Pass> computed_passes(const std::vector<Pass>& wanted) {
    std::vector<Pass> computed;
    const auto include = [&](Pass pass) {
        if (std::find(computed.begin(), computed.end(), pass) == computed.end()) computed.push_back(pass);
    };
    for (const Pass pass : wanted) {
        include(pass);
        if (rule(pass).rule == PassRule::Divided) include(rule(pass).color);
        if (pass == Pass::footage) include(Pass::shadow_catcher);
        if (pass == Pass::footage || pass == Pass::shadow_catcher) include(Pass::footage_light);
    }
    return computed;
}

void PixelSums::add(const PixelSample& sample, int number, std::span<const Pass> passes) {
    for (const Pass pass : passes) {
        if (number > 0 && is_of_first_sample(pass)) continue;
        sums_[pass].add(sample[pass]);  // those beyond the pass's channels are not read
    }
}

void PixelSums::clear(std::span<const Pass> passes) {
    for (const Pass pass : passes) sums_[pass] = ExactSums();
}

PixelValues PixelSums::values(std::span<const Pass> passes, int count, bool as_means) const {
    RoundedSums rounded;
    for (const Pass pass : passes)
        for (size_t c = 0; c < 4; ++c)
            rounded[pass][static_cast<int>(c)] = c < info(pass).channels.size() ? sums_[pass].terms(c)[0] : 0.0;
    PixelValues values;
    for (const Pass pass : passes) values[pass] = value(pass, rounded, count, as_means);
    return values;
}

}  // namespace rayleaf
