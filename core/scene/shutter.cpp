#include "scene/shutter.h"

#include "base/error.h"
#include "base/largest.h"

#include <algorithm>
#include <cmath>

namespace rayleaf {

void validate(const ShutterDescription& shutter) {
    constexpr const char* kCamera = "camera";
    for (const float open : shutter.curve)
        if (!std::isfinite(open)) throw InputError(kCamera, "shutter curve", number_text(open), "finite numbers");
    if (shutter.curve.size() == 1)
        throw InputError(kCamera, "shutter curve", "of one number", "at least two numbers, or none");
    if (shutter.rolling && !(*shutter.rolling >= 0.0 && *shutter.rolling <= 1.0))
        throw InputError(kCamera, "rolling shutter", number_text(*shutter.rolling), "a share from 0 to 1");
}

/// A curve below 0 exposes as Cycles has it: by its size.
Shutter::Shutter(const ShutterDescription& description) : rolling_(description.rolling) {
    const std::vector<float>& curve = description.curve;
    double sum = 0;
    for (size_t i = 1; i < curve.size(); ++i) sum += std::abs(curve[i - 1]) + std::abs(double{curve[i]});
    if (!(sum > 0.0)) return;
    exposed_.push_back(0.0);
    for (size_t i = 1; i < curve.size(); ++i)
        exposed_.push_back(exposed_.back() + (std::abs(curve[i - 1]) + std::abs(double{curve[i]})) / sum);
}

double Shutter::moment(double random) const {
    if (exposed_.empty()) return random;
    const auto after = std::upper_bound(exposed_.begin() + 1, exposed_.end() - 1, random);
    const double from = *(after - 1), width = *after - from;
    const double within = width > 0.0 ? std::clamp((random - from) / width, 0.0, 1.0) : 0.0;
    return (static_cast<double>(after - 1 - exposed_.begin()) + within) / static_cast<double>(exposed_.size() - 1);
}

float Shutter::time(float random, double height) const {
    double time = moment(random);
    if (rolling_) {
        const double row = std::clamp(1.0 - height, 0.0, 1.0);
        time = (time - 0.5) * *rolling_ + (row - 0.5) * (1.0 - *rolling_) + 0.5;
    }
    return static_cast<float>(time);
}

}  // namespace rayleaf
