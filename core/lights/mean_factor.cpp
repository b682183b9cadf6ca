#include "lights/mean_factor.h"

#include "lights/chosen_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace rayleaf {
namespace {

/// Directions spread evenly over what a lamp shines on, around the -z axis of its frame.
Vec3f spread_direction(const Lamp& lamp, size_t number, size_t count) {
    double least_cosine = -1;
    if (lamp.kind == LampKind::Spot) least_cosine = std::cos(std::min(lamp.spot_size / 2, std::numbers::pi));
    if (lamp.kind == LampKind::Rectangle || lamp.kind == LampKind::Disk) least_cosine = 0;
    const double share = (static_cast<double>(number) + 0.5) / static_cast<double>(count);
    const double cosine = 1.0 - share * (1.0 - least_cosine), sine = std::sqrt(std::max(1.0 - cosine * cosine, 0.0));
    const double angle =
        2.0 * std::numbers::pi * std::numbers::phi * static_cast<double>(number);  // Fibonacci's lattice
    const Affine3d& frame = lamp.to_world;
    return Vec3f(frame.x.normalized() * (sine * std::cos(angle)) + frame.y.normalized() * (sine * std::sin(angle)) -
                 frame.z.normalized() * cosine);
}

}  // namespace

double mean_factor(const Lamp& lamp, size_t number, const LampEmission& emission) {
    if (!lamp.emission) return 1;
    constexpr size_t kDirections = 128;
    constexpr double kLeast = 1e-3, kMost = 1e12;
    const bool is_sun = lamp.kind == LampKind::Sun;
    std::vector<LampPoint> points;
    points.reserve(kDirections);
    for (size_t i = 0; i < kDirections; ++i) {
        const Vec3f outgoing = is_sun ? -Vec3f(lamp.to_world.z.normalized()) : spread_direction(lamp, i, kDirections);
        const Vec3d position = is_sun ? Vec3d(-outgoing) : lamp.to_world.translation;
        const double distance = is_sun ? std::numeric_limits<double>::infinity() : 1.0;
        points.push_back({number, position, outgoing, of_length(sampling_state(), distance)});
    }
    std::array<Color, kDirections> factors;
    emission(points, factors.data());
    double sum = 0;
    for (const Color& factor : factors) sum += std::abs(double{factor.x} + double{factor.y} + double{factor.z}) / 3;
    const double mean = sum / kDirections;
    return std::isfinite(mean) ? std::clamp(mean, kLeast, kMost) : 1.0;
}

}  // namespace rayleaf
