#include "lights/world_light.h"

#include "base/circle.h"

#include <tbb/parallel_for.h>

namespace rayleaf {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;
/// Share of samples that are uniform over the sphere, whatever the table says.
constexpr double kUniformShare = 0.02;
/// By how much a coarser table may raise the second moment of what a sample counts, as a factor.
constexpr double kMostLoss = 1.01;
/// Fewer rows are not worth joining.
constexpr int kLeastHeight = 16;
/// A sun's radiance is looked up at this many places, squared.
constexpr int kSunLookups = 16;
/// By how much of its own a sun's disc is sampled larger.
constexpr double kSunMargin = 1e-4;
/// Radiance is looked up at this many places along each side of a cell.
constexpr int kLookupsPerSide = 2;
constexpr size_t kLookupsPerCell = kLookupsPerSide * kLookupsPerSide;

/// Height (z) of the upper border of row `y`, rows from the upper pole down.
double row_height(double y, int height) {
    return std::cos(std::numbers::pi * y / height);
}

/// Of the circle of latitude at a height.
double radius_at(double z) {
    return std::sqrt(std::max(0.0, 1.0 - z * z));
}

/// `longitude` in full turns.
Vec3d direction_of(double longitude, double z) {
    const Vec2d around = on_circle(longitude) * radius_at(z);
    return {around.x, around.y, z};
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

/// Where a search among `count` cells begins: [0, 1) is cut into so many even parts.
int guides_of(int count) {
    constexpr int kCellsPerGuide = 4;
    return std::max(1, count / kCellsPerGuide);
}

/// Fills the first cell of each part.
void fill_guide(const float* cumulated, int count, uint32_t* guide) {
    const int parts = guides_of(count);
    uint32_t cell = 0;
    for (int i = 0; i < parts; ++i) {
        const float begin = static_cast<float>(i) / static_cast<float>(parts);
        while (cell + 1 < static_cast<uint32_t>(count) && cumulated[cell + 1] <= begin) ++cell;
        guide[i] = cell;
    }
}

/// The cell of [0, 1) that `random` falls into, and how far into it: two steps from its guide, in the mean over all
/// numbers, however uneven the cells.
int find_cell(const float* cumulated, const uint32_t* guide, int count, float random, double& within) {
    const int parts = guides_of(count);
    const int part = std::min(static_cast<int>(random * static_cast<float>(parts)), parts - 1);
    auto cell = static_cast<int>(guide[part]);
    while (cell > 0 && cumulated[cell] > random) --cell;  // the product was rounded up
    while (cell + 1 < count && cumulated[cell + 1] <= random) ++cell;
    within =
        (static_cast<double>(random) - cumulated[cell]) / (static_cast<double>(cumulated[cell + 1]) - cumulated[cell]);
    return cell;
}

/// Directions into the cells of a table: all cells of a row have the heights of their lookups in common, and all of a
/// column the longitudes.
class CellDirections {
  public:
    CellDirections(int width, int height) : width_(width), height_(height) {
        for (int x = 0; x < width; ++x)
            for (int i = 0; i < kLookupsPerSide; ++i)
                around_.push_back(direction_of((x + (i + 0.5) / kLookupsPerSide) / width, 0.0));
    }
    /// Of row `y`, cell by cell: kLookupsPerCell each.
    std::vector<Vec3f> of_row(int y) const {
        double heights[kLookupsPerSide], radii[kLookupsPerSide];
        for (int j = 0; j < kLookupsPerSide; ++j) {
            heights[j] = row_height(y + (j + 0.5) / kLookupsPerSide, height_);
            radii[j] = radius_at(heights[j]);
        }
        std::vector<Vec3f> directions;
        directions.reserve(static_cast<size_t>(width_) * kLookupsPerCell);
        for (size_t x = 0; x < static_cast<size_t>(width_); ++x)
            for (int j = 0; j < kLookupsPerSide; ++j)
                for (size_t i = 0; i < kLookupsPerSide; ++i) {
                    const Vec3d& around = around_[x * kLookupsPerSide + i];
                    directions.emplace_back(Vec3d(radii[j] * around.x, radii[j] * around.y, heights[j]));
                }
        return directions;
    }

  private:
    int width_, height_;
    std::vector<Vec3d> around_;  ///< on the equator, by longitude
};

/// What the cells of a row show.
struct RowRadiance {
    std::vector<double> means;  ///< of the largest component; what is not finite or negative counts nothing
    double low = std::numeric_limits<double>::infinity(), high = 0;
};

double brightness(const Color& color) {
    return is_finite(color) ? std::max(0.0f, max_component(color)) : 0.0f;
}

/// Places that `is_left_out` says count nothing.
template <typename IsLeftOut>
RowRadiance row_radiance(const WorldEmissions& world, const std::vector<Vec3f>& directions, IsLeftOut is_left_out) {
    std::vector<Color> colors(directions.size());
    world(directions, colors.data());
    RowRadiance row;
    for (size_t first = 0; first < colors.size(); first += kLookupsPerCell) {
        double sum = 0;
        for (size_t i = first; i < first + kLookupsPerCell; ++i) {
            if (is_left_out(directions[i])) continue;
            const double radiance = brightness(colors[i]);
            row.low = std::min(row.low, radiance);
            row.high = std::max(row.high, radiance);
            sum += radiance;
        }
        row.means.push_back(sum / kLookupsPerCell);
    }
    return row;
}

}  // namespace

WorldLight::WorldLight(const WorldEmissions& world, std::span<const SunDisc> suns, int width, WorldShare share,
                       const CancelToken& cancel)
    : width_(std::max(width, 2)), height_(std::max(width / 2, 1)) {
    const double light_of_suns = add_suns(world, suns);
    std::vector<double> weights(static_cast<size_t>(width_) * height_), row_weights(height_), lows(height_),
        highs(height_);
    for (int y = 0; y <= height_; ++y) heights_.push_back(row_height(y, height_));
    const CellDirections directions(width_, height_);
    tbb::parallel_for(0, height_, [&](int y) {
        cancel.throw_if_cancelled();
        const RowRadiance row =
            row_radiance(world, directions.of_row(y), [&](const Vec3f& at) { return is_in_sun(at); });
        lows[y] = row.low;
        highs[y] = row.high;
        const double area = heights_[y] - heights_[y + 1];
        for (int x = 0; x < width_; ++x) {
            const double weight = area * row.means[static_cast<size_t>(x)];
            weights[static_cast<size_t>(y) * width_ + x] = weight;
            row_weights[y] += weight;
        }
    });
    double total = 0;
    for (const double weight : row_weights) total += weight;
    const double low = *std::min_element(lows.begin(), lows.end()),
                 high = *std::max_element(highs.begin(), highs.end());
    const double cell = kTwoPi / width_;  // weights are of this share of a turn
    const double light = cell * total + light_of_suns;
    is_uniform_ = !(light > 0) || !std::isfinite(light) || (low == high && suns_.empty());
    if (is_uniform_) return;

    const double mean = total / (2.0 * width_), left_out = share == WorldShare::AboveMean ? mean : 0.0;
    total = 0;
    for (int y = 0; y < height_; ++y) {
        const double area = heights_[y] - heights_[y + 1];
        for (int x = 0; x < width_; ++x) {
            double& weight = weights[static_cast<size_t>(y) * width_ + x];
            weight = std::max(0.0, weight - area * left_out) + area * mean * kUniformShare;
            total += weight;
        }
    }
    const double sampled = cell * total + light_of_suns;
    set_probabilities(sampled);
    share_ = std::min(1.0, sampled / light);
    mean_ = light * share_ / (2.0 * kTwoPi);
    coarsen(weights);
    fill_tables(weights);
}

/// Returns the light of all.
double WorldLight::add_suns(const WorldEmissions& world, std::span<const SunDisc> suns) {
    double light = 0;
    for (const SunDisc& disc : suns) {
        Sun sun{{disc.direction, disc.half_angle * (1.0 + kSunMargin)}, ConeFrame(Vec3d(disc.direction))};
        std::vector<Vec3f> directions;
        for (int i = 0; i < kSunLookups; ++i)
            for (int k = 0; k < kSunLookups; ++k)
                directions.emplace_back(sample_cone(sun.towards, sun.one_minus_cosine(),
                                                    Vec2f(static_cast<float>(i) + 0.5f, static_cast<float>(k) + 0.5f) /
                                                        static_cast<float>(kSunLookups))
                                            .direction);
        std::vector<Color> colors(directions.size());
        world(directions, colors.data());
        double sum = 0;
        for (const Color& color : colors) sum += brightness(color);
        sun.light = sum / static_cast<double>(colors.size()) * sun.disc.solid_angle();
        if (sun.light > 0.0) suns_.push_back(sun);
        light += sun.light;
    }
    return light;
}

bool WorldLight::is_in_sun(const Vec3f& direction) const {
    return std::ranges::any_of(suns_, [&](const Sun& sun) { return sun.disc.contains(direction); });
}

/// Of the suns, by their share of the light that is sampled.
void WorldLight::set_probabilities(double sampled) {
    double sum = 0;
    for (Sun& sun : suns_) {
        sum += sun.light;
        sun.until = sum / sampled;
        sun.density = sun.light / sampled / sun.disc.solid_angle();
    }
}

double WorldLight::sun_density(const Vec3f& direction) const {
    double sum = 0;
    for (const Sun& sun : suns_)
        if (sun.disc.contains(direction)) sum += sun.density;
    return sum;
}

/// Joins cells, two by two each way, as long as that costs nearly nothing: a small table stays in the processor's
/// caches.
void WorldLight::coarsen(std::vector<double>& weights) {
    double loss = 1.0;
    while (width_ % 2 == 0 && height_ % 2 == 0 && height_ / 2 >= kLeastHeight) {
        const int columns = width_ / 2, rows = height_ / 2;
        std::vector<double> joined(static_cast<size_t>(columns) * static_cast<size_t>(rows));
        double total = 0, squares = 0;  // of the weights; of the ratio to what they are sampled by, times the weight
        for (int y = 0; y < rows; ++y) {
            const double* const upper = weights.data() + size_t{2} * y * width_;
            const double areas[2] = {heights_[2 * y] - heights_[2 * y + 1], heights_[2 * y + 1] - heights_[2 * y + 2]};
            for (int x = 0; x < columns; ++x) {
                double sum = 0, square = 0;
                for (int i = 0; i < 2; ++i)
                    for (int k = 0; k < 2; ++k) {
                        const double weight = upper[i * width_ + 2 * x + k];
                        sum += weight;
                        square += weight * weight / areas[i];
                    }
                joined[static_cast<size_t>(y) * static_cast<size_t>(columns) + static_cast<size_t>(x)] = sum;
                total += sum;
                squares += square * 2.0 * (areas[0] + areas[1]) / sum;
            }
        }
        loss *= squares / total;
        if (!(loss <= kMostLoss)) return;
        weights = std::move(joined);
        width_ = columns;
        height_ = rows;
        for (int y = 0; y <= height_; ++y) heights_[y] = heights_[2 * y];
        heights_.resize(static_cast<size_t>(height_) + 1);
    }
}

void WorldLight::fill_tables(const std::vector<double>& weights) {
    std::vector<double> row_weights(height_);
    rows_.resize(static_cast<size_t>(height_) + 1);
    cells_.resize(static_cast<size_t>(height_) * (static_cast<size_t>(width_) + 1));
    row_guide_.resize(static_cast<size_t>(guides_of(height_)));
    cell_guides_.resize(guide_of_row(height_));
    for (int y = 0; y < height_; ++y) {
        const double* const of_row = weights.data() + static_cast<size_t>(y) * width_;
        for (int x = 0; x < width_; ++x) row_weights[y] += of_row[x];
        float* const cells = cells_.data() + static_cast<size_t>(y) * (static_cast<size_t>(width_) + 1);
        cumulate(of_row, width_, cells);
        fill_guide(cells, width_, cell_guides_.data() + guide_of_row(y));
    }
    cumulate(row_weights.data(), height_, rows_.data());
    const double probability = suns_.empty() ? 1.0 : 1.0 - suns_.back().until;  // of the table
    for (int y = 0; y < height_; ++y) {
        const double cell = kTwoPi / width_ * (heights_[y] - heights_[y + 1]);  // its solid angle
        row_densities_.push_back(probability * (double{rows_[y + 1]} - double{rows_[y]}) / cell);
    }
    fill_guide(rows_.data(), height_, row_guide_.data());
}

size_t WorldLight::guide_of_row(int y) const {
    return static_cast<size_t>(y) * static_cast<size_t>(guides_of(width_));
}

/// The row that a direction is in.
int WorldLight::row_at(double z) const {
    // Near the angle to the upper pole, as a share of half a turn; for the lower half the angle to the lower pole.
    const double size = std::abs(z);
    const double angle =
        std::sqrt(1.0 - size) * (0.49997851 + size * (-0.06751835 + size * (0.02363836 - size * 0.00596185)));
    int y = std::clamp(static_cast<int>((z < 0.0 ? 1.0 - angle : angle) * height_), 0, height_ - 1);
    while (y > 0 && z > heights_[y]) --y;
    while (y + 1 < height_ && z <= heights_[y + 1]) ++y;
    return y;
}

Maybe<LightSample> WorldLight::sample(const Vec2f& random) const {
    Maybe<LightSample> result;
    LightSample& sample = result.emplace();
    sample.distance = std::numeric_limits<double>::infinity();
    sample.world = true;
    double before = 0.0;
    for (const Sun& sun : suns_) {
        if (random.y < sun.until) {
            const float y = below_one((random.y - before) / (sun.until - before));
            sample.direction = Vec3f(sample_cone(sun.towards, sun.one_minus_cosine(), {random.x, y}).direction);
            sample.density = static_cast<float>(density(sample.direction));
            return result;
        }
        before = sun.until;
    }
    const float left = below_one((random.y - before) / (1.0 - before));
    double x_within = 0, y_within = 0;
    const int y = find_cell(rows_.data(), row_guide_.data(), height_, left, y_within);
    const int x = find_cell(row(y), cell_guides_.data() + guide_of_row(y), width_, random.x, x_within);
    const double top = heights_[y], bottom = heights_[y + 1];
    sample.direction = Vec3f(direction_of((x + x_within) / width_, top + (bottom - top) * y_within));
    sample.density = static_cast<float>(cell_density(x, y) + sun_density(sample.direction));
    return result;
}

double WorldLight::density(const Vec3f& direction) const {
    const int y = row_at(std::clamp(static_cast<double>(direction.z), -1.0, 1.0));
    const double turns = turns_of(double{direction.x}, double{direction.y});
    return cell_density(std::min(static_cast<int>(turns * width_), width_ - 1), y) + sun_density(direction);
}

size_t WorldLight::bytes() const {
    return (rows_.capacity() + cells_.capacity()) * sizeof(float) +
           (heights_.capacity() + row_densities_.capacity()) * sizeof(double) +
           (row_guide_.capacity() + cell_guides_.capacity()) * sizeof(uint32_t);
}

}  // namespace rayleaf
