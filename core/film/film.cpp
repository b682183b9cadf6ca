#include "film/film.h"

#include <algorithm>
#include <limits>

namespace rayleaf {

PassRuleInfo rule(Pass pass) {
    switch (pass) {
        case Pass::depth:
        case Pass::position:
        case Pass::object_index:
        case Pass::material_index:
        case Pass::mask:
        case Pass::tree_index:
        case Pass::geometry_level:
            return {PassRule::FirstSample, pass};
        case Pass::diffuse_direct:
        case Pass::diffuse_indirect:
            return {PassRule::Divided, Pass::diffuse_color};
        case Pass::glossy_direct:
        case Pass::glossy_indirect:
            return {PassRule::Divided, Pass::glossy_color};
        case Pass::transmission_direct:
        case Pass::transmission_indirect:
            return {PassRule::Divided, Pass::transmission_color};
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
    }
    return computed;
}

void PixelSums::add(const PixelSample& sample, std::span<const Pass> passes) {
    for (const Pass pass : passes) {
        if (count_ > 0 && rule(pass).rule == PassRule::FirstSample) continue;
        const Vec4f& value = sample[pass];
        sums_[static_cast<size_t>(pass)] += Vec4d(value.x, value.y, value.z, value.w);
    }
    ++count_;
}

Vec4f PixelSums::value(Pass pass) const {
    const PassRuleInfo info = rule(pass);
    const Vec4d& sum = sums_[static_cast<size_t>(pass)];
    if (info.rule == PassRule::FirstSample) return Vec4f(sum);
    if (info.rule == PassRule::Mean) {
        Vec4f mean(sum / std::max(count_, 1));
        // Where a material passes and scatters more light than comes, alpha is right in the mean of many samples only.
        if (pass == Pass::combined) mean.w = std::clamp(mean.w, 0.0f, 1.0f);
        return mean;
    }
    const Vec4d& color = sums_[static_cast<size_t>(info.color)];
    constexpr double kLargest = std::numeric_limits<float>::max();
    Vec4f value(0.0f);
    for (int i = 0; i < 3; ++i)
        if (color[i] > 0.0) value[i] = static_cast<float>(std::clamp(sum[i] / color[i], -kLargest, kLargest));
    return value;
}

Film::Film(int width, int height, std::vector<Pass> passes)
    : width_(width), height_(height), passes_(std::move(passes)) {
    for (const Pass pass : passes_)
        data_[static_cast<size_t>(pass)].assign(
            static_cast<size_t>(width) * static_cast<size_t>(height) * info(pass).channels.size(), 0.0f);
}

void Film::put(int x, int y, int width, int height, std::span<const PixelSums> sums) {
    const std::scoped_lock lock(mutex_);
    for (const Pass pass : passes_) {
        std::vector<float>& data = data_[static_cast<size_t>(pass)];
        const size_t channels = info(pass).channels.size();
        for (int row = 0; row < height; ++row) {
            float* out =
                &data[(static_cast<size_t>(y + row) * static_cast<size_t>(width_) + static_cast<size_t>(x)) * channels];
            for (int column = 0; column < width; ++column) {
                const Vec4f value =
                    sums[static_cast<size_t>(row) * static_cast<size_t>(width) + static_cast<size_t>(column)].value(
                        pass);
                for (size_t c = 0; c < channels; ++c) *out++ = value[static_cast<int>(c)];
            }
        }
    }
}

std::vector<float> Film::pixels(Pass pass) const {
    const std::scoped_lock lock(mutex_);
    return data_[static_cast<size_t>(pass)];
}

size_t Film::bytes() const {
    size_t sum = 0;
    for (const std::vector<float>& data : data_) sum += data.size() * sizeof(float);
    return sum;
}

}  // namespace rayleaf
