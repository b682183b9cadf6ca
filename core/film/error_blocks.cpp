#include "film/error_blocks.h"

#include "film/noise_blocks.h"

#include <algorithm>
#include <cmath>

namespace rayleaf {
namespace {

/// What is aimed at, as a share of the target: an estimate is no bound.
constexpr double kAim = 0.93;
/// No block is done before.
constexpr double kLeastOfBlock = 8;
/// A round makes of each sample that many at most, so that the next one can be judged by more of them.
constexpr double kMostGrowth = 1.5;

/// The next even number, or itself: the halves of a picture are alike.
int even(double number) {
    return static_cast<int>(std::ceil(number / 2.0)) * 2;
}

/// Expected square of what is displayed of a mean that is off by half of what its halves differ by, to either side.
double displayed_square(double mean, double one, double other) {
    const auto [low, high] = std::minmax({std::clamp(one, 0.0, 1.0), std::clamp(other, 0.0, 1.0)});
    const double shown = std::clamp(mean, 0.0, 1.0), above = high - shown, below = shown - low;
    return (above * above + below * below) / 2.0;
}

}  // namespace

void HalfSums::add(const PixelSample& sample, bool is_odd) {
    constexpr double kLargest = 1e30;  // sums stay finite
    // As in PixelMoments: with what shadow catchers scatter.
    const Vec4f color = sample[Pass::combined] + sample[Pass::shadow_catcher];
    Vec3d& half = is_odd ? odd : even;
    for (int c = 0; c < 3; ++c)
        if (!std::isnan(color[c])) half[c] += std::clamp(double{color[c]}, -kLargest, kLargest);
}

HalfSums& HalfSums::operator+=(const HalfSums& other) {
    even += other.even;
    odd += other.odd;
    return *this;
}

ErrorBlocks::ErrorBlocks(int width, int height, double target)
    : width_(width),
      height_(height),
      columns_((width + NoiseBlocks::kSide - 1) / NoiseBlocks::kSide),
      target_(target),
      sums_(static_cast<size_t>(width) * static_cast<size_t>(height)),
      blocks_(static_cast<size_t>(columns_) *
              static_cast<size_t>((height + NoiseBlocks::kSide - 1) / NoiseBlocks::kSide)) {
    for (Block& each : blocks_) each.needed = kLeastOfBlock;
}

Window ErrorBlocks::window(size_t index) const {
    constexpr int kSide = NoiseBlocks::kSide;
    const int x = static_cast<int>(index) % columns_ * kSide, y = static_cast<int>(index) / columns_ * kSide;
    return {x, y, std::min(kSide, width_ - x), std::min(kSide, height_ - y)};
}

/// Pixels times channels of a block.
double ErrorBlocks::numbers(size_t index) const {
    const Window place = window(index);
    return 3.0 * place.width * place.height;
}

std::vector<WindowSamples> ErrorBlocks::next(int most) const {
    std::vector<WindowSamples> found;
    for (size_t i = 0; i < blocks_.size(); ++i) {
        const int has = blocks_[i].samples, wants = even(std::min<double>(blocks_[i].needed, most));
        const int at_once = even(has == 0 ? kLeastOfBlock : std::max(kMostGrowth * has, has + 2.0));
        const int count = std::min({wants, at_once, most}) - has;
        if (count > 0) found.push_back({window(i), {has, count}, has});
    }
    return found;
}

double ErrorBlocks::samples_missing(int most) const {
    double sum = 0;
    for (size_t i = 0; i < blocks_.size(); ++i)
        sum += numbers(i) / 3.0 * std::max(std::min<double>(blocks_[i].needed, most) - blocks_[i].samples, 0.0);
    return sum;
}

void ErrorBlocks::add(const Window& block, std::span<const HalfSums> pixels, int samples, uint64_t rays) {
    constexpr int kSide = NoiseBlocks::kSide;
    Block& its = blocks_[index(block.x / kSide, block.y / kSide)];
    its.samples = samples;
    its.rays += rays;
    its.squares = 0;
    const double odd = samples / 2, even = samples - odd;  // NOLINT(bugprone-integer-division)
    for (size_t i = 0; i < pixels.size(); ++i) {
        const int x = block.x + static_cast<int>(i) % block.width, y = block.y + static_cast<int>(i) / block.width;
        HalfSums& pixel = sums_[static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x)];
        pixel += pixels[i];
        for (int c = 0; c < 3 && samples > 1; ++c)
            its.squares +=
                displayed_square((pixel.even[c] + pixel.odd[c]) / samples, pixel.even[c] / even, pixel.odd[c] / odd);
    }
}

double ErrorBlocks::squares_of_all() const {
    double sum = 0;
    for (const Block& block : blocks_) sum += block.squares;
    return sum;
}

/// The deviation of a single sample in each block, half told by the block, half by it and those around, over the root
/// of what one costs.
std::vector<double> ErrorBlocks::worths() const {
    const int rows = static_cast<int>(blocks_.size()) / columns_;
    std::vector<double> found(blocks_.size());
    for (size_t i = 0; i < blocks_.size(); ++i) {
        const int x = static_cast<int>(i) % columns_, y = static_cast<int>(i) / columns_;
        double variance = 0, count = 0;
        for (int row = std::max(y - 1, 0); row <= std::min(y + 1, rows - 1); ++row)
            for (int column = std::max(x - 1, 0); column <= std::min(x + 1, columns_ - 1); ++column) {
                const size_t other = index(column, row);
                variance += blocks_[other].variance();
                count += numbers(other);
            }
        const double cost = blocks_[i].cost(numbers(i) / 3.0) / numbers(i);
        found[i] = std::sqrt((blocks_[i].variance() / numbers(i) + variance / count) / 2.0 / cost);
    }
    return found;
}

/// How many samples there must be, so that all squares add up to `room`.
double ErrorBlocks::samples_per_worth(std::span<const double> worths, double room) const {
    const auto squares_at = [&](double factor) {
        double sum = 0;
        for (size_t i = 0; i < blocks_.size(); ++i)
            sum += blocks_[i].variance() / std::max<double>(blocks_[i].samples, worths[i] * factor);
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
    const double room = kAim * kAim * target_ * target_ * numbers_of_all();
    const bool is_reached = squares_of_all() <= room;
    const std::vector<double> found = is_reached ? std::vector<double>(blocks_.size()) : worths();
    const double factor = is_reached ? 0.0 : samples_per_worth(found, room);
    for (size_t i = 0; i < blocks_.size(); ++i) blocks_[i].needed = std::max(found[i] * factor, kLeastOfBlock);
}

double ErrorBlocks::error() const {
    return std::sqrt(squares_of_all() / numbers_of_all());
}

size_t ErrorBlocks::bytes() const {
    return sums_.capacity() * sizeof(HalfSums) + blocks_.capacity() * sizeof(Block);
}

}  // namespace rayleaf
