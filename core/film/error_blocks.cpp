#include "film/error_blocks.h"

#include <algorithm>
#include <cmath>

namespace rayleaf {
namespace {

using Unit = ErrorGoal::Unit;

/// What is aimed at, as a share of a target error: an estimate is no bound, and misses what is bright and rare.
constexpr double kAim = 0.95;
/// Standard deviations of the estimate that are kept free beside that.
constexpr double kDeviations = 3;
/// Samples of a pixel in the first round.
constexpr int kFirstRound = 8;
/// A round makes of each sample that many at most, so that the next one can be judged by more of them.
constexpr double kMostGrowth = 2;
/// How much of a block's deviation the blocks around it tell. More blurs the borders of what is noisy.
constexpr double kNeighbors = 0.3;
/// And its halves, beside a target error: brightness does not see every change of a colour.
constexpr double kHalves = 0.2;
/// A block of less than this share of a noise threshold is not noisy at all.
constexpr double kCalm = 0.01;

/// Blocks of `side` in `length` pixels.
int blocks_in(int length, int side) {
    return (length + side - 1) / side;
}

/// Expected square of what is displayed of a mean that is off by `deviation` to either side.
double displayed_square(double mean, double deviation) {
    const double shown = std::clamp(mean, 0.0, 1.0);
    const double above = std::clamp(mean + deviation, 0.0, 1.0) - shown;
    const double below = shown - std::clamp(mean - deviation, 0.0, 1.0);
    return (above * above + below * below) / 2.0;
}

/// By how much the halves of a pixel differ.
double displayed_square(const PixelMoments& pixel, int samples) {
    const double odd = samples / 2, even = samples - odd;  // NOLINT(bugprone-integer-division)
    double squares = 0;
    for (int c = 0; c < 3; ++c)
        squares += displayed_square((pixel.even[c] + pixel.odd[c]) / samples,
                                    std::abs(pixel.even[c] / even - pixel.odd[c] / odd) / 2.0);
    return squares;
}

}  // namespace

void PixelMoments::add(const PixelSample& sample, bool is_odd) {
    constexpr double kLargest = 1e30;  // sums of squares stay finite
    // What shadow catchers scatter is no part of Combined until their shadow is, but is as noisy.
    const Vec4f color = sample[Pass::combined] + sample[Pass::shadow_catcher];
    Vec3d finite(0, 0, 0);
    for (int c = 0; c < 3; ++c)
        if (!std::isnan(color[c])) finite[c] = std::clamp(double{color[c]}, -kLargest, kLargest);
    (is_odd ? odd : even) += finite;
    squares += sum(finite) * sum(finite);
}

PixelMoments& PixelMoments::operator+=(const PixelMoments& other) {
    even += other.even;
    odd += other.odd;
    squares += other.squares;
    return *this;
}

double PixelMoments::variance(int samples) const {
    const double n = samples, mean = brightness(samples);
    return std::max(squares - n * mean * mean, 0.0) / (n - 1.0) / n;
}

double PixelMoments::noise(int samples) const {
    constexpr double kDark = 1e-4;  // below, a pixel is taken to be black, as Cycles takes it
    return std::sqrt(variance(samples)) / (kDark + std::sqrt(std::abs(brightness(samples))));
}

ErrorBlocks::ErrorBlocks(int width, int height, const ErrorGoal& goal)
    : width_(width),
      height_(height),
      columns_(blocks_in(width, kSide)),
      rows_(blocks_in(height, kSide)),
      group_columns_(blocks_in(width, kGroup)),
      goal_(goal),
      pixels_(static_cast<size_t>(width) * static_cast<size_t>(height)),
      blocks_(static_cast<size_t>(columns_) * static_cast<size_t>(rows_)),
      costs_(static_cast<size_t>(group_columns_) * static_cast<size_t>(blocks_in(height, kGroup))) {
    goal_.least_samples = std::max(goal.least_samples, 2);
    for (Block& each : blocks_) each.needed = goal_.least_samples;
}

Window ErrorBlocks::window(size_t index) const {
    const int x = static_cast<int>(index) % columns_ * kSide, y = static_cast<int>(index) / columns_ * kSide;
    return {x, y, std::min(kSide, width_ - x), std::min(kSide, height_ - y)};
}

double ErrorBlocks::pixels(size_t index) const {
    const Window place = window(index);
    return static_cast<double>(place.width) * place.height;
}

/// Samples that a block is to have after the next round.
int ErrorBlocks::wanted(const Block& block, int most) const {
    // The halves of a picture are alike.
    const auto whole = [this](double number) {
        const double step = goal_.unit == Unit::Displayed ? 2.0 : 1.0;
        return static_cast<int>(std::ceil(number / step) * step);
    };
    const int at_once =
        block.samples == 0 ? kFirstRound : whole(std::max(kMostGrowth * block.samples, block.samples + 2.0));
    return std::min({whole(std::min<double>(block.needed, most)), at_once, most});
}

std::vector<std::vector<WindowSamples>> ErrorBlocks::next(int most) const {
    std::vector<std::vector<WindowSamples>> found(costs_.size());
    for (size_t i = 0; i < blocks_.size(); ++i) {
        const int has = blocks_[i].samples, count = wanted(blocks_[i], most) - has;
        const Window place = window(i);
        if (count > 0) found[group(place.x, place.y)].push_back({place, {has, count}, has});
    }
    std::erase_if(found, [](const auto& each) { return each.empty(); });
    return found;
}

double ErrorBlocks::samples_missing(int most) const {
    double sum = 0;
    for (size_t i = 0; i < blocks_.size(); ++i)
        sum += pixels(i) * std::max(std::min<double>(blocks_[i].needed, most) - blocks_[i].samples, 0.0);
    return sum;
}

void ErrorBlocks::add(const WindowSamples& block, std::span<const PixelMoments> pixels) {
    const Window& place = block.window;
    const int samples = block.taken + block.samples.count;
    Block& its = blocks_[index(place.x / kSide, place.y / kSide)];
    its.samples = samples;
    its.squares = its.variance = 0;
    for (size_t i = 0; i < pixels.size(); ++i) {
        const int x = place.x + static_cast<int>(i) % place.width, y = place.y + static_cast<int>(i) / place.width;
        PixelMoments& pixel = pixels_[static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x)];
        pixel += pixels[i];
        if (samples < 2) continue;
        if (goal_.unit == Unit::Displayed) {
            const double deviation = std::sqrt(pixel.variance(samples)), of_halves = displayed_square(pixel, samples);
            const double of_squares = 3.0 * displayed_square(pixel.brightness(samples) / 3.0, deviation / 3.0);
            its.squares += of_halves;
            its.variance += samples * std::lerp(of_squares, of_halves, kHalves);
        } else {
            const double noise = pixel.noise(samples);
            its.squares += noise * noise;
            its.variance += samples * noise * noise;
        }
    }
}

