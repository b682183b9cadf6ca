#include "textures/mip_level.h"

#include <algorithm>

#include <oneapi/tbb/parallel_for.h>

namespace rayleaf {
namespace {

/// The finer level's pixels that one pixel covers along a side, and how much each counts.
struct Covered {
    static constexpr int kMost = 3;
    int first = 0, count = 0;
    float share[kMost] = {};
};

Covered covered(int pixel, int finer, int coarser) {
    Covered result;
    // In units of 1 / coarser finer pixels, where all borders are integers.
    const int64_t begin = int64_t{pixel} * finer, end = begin + finer;
    result.first = static_cast<int>(begin / coarser);
    for (int64_t i = result.first; i * coarser < end; ++i) {
        const int64_t length = std::min((i + 1) * coarser, end) - std::max(i * coarser, begin);
        result.share[result.count++] = static_cast<float>(length) / static_cast<float>(finer);
    }
    return result;
}

/// Zeros, part by part: of a large picture they take longer than a cancelled render may.
void make_room(std::vector<float>& pixels, size_t count, const CancelToken& cancel) {
    constexpr size_t kPart = size_t{1} << 20;
    pixels.reserve(count);
    while (pixels.size() < count) {
        cancel.throw_if_cancelled();
        pixels.resize(std::min(count, pixels.size() + kPart));
    }
}

}  // namespace

Picture coarser_level(const Picture& level, const CancelToken& cancel) {
    Picture result;
    result.width = std::max(level.width / 2, 1);
    result.height = std::max(level.height / 2, 1);
    result.channels = level.channels;
    result.alpha = level.alpha;
    result.precise = level.precise;
    const auto channels = static_cast<size_t>(level.channels);
    const size_t row = static_cast<size_t>(level.width) * channels;
    const size_t coarser_row = static_cast<size_t>(result.width) * channels;
    make_room(result.pixels, coarser_row * static_cast<size_t>(result.height), cancel);
    tbb::parallel_for(0, result.height, [&](int y) {
        cancel.throw_if_cancelled();
        const Covered down = covered(y, level.height, result.height);
        float* pixel = &result.pixels[static_cast<size_t>(y) * coarser_row];
        for (int x = 0; x < result.width; ++x, pixel += channels) {
            const Covered across = covered(x, level.width, result.width);
            for (int j = 0; j < down.count; ++j) {
                const float* from = &level.pixels[static_cast<size_t>(down.first + j) * row +
                                                  static_cast<size_t>(across.first) * channels];
                for (int i = 0; i < across.count; ++i, from += channels)
                    for (size_t c = 0; c < channels; ++c) pixel[c] += down.share[j] * across.share[i] * from[c];
            }
        }
    });
    return result;
}

}  // namespace rayleaf
