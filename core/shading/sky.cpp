#include "shading/sky.h"

namespace rayleaf {
namespace {

constexpr size_t kSkyHeader = 20;
constexpr float kMostAlong = 4096.0f;
constexpr float kLimbDarkening = 0.6f;
/// The height (z) at which the sky has faded to black.
constexpr float kGround = -0.4f;
constexpr float kQuarterTurn = 0.5f * kPi, kFullTurn = 2.0f * kPi;

/// The header of a table.
struct SkySettings {
    Vec3f sun, low, high;
    float half_angle, lowest, highest, begin, horizon;
    size_t width, height;
    bool is_whole;

    explicit SkySettings(std::span<const float> t)
        : sun(t[0], t[1], t[2]),
          low(t[4], t[5], t[6]),
          high(t[8], t[9], t[10]),
          half_angle(t[3]),
          lowest(t[7]),
          highest(t[11]),
          begin(t[12]),
          horizon(t[17]),
          width(static_cast<size_t>(t[13])),
          height(static_cast<size_t>(t[14])),
          is_whole(t[16] != 0.0f) {}
};

bool is_side(float x) {
    return x >= 1.0f && x <= kMostAlong && x == std::floor(x);
}

/// Two neighbours among `count` places whose middles are at halves, and the share of the second.
struct Between {
    size_t first, second;
    float share;

    Between(float at, size_t count) {
        const float last = static_cast<float>(count - 1), clamped = std::clamp(at - 0.5f, 0.0f, last);
        first = static_cast<size_t>(clamped);
        second = std::min(first + 1, count - 1);
        share = clamped - static_cast<float>(first);
    }
};

/// Radiance of the disc in a direction; black beside it.
Vec3f disc_radiance(const SkySettings& sky, const Vec3f& unit, float elevation) {
    if (!(sky.half_angle > 0.0f && elevation > sky.horizon)) return Vec3f(0.0f);
    // Exact where it is small, too.
    const float apart = 2.0f * std::atan2((unit - sky.sun).length(), (unit + sky.sun).length()) / sky.half_angle;
    if (!(apart < 1.0f)) return Vec3f(0.0f);
    const float share = std::clamp((elevation - sky.lowest) / (sky.highest - sky.lowest), 0.0f, 1.0f);
    const float rim = std::sqrt(std::max(1.0f - apart * apart, 0.0f));
    const Vec3f radiance = (sky.low + (sky.high - sky.low) * share) * (1.0f - kLimbDarkening + kLimbDarkening * rim);
    return {std::max(radiance.x, 0.0f), std::max(radiance.y, 0.0f), std::max(radiance.z, 0.0f)};
}

/// That of the sky, between the table's places.
Vec3f table_radiance(std::span<const float> table, const SkySettings& sky, const Vec3f& unit, float elevation) {
    const float root = std::sqrt(std::abs(elevation) / kQuarterTurn), up = elevation < 0.0f ? -root : root;
    const float row = sky.is_whole ? 0.5f * up + 0.5f : std::max(up, 0.0f);
    const float turns = (std::atan2(unit.x, unit.y) - sky.begin) / kFullTurn, column = turns - std::floor(turns);
    const Between x(column * static_cast<float>(sky.width), sky.width),
        y(row * static_cast<float>(sky.height), sky.height);
    const auto at = [&](size_t i, size_t j) {
        const float* const rgb = table.data() + kSkyHeader + 3 * (j * sky.width + i);
        return Vec3f(rgb[0], rgb[1], rgb[2]);
    };
    const Vec3f lower = at(x.first, y.first) + (at(x.second, y.first) - at(x.first, y.first)) * x.share,
                upper = at(x.first, y.second) + (at(x.second, y.second) - at(x.first, y.second)) * x.share;
    const float fade = sky.is_whole ? 1.0f : std::clamp(1.0f - unit.z / kGround, 0.0f, 1.0f);
    return (lower + (upper - lower) * y.share) * (fade * fade * fade);
}

}  // namespace

bool is_sky_table(std::span<const float> table) {
    if (table.size() < kSkyHeader || !is_side(table[13]) || !is_side(table[14])) return false;
    const SkySettings sky(table);
    const bool has_sun = sky.half_angle > 0.0f;
    if (sky.half_angle < 0.0f || (has_sun && !(sky.highest > sky.lowest && sky.half_angle <= kPi))) return false;
    if (has_sun && std::abs(sky.sun.length2() - 1.0f) > 1e-4f) return false;
    return table.size() >= kSkyHeader + 3 * sky.width * sky.height;
}

Vec3f sky_value(std::span<const float> table, const Vec3f& direction) {
    const SkySettings sky(table);
    const Vec3f unit = normalized_or(direction, Vec3f(0.0f));
    const float elevation = std::asin(std::clamp(unit.z, -1.0f, 1.0f));
    const Vec3f disc = disc_radiance(sky, unit, elevation);
    if (!sky.is_whole && disc != Vec3f(0.0f)) return disc;
    return disc + table_radiance(table, sky, unit, elevation);
}

std::optional<SunDisc> sun_of_sky(std::span<const float> table) {
    const SkySettings sky(table);
    if (!(sky.half_angle > 0.0f)) return std::nullopt;
    return SunDisc{Vec3d(sky.sun).normalized(), sky.half_angle};
}

}  // namespace rayleaf
