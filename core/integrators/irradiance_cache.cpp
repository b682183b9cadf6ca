#include "integrators/irradiance_cache.h"

#include "base/hash64.h"

namespace rayleaf {
namespace {

/// How far behind a record's horizon a point may lie, as part of its reach: what the surface's own curvature makes.
constexpr float kBehind = 0.05f;
/// Error below which records count alike; keeps weights finite.
constexpr float kLeastRecordError = 1e-4f;

uint64_t cell_key(int64_t x, int64_t y, int64_t z) {
    return hash64(hash64(hash64(static_cast<uint64_t>(x) + kHashStep) + static_cast<uint64_t>(y) + kHashStep) +
                  static_cast<uint64_t>(z) + kHashStep);
}

int64_t cell_of(double coordinate, int exponent) {
    constexpr double kFarthest = 0x1p60;  // farther cells are one: it makes lists longer, no more
    return static_cast<int64_t>(std::floor(std::clamp(std::ldexp(coordinate, -exponent), -kFarthest, kFarthest)));
}

HemisphereLight at_least_nothing(HemisphereLight light) {
    for (Color* color : {&light.direct, &light.indirect, &light.free})
        for (int i = 0; i < 3; ++i) (*color)[i] = std::max((*color)[i], 0.0f);
    return light;
}

}  // namespace

IrradianceCache::Level& IrradianceCache::level(int exponent) {
    const auto place = std::lower_bound(levels_.begin(), levels_.end(), exponent,
                                        [](const Level& level, int wanted) { return level.exponent < wanted; });
    if (place != levels_.end() && place->exponent == exponent) return *place;
    return *levels_.insert(place, Level{exponent, {}});
}

void IrradianceCache::insert(const HemisphereRecord& record) {
    const double reach = static_cast<double>(error_) * record.radius;
    if (!(reach > 0.0) || !std::isfinite(reach)) return;  // a point that the eye lies in answers for itself alone
    const auto index = static_cast<uint32_t>(records_.size());
    records_.push_back(record);
    const int exponent = static_cast<int>(std::ceil(std::log2(2.0 * reach)));
    Level& cells = level(exponent);
    const auto low = [&](double c) { return cell_of(c - reach, exponent); };
    const auto high = [&](double c) { return cell_of(c + reach, exponent); };
    const Vec3d& p = record.position;
    for (int64_t x = low(p.x); x <= high(p.x); ++x)
        for (int64_t y = low(p.y); y <= high(p.y); ++y)
            for (int64_t z = low(p.z); z <= high(p.z); ++z) {
                std::vector<uint32_t>& list = cells.cells[cell_key(x, y, z)];
                if (list.empty() || list.back() != index) list.push_back(index);
            }
}

float IrradianceCache::weight(const HemisphereRecord& record, const Vec3d& position, const Vec3f& normal) const {
    const Vec3f offset(position - record.position);
    const float turn = std::max(0.0f, 1.0f - normal.dot(record.normal));
    const float error = offset.length() / record.radius + std::sqrt(turn);
    if (!(error < error_)) return 0.0f;
    if (0.5f * offset.dot(normal + record.normal) < -kBehind * error_ * record.radius) return 0.0f;
    return 1.0f / std::max(error, kLeastRecordError) - 1.0f / error_;
}

std::optional<HemisphereLight> IrradianceCache::interpolate(const Vec3d& position, const Vec3f& normal) const {
    HemisphereLight sum;
    float weights = 0.0f;
    for (const Level& level : levels_) {
        const auto cell =
            level.cells.find(cell_key(cell_of(position.x, level.exponent), cell_of(position.y, level.exponent),
                                      cell_of(position.z, level.exponent)));
        if (cell == level.cells.end()) continue;
        for (const uint32_t index : cell->second) {
            const HemisphereRecord& record = records_[index];
            const float w = weight(record, position, normal);
            if (w == 0.0f) continue;
            HemisphereLight here = record.light;
            here += record.turning.dot(record.normal.cross(normal));
            here += record.moving.dot(Vec3f(position - record.position));
            sum += at_least_nothing(here) * w;
            weights += w;
        }
    }
    if (!(weights > 0.0f)) return std::nullopt;
    return sum * (1.0f / weights);
}

size_t IrradianceCache::bytes() const {
    constexpr size_t kListBytes = sizeof(std::vector<uint32_t>) + 2 * sizeof(void*);  // with its node
    size_t sum = records_.capacity() * sizeof(HemisphereRecord);
    for (const Level& level : levels_)
        for (const auto& [key, list] : level.cells)
            sum += sizeof(key) + kListBytes + list.capacity() * sizeof(uint32_t);
    return sum;
}

}  // namespace rayleaf