void ErrorBlocks::add_rays(std::span<const WindowSamples> blocks, uint64_t rays) {
    Cost& cost = costs_[group(blocks.front().window.x, blocks.front().window.y)];
    cost.rays += rays;
    for (const WindowSamples& each : blocks) cost.samples += each.paths();
}

double ErrorBlocks::numbers_of_all() const {
    if (goal_.unit == Unit::Displayed) return 3.0 * width_ * height_;
    double noisy = 0;
    for (size_t i = 0; i < blocks_.size(); ++i)
        if (blocks_[i].squares > kCalm * kCalm * goal_.most * goal_.most * pixels(i)) noisy += pixels(i);
    return noisy;
}

double ErrorBlocks::squares_of_all() const {
    double sum = 0;
    for (const Block& block : blocks_) sum += block.squares;
    return sum;
}

/// What all squares may add up to: less where few blocks make most of them, whose sum is not known well.
double ErrorBlocks::room() const {
    const double most = goal_.most * goal_.most * numbers_of_all();
    if (goal_.unit != Unit::Displayed) return most;
    double sum = 0, squares = 0;
    for (const Block& block : blocks_) {
        sum += block.squares;
        squares += block.squares * block.squares;
    }
    return kAim * kAim * most / (1.0 + (sum > 0.0 ? kDeviations * std::sqrt(squares) / sum : 0.0));
}

/// The deviation of a single sample in each block over the root of what one costs.
std::vector<double> ErrorBlocks::worths() const {
    std::vector<double> found(blocks_.size());
    for (size_t i = 0; i < blocks_.size(); ++i) {
        const int x = static_cast<int>(i) % columns_, y = static_cast<int>(i) / columns_;
        double variance = 0, count = 0;
        for (int row = std::max(y - 1, 0); row <= std::min(y + 1, rows_ - 1); ++row)
            for (int column = std::max(x - 1, 0); column <= std::min(x + 1, columns_ - 1); ++column) {
                const size_t other = index(column, row);
                variance += blocks_[other].variance;
                count += pixels(other);
            }
        const double mixed = std::lerp(blocks_[i].variance / pixels(i), variance / count, kNeighbors);
        found[i] = std::sqrt(mixed / costs_[group(x * kSide, y * kSide)].of_sample());
    }
    return found;
}

/// How many samples there must be, so that all squares add up to `room`.
double ErrorBlocks::samples_per_worth(std::span<const double> worths, double room) const {
    const auto squares_at = [&](double factor) {
        double sum = 0;
        for (size_t i = 0; i < blocks_.size(); ++i) {
            const double has = blocks_[i].samples;
            sum += blocks_[i].squares * has / std::max(has, worths[i] * factor);
        }
        return sum;
    };
    constexpr int kSteps = 50;
    double low = 0, high = 60;  // powers of two
    for (int step = 0; step < kSteps; ++step) {
        const double middle = (low + high) / 2;
        (squares_at(std::exp2(middle)) > room ? low : high) = middle;
    }
    return std::exp2(high);
}

void ErrorBlocks::decide() {
    const double room = this->room();
    const bool is_reached = squares_of_all() <= room;
    const std::vector<double> found = is_reached ? std::vector<double>(blocks_.size()) : worths();
    const double factor = is_reached ? 0.0 : samples_per_worth(found, room);
    for (size_t i = 0; i < blocks_.size(); ++i)
        blocks_[i].needed = std::max<double>(goal_.least_samples, found[i] * factor);
}

double ErrorBlocks::error() const {
    return std::sqrt(squares_of_all() / std::max(numbers_of_all(), 1.0));
}

size_t ErrorBlocks::bytes() const {
    return pixels_.capacity() * sizeof(PixelMoments) + blocks_.capacity() * sizeof(Block) +
           costs_.capacity() * sizeof(Cost);
}

}  // namespace rayleaf
