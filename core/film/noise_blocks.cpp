#include "film/noise_blocks.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace rayleaf {

void PixelMoments::add(const PixelSample& sample) {
    // What shadow catchers scatter is no part of Combined until their shadow is, but is as noisy.
    const Vec4f color = sample[Pass::combined] + sample[Pass::shadow_catcher];
    // Sums of squares stay finite; such a pixel is noisy anyway.
    constexpr double kLargest = 1e30;
    const double brightness = std::clamp(double{color.x} + double{color.y} + double{color.z}, -kLargest, kLargest);
    if (std::isnan(brightness)) return;
    sum += brightness;
    squares += brightness * brightness;
}

PixelMoments& PixelMoments::operator+=(const PixelMoments& other) {
    sum += other.sum;
    squares += other.squares;
    return *this;
}

double PixelMoments::noise(int samples) const {
    const double n = samples, mean = sum / n;
    const double variance = std::max(squares - n * mean * mean, 0.0) / (n - 1.0) / n;
    constexpr double kDark = 1e-4;  // below, a pixel is taken to be black, as Cycles takes it
    return std::sqrt(variance) / (kDark + std::sqrt(std::abs(mean)));
}

NoiseBlocks::NoiseBlocks(int width, int height, double threshold, int least_samples)
    : width_(width),
      height_(height),
      columns_((width + kSide - 1) / kSide),
      threshold_(threshold),
      least_samples_(std::max(least_samples, 2)),
      moments_(static_cast<size_t>(width) * static_cast<size_t>(height)),
      noisy_(static_cast<size_t>(columns_) * static_cast<size_t>((height + kSide - 1) / kSide), 1) {}

NoiseBlocks::Block NoiseBlocks::block(size_t index) const {
    const int x = static_cast<int>(index) % columns_ * kSide, y = static_cast<int>(index) / columns_ * kSide;
    return {x, y, std::min(kSide, width_ - x), std::min(kSide, height_ - y)};
}

std::vector<NoiseBlocks::Block> NoiseBlocks::noisy() const {
    std::vector<Block> blocks;
    for (size_t i = 0; i < noisy_.size(); ++i)
        if (noisy_[i] != 0) blocks.push_back(block(i));
    return blocks;
}

size_t NoiseBlocks::noisy_pixels() const {
    const std::vector<Block> blocks = noisy();
    return std::accumulate(blocks.begin(), blocks.end(), size_t{0}, [](size_t sum, const Block& each) {
        return sum + static_cast<size_t>(each.width) * static_cast<size_t>(each.height);
    });
}

void NoiseBlocks::add(const Block& block, std::span<const PixelMoments> moments, int samples) {
    double squares = 0;
    for (size_t i = 0; i < moments.size(); ++i) {
        const int x = block.x + static_cast<int>(i) % block.width, y = block.y + static_cast<int>(i) / block.width;
        PixelMoments& pixel = moments_[static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x)];
        pixel += moments[i];
        if (samples < 2) continue;
        const double noise = pixel.noise(samples);
        squares += noise * noise;
    }
    const bool is_done =
        samples >= least_samples_ && squares < threshold_ * threshold_ * static_cast<double>(moments.size());
    if (is_done) noisy_[static_cast<size_t>(block.y / kSide * columns_ + block.x / kSide)] = 0;
}

size_t NoiseBlocks::bytes() const {
    return moments_.capacity() * sizeof(PixelMoments) + noisy_.capacity();
}

}  // namespace rayleaf
