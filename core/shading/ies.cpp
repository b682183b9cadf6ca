#include "shading/ies.h"

namespace rayleaf {
namespace {

constexpr size_t kHeader = 4;
constexpr float kMostAngles = 4096.0f;

bool is_count(float x) {
    return x >= 2.0f && x <= kMostAngles && x == std::floor(x);
}

/// Catmull and Rom's, between b and c.
float cubic(float a, float b, float c, float d, float x) {
    return 0.5f * (((d + 3.0f * (b - c) - a) * x + (2.0f * a - 5.0f * b + 4.0f * c - d)) * x + (c - a)) * x + b;
}

/// The step of ascending angles that holds one, and how far into it.
struct AngleStep {
    size_t first;
    float share;

    AngleStep(std::span<const float> angles, float angle) {
        const auto above = std::lower_bound(angles.begin() + 1, angles.end() - 1, angle);
        first = static_cast<size_t>(above - angles.begin()) - 1;
        const float width = angles[first + 1] - angles[first];
        share = width > 0.0f ? std::clamp((angle - angles[first]) / width, 0.0f, 1.0f) : 0.0f;
    }
};

/// Along one horizontal angle. Beyond the pole the light is taken to be the same on the other side, as in Cycles.
float along(std::span<const float> values, const AngleStep& step) {
    const size_t i = step.first, last = values.size() - 1;
    return cubic(values[i == 0 ? 1 : i - 1], values[i], values[i + 1], values[std::min(i + 2, last)], step.share);
}

}  // namespace

bool is_ies_table(std::span<const float> table) {
    if (table.size() < kHeader || !is_count(table[0]) || !is_count(table[1])) return false;
    const auto rows = static_cast<size_t>(table[0]), columns = static_cast<size_t>(table[1]);
    if (table.size() < kHeader + rows + columns + rows * columns) return false;
    const std::span<const float> vertical = table.subspan(kHeader, rows),
                                 horizontal = table.subspan(kHeader + rows, columns);
    return std::is_sorted(vertical.begin(), vertical.end()) && std::is_sorted(horizontal.begin(), horizontal.end());
}

float ies_value(std::span<const float> table, const Vec3f& direction) {
    const auto rows = static_cast<size_t>(table[0]), columns = static_cast<size_t>(table[1]);
    const std::span<const float> vertical = table.subspan(kHeader, rows),
                                 horizontal = table.subspan(kHeader + rows, columns);
    const Vec3f unit = normalized_or(direction, Vec3f(0.0f));
    const float down = std::acos(std::clamp(-unit.z, -1.0f, 1.0f)), around = std::atan2(unit.x, unit.y) + kPi;
    if (down >= vertical.back()) return 0.0f;
    const AngleStep row(vertical, down), column(horizontal, around);
    const auto at = [&](size_t i) { return along(table.subspan(kHeader + rows + columns + i * rows, rows), row); };
    const size_t i = column.first;
    const float value =
        cubic(at(i == 0 ? columns - 2 : i - 1), at(i), at(i + 1), at(i + 2 == columns ? 1 : i + 2), column.share);
    return std::max(value, 0.0f);
}

}  // namespace rayleaf
