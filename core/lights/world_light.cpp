#include "lights/world_light.h"

#include <tbb/parallel_for.h>

namespace rayleaf {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;
/// Share of samples that are uniform over the sphere, whatever the table says.
constexpr double kUniformShare = 0.02;
/// Radiance is looked up at this many places along each side of a cell.
constexpr int kLookupsPerSide = 2;

/// Height (z) of the upper border of row `y`, rows from the upper pole down.
double row_height(double y, int height) {
    return std::cos(std::numbers::pi * y / height);
}

Vec3d direction_of(double longitude, double z) {
    const double radius = std::sqrt(std::max(0.0, 1.0 - z * z));
    return {radius * std::cos(longitude), radius * std::sin(longitude), z};
}

/// Cumulates `weights` to 1; all zero becomes uniform.
void cumulate(const double* weights, int count, float* cumulated) {
    double total = 0;
    for (int i = 0; i < count; ++i) total += weights[i];
    double sum = 0;
    cumulated[0] = 0.0f;
    for (int i = 0; i < count; ++i) {
        sum += total > 0 ? weights[i] / total : 1.0 / count;
        cumulated[i + 1] = static_cast<float>(sum);
    }
    cumulated[count] = 1.0f;
}

/// The cell of [0, 1) that `random` falls into, and how far into it.
int find_cell(const float* cumulated, int count, float random, double& within) {
    const float* above = std::upper_bound(cumulated + 1, cumulated + count, random);
    const auto cell = static_cast<int>(above - cumulated) - 1;
    within =
        (static_cast<double>(random) - cumulated[cell]) / (static_cast<double>(cumulated[cell + 1]) - cumulated[cell]);
    return cell;
}

/// Mean of the largest component over a cell; what is not finite or negative counts nothing.
double cell_radiance(const WorldEmission& world, int x, int y, int width, int height, double& low, double& high) {
    double sum = 0;
    for (int j = 0; j < kLookupsPerSide; ++j)
        for (int i = 0; i < kLookupsPerSide; ++i) {
            const double longitude = kTwoPi * (x + (i + 0.5) / kLookupsPerSide) / width;
            const double z = row_height(y + (j + 0.5) / kLookupsPerSide, height);
            const Color color = world(Vec3f(direction_of(longitude, z)));
            const double radiance = is_finite(color) ? std::max(0.0f, max_component(color)) : 0.0f;
            low = std::min(low, radiance);
            high = std::max(high, radiance);
            sum += radiance;
        }
    return sum / (kLookupsPerSide * kLookupsPerSide);
}

}  // namespace

WorldLight::WorldLight(const WorldEmission& world, int width, const CancelToken& cancel)
    : width_(std::max(width, 2)), height_(std::max(width / 2, 1)) {
    std::vector<double> weights(static_cast<size_t>(width_) * height_), row_weights(height_), lows(height_),
        highs(height_);
    for (int y = 0; y <= height_; ++y) heights_.push_back(row_height(y, height_));
    tbb::parallel_for(0, height_, [&](int y) {
        cancel.throw_if_cancelled();
        lows[y] = std::numeric_limits<double>::infinity();
        const double area = heights_[y] - heights_[y + 1];
        for (int x = 0; x < width_; ++x) {
            const double weight = area * cell_radiance(world, x, y, width_, height_, lows[y], highs[y]);
            weights[static_cast<size_t>(y) * width_ + x] = weight;
            row_weights[y] += weight;
        }
    });
    double total = 0;
    for (const double weight : row_weights) total += weight;
    mean_ = total / (2.0 * width_);
    const double low = *std::min_element(lows.begin(), lows.end()),
                 high = *std::max_element(highs.begin(), highs.end());
    is_uniform_ = !(total > 0) || !std::isfinite(total) || low == high;
    if (is_uniform_) return;

    rows_.resize(static_cast<size_t>(height_) + 1);
    cells_.resize(static_cast<size_t>(height_) * (static_cast<size_t>(width_) + 1));
    for (int y = 0; y < height_; ++y) {
        const double area = heights_[y] - heights_[y + 1];
        double* of_row = weights.data() + static_cast<size_t>(y) * width_;
        row_weights[y] = 0;
        for (int x = 0; x < width_; ++x) {
            of_row[x] += area * mean_ * kUniformShare;
            row_weights[y] += of_row[x];
        }
        cumulate(of_row, width_, cells_.data() + static_cast<size_t>(y) * (static_cast<size_t>(width_) + 1));
    }
    cumulate(row_weights.data(), height_, rows_.data());
}

double WorldLight::cell_density(int x, int y) const {
    const double probability =
        (static_cast<double>(rows_[y + 1]) - rows_[y]) * (static_cast<double>(row(y)[x + 1]) - row(y)[x]);
    const double solid_angle = kTwoPi / width_ * (heights_[y] - heights_[y + 1]);
    return probability / solid_angle;
}

LampSample WorldLight::sample(const Vec2f& random) const {
    double x_within = 0, y_within = 0;
    const int y = find_cell(rows_.data(), height_, random.y, y_within);
    const int x = find_cell(row(y), width_, random.x, x_within);
    const double top = heights_[y], bottom = heights_[y + 1];
    LampSample sample;
    sample.direction = direction_of(kTwoPi * (x + x_within) / width_, top + (bottom - top) * y_within);
    sample.distance = std::numeric_limits<double>::infinity();
    sample.density = cell_density(x, y);
    return sample;
}

double WorldLight::density(const Vec3f& direction) const {
    const double z = std::clamp(static_cast<double>(direction.z), -1.0, 1.0);
    const int y = std::min(static_cast<int>(std::acos(z) / std::numbers::pi * height_), height_ - 1);
    double turns = std::atan2(direction.y, direction.x) / kTwoPi;
    if (turns < 0) turns += 1.0;
    const int x = std::min(static_cast<int>(turns * width_), width_ - 1);
    return cell_density(x, y);
}

size_t WorldLight::bytes() const {
    return (rows_.capacity() + cells_.capacity()) * sizeof(float) + heights_.capacity() * sizeof(double);
}

}  // namespace rayleaf
