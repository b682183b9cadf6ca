#include "film/error_blocks.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>

namespace rayleaf {
namespace {

using Unit = ErrorGoal::Unit;

/// What is aimed at, as a share of a target error: an estimate is no bound, and misses what is bright and rare.
constexpr double kAim = 0.95;
/// Standard deviations of the estimate that are kept free beside that.
constexpr double kDeviations = 3;
/// What is taken for p at most. What falls faster does so at first, until what is random in every sample makes most of
/// the error.
constexpr double kMostPower = 1.3;
/// From here on, p makes a difference to numbers of samples: below, they are hardly better than random ones.
constexpr double kEvenPower = 1.1;
/// How much of a block's deviation the blocks around it tell. More blurs the borders of what is noisy.
constexpr double kNeighbors = 0.3;
/// And its changes, beside a target error: squares do not see how evenly samples are spread.
constexpr double kChanges = 0.2;
/// What is rendered together has as many paths at least: streams are full, and what is made for each part is worth it.
constexpr uint64_t kPathsOfPart = 4096;
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

/// Square of what the mean of random samples is off by, of which the squares add up to `squares`.
double square_of_mean(double squares, double square_of_sum, int samples) {
    const double n = samples;
    return std::max(squares - square_of_sum / n, 0.0) / (n - 1.0) / n;
}

/// Of two that is nearest to `number`, a positive one.
int nearest_power(double number) {
    return std::ilogb(number * std::numbers::sqrt2);
}

/// Of what a doubling of samples changed a mean colour by.
double squares_of_change(const Vec3d& before, const Vec3d& now) {
    double squares = 0;
    for (int c = 0; c < 3; ++c) squares += displayed_square(now[c], std::abs(now[c] - before[c]));
    return squares;
}

}  // namespace

void PixelMoments::add(const PixelSample& sample, int number) {
    constexpr double kLargest = 1e30;  // sums of squares stay finite
    // What shadow catchers scatter is no part of Combined until their shadow is, but is as noisy.
    const Vec4f shown = sample[Pass::combined] + sample[Pass::shadow_catcher];
    Vec3d finite(0, 0, 0);
    for (int c = 0; c < 3; ++c)
        if (!std::isnan(shown[c])) finite[c] = std::clamp(double{shown[c]}, -kLargest, kLargest);
    color += finite;
    if (number < 2) first_two += finite;
    if (number < 1) first = finite;
    const double sum = finite.x + finite.y + finite.z;
    squares_of_brightness += sum * sum;
    squares_of_channels += finite.length2();
}

double ErrorBlocks::Pixel::displayed_squares(int samples) const {
    const double deviation = std::sqrt(square_of_mean(squares, color.length2(), samples) / 3.0);
    double sum = 0;
    for (int c = 0; c < 3; ++c) sum += displayed_square(color[c] / samples, deviation);
    return sum;
}

double ErrorBlocks::Pixel::noise_square(int samples) const {
    constexpr double kDark = 1e-4;  // below, a pixel is taken to be black, as Cycles takes it
    const double sum = color.x + color.y + color.z, scale = kDark + std::sqrt(std::abs(sum / samples));
    return square_of_mean(squares, sum * sum, samples) / (scale * scale);
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
      costs_(static_cast<size_t>(group_columns_) * static_cast<size_t>(blocks_in(height, kGroup))),
      power_(goal.unit == Unit::Displayed ? kMostPower : 1.0) {
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

/// Samples that a block is to have after the next round: not beyond a power of two, where a doubling is judged.
int ErrorBlocks::wanted(const Block& block, int most) const {
    const int needed = static_cast<int>(std::ceil(std::min<double>(block.needed, most)));
    const int doubled = static_cast<int>(std::bit_floor(static_cast<unsigned>(block.samples))) * 2;
    const int first = goal_.unit == Unit::Displayed ? kFirstRound : goal_.least_samples;
    return std::min({needed, most, std::max(doubled, first)});
}

std::vector<std::vector<WindowSamples>> ErrorBlocks::next(int most) const {
    std::vector<std::vector<WindowSamples>> found(costs_.size());
    for (size_t i = 0; i < blocks_.size(); ++i) {
        const int has = blocks_[i].samples, count = wanted(blocks_[i], most) - has;
        const Window place = window(i);
        if (count > 0) found[group(place.x, place.y)].push_back({place, {has, count}, has});
    }
    std::vector<std::vector<WindowSamples>> parts;
    uint64_t paths = 0;  // of the last part
    for (const std::vector<WindowSamples>& each : found) {
        if (each.empty()) continue;
        if (parts.empty() || paths >= kPathsOfPart) {
            parts.emplace_back();
            paths = 0;
        }
        for (const WindowSamples& block : each) paths += block.paths();
        parts.back().insert(parts.back().end(), each.begin(), each.end());
    }
    return parts;
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
    const bool displayed = goal_.unit == Unit::Displayed;
    Block& its = blocks_[index(place.x / kSide, place.y / kSide)];
    its.samples = samples;
    its.variance = 0;
    for (size_t i = 0; i < pixels.size(); ++i) {
        Pixel& pixel = pixel_of(place, i);
        pixel.color += pixels[i].color;
        pixel.squares += displayed ? pixels[i].squares_of_channels : pixels[i].squares_of_brightness;
        if (samples < 2) continue;
        its.variance += samples * (displayed ? pixel.displayed_squares(samples) : pixel.noise_square(samples));
    }
    if (displayed && samples >= kFirstRound && std::has_single_bit(static_cast<unsigned>(samples)))
        add_changes(its, place, pixels);
}

/// After a doubling by these, or the first round, which is two doublings.
void ErrorBlocks::add_changes(Block& block, const Window& place, std::span<const PixelMoments> added) {
    const bool is_first = block.samples == kFirstRound;
    block.doubled = block.samples;
    block.random = block.variance / block.samples;
    block.change_before = is_first ? 0 : block.change;
    block.change = 0;
    for (size_t i = 0; i < added.size(); ++i) {
        Pixel& pixel = pixel_of(place, i);
        const Vec3d now = pixel.color / block.samples;
        const Vec3d before = is_first ? added[i].first_two / 2.0 : Vec3d(pixel.before);
        if (is_first) block.change_before += squares_of_change(added[i].first, before);
        block.change += squares_of_change(before, now);
        pixel.before = Vec3f(now);
    }
}

void ErrorBlocks::add_rays(const WindowSamples& block, uint64_t rays) {
    Cost& cost = costs_[group(block.window.x, block.window.y)];
    cost.rays += rays;
    cost.samples += block.paths();
}

double ErrorBlocks::numbers_of_all() const {
    if (goal_.unit == Unit::Displayed) return 3.0 * width_ * height_;
    double noisy = 0;
    for (size_t i = 0; i < blocks_.size(); ++i)
        if (squares(blocks_[i]) > kCalm * kCalm * goal_.most * goal_.most * pixels(i)) noisy += pixels(i);
    return noisy;
}

bool ErrorBlocks::is_even() const {
    return power_ > kEvenPower;
}

/// What a block would be off by after one sample, by what it is off by now.
double ErrorBlocks::squares_of_one(const Block& block) const {
    if (!is_even() || block.doubled == 0) return against_random_ * block.variance;
    return block.change * std::pow(block.doubled, power_) / (std::exp2(power_) - 1.0);
}

/// What a block is off by with the samples that it has.
double ErrorBlocks::squares(const Block& block) const {
    return squares_of_one(block) *
           (is_even() && block.doubled > 0 ? std::pow(block.samples, -power_) : 1.0 / block.samples);
}

double ErrorBlocks::squares_of_all() const {
    double sum = 0;
    for (const Block& block : blocks_) sum += squares(block);
    return sum;
}

/// What all squares may add up to: less where few blocks make most of them, whose sum is not known well.
double ErrorBlocks::room() const {
    const double most = goal_.most * goal_.most * numbers_of_all();
    if (goal_.unit != Unit::Displayed) return most;
    double sum = 0, sum_of_squares = 0;
    for (const Block& block : blocks_) {
        const double square = squares(block);
        sum += square;
        sum_of_squares += square * square;
    }
    return kAim * kAim * most / (1.0 + (sum > 0.0 ? kDeviations * std::sqrt(sum_of_squares) / sum : 0.0));
}

/// What the last two doublings of each block tell of samples that are spread evenly.
void ErrorBlocks::judge_doublings() {
    double now = 0, before = 0, random = 0;
    for (const Block& block : blocks_) {
        now += block.change;
        before += block.change_before;
        random += block.random;
    }
    if (now == 0.0 || random == 0.0) return;
    power_ = std::clamp(std::log2(before / now), 1.0, power_);
    against_random_ = now / (std::exp2(power_) - 1.0) / random;
}

/// Of each block in proportion to what number of samples makes the best of those of all.
std::vector<double> ErrorBlocks::worths() const {
    std::vector<double> found(blocks_.size()), variances(blocks_.size());
    for (size_t i = 0; i < blocks_.size(); ++i) {
        const Block& block = blocks_[i];
        variances[i] = is_even() ? std::lerp(block.variance, squares_of_one(block), kChanges) : block.variance;
    }
    for (size_t i = 0; i < blocks_.size(); ++i) {
        const int x = static_cast<int>(i) % columns_, y = static_cast<int>(i) / columns_;
        double variance = 0, count = 0;
        for (int row = std::max(y - 1, 0); row <= std::min(y + 1, rows_ - 1); ++row)
            for (int column = std::max(x - 1, 0); column <= std::min(x + 1, columns_ - 1); ++column) {
                const size_t other = index(column, row);
                variance += variances[other];
                count += pixels(other);
            }
        const double mixed = std::lerp(variances[i] / pixels(i), variance / count, kNeighbors);
        found[i] = std::pow(mixed / costs_[group(x * kSide, y * kSide)].of_sample(), 1.0 / (1.0 + power_));
    }
    return found;
}

/// The number of samples that is asked for in place of one that were best: a power of two where that matters.
double ErrorBlocks::whole(double samples) const {
    return is_even() && samples >= 1.0 ? std::ldexp(1.0, nearest_power(samples)) : samples;
}

/// How many samples there must be, so that all squares add up to `room`.
double ErrorBlocks::samples_per_worth(std::span<const double> worths, double room) const {
    std::vector<double> now(blocks_.size()), of_one(blocks_.size());
    for (size_t i = 0; i < blocks_.size(); ++i) {
        now[i] = squares(blocks_[i]);
        of_one[i] = squares_of_one(blocks_[i]);
    }
    constexpr int kMostDoublings = 60;
    std::array<double, kMostDoublings + 1> falls;  // what is left after so many doublings
    for (size_t k = 0; k < falls.size(); ++k) falls[k] = std::exp2(-power_ * static_cast<double>(k));
    const auto squares_at = [&](double factor) {
        double sum = 0;
        for (size_t i = 0; i < blocks_.size(); ++i) {
            const double samples = worths[i] * factor;
            if (whole(samples) <= blocks_[i].samples)
                sum += now[i];
            else
                sum += of_one[i] * (is_even()
                                        ? falls[static_cast<size_t>(std::min(nearest_power(samples), kMostDoublings))]
                                        : 1.0 / samples);
        }
        return sum;
    };
    constexpr int kSteps = 16;  // the factor is known to a thousandth
    double low = 0, high = kMostDoublings;
    for (int step = 0; step < kSteps; ++step) {
        const double middle = (low + high) / 2;
        (squares_at(std::exp2(middle)) > room ? low : high) = middle;
    }
    return std::exp2(high);
}

void ErrorBlocks::decide() {
    judge_doublings();
    const double room = this->room();
    const bool is_reached = squares_of_all() <= room;
    const std::vector<double> found = is_reached ? std::vector<double>(blocks_.size()) : worths();
    const double factor = is_reached ? 0.0 : samples_per_worth(found, room);
    for (size_t i = 0; i < blocks_.size(); ++i)
        blocks_[i].needed = std::max<double>(goal_.least_samples, whole(found[i] * factor));
}

double ErrorBlocks::error() const {
    return std::sqrt(squares_of_all() / std::max(numbers_of_all(), 1.0));
}

size_t ErrorBlocks::bytes() const {
    return pixels_.capacity() * sizeof(Pixel) + blocks_.capacity() * sizeof(Block) + costs_.capacity() * sizeof(Cost);
}

}  // namespace rayleaf
