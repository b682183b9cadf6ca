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

/// One row of a coarser level.
template <size_t kChannels>
void set_row(const Picture& level, const Covered& down, const std::vector<Covered>& across, float* pixel) {
    const size_t row = level.row();
    for (const Covered& over : across) {
        float sums[kChannels] = {};
        for (int j = 0; j < down.count; ++j) {
            const float* from =
                &level.pixels[static_cast<size_t>(down.first + j) * row + static_cast<size_t>(over.first) * kChannels];
            for (int i = 0; i < over.count; ++i, from += kChannels) {
                const float share = down.share[j] * over.share[i];
                for (size_t c = 0; c < kChannels; ++c) sums[c] += share * from[c];
            }
        }
        pixel = std::copy_n(sums, kChannels, pixel);
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
    make_room(result.pixels, result.count(), cancel);
    std::vector<Covered> across(static_cast<size_t>(result.width));
    for (int x = 0; x < result.width; ++x) across[static_cast<size_t>(x)] = covered(x, level.width, result.width);
    const auto set = level.channels == 1 ? set_row<1> : level.channels == 3 ? set_row<3> : set_row<4>;
    tbb::parallel_for(0, result.height, [&](int y) {
        cancel.throw_if_cancelled();
        set(level, covered(y, level.height, result.height), across,
            &result.pixels[static_cast<size_t>(y) * result.row()]);
    });
    return result;
}

}  // namespace rayleaf
