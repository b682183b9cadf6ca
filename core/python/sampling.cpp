#include "base/sample_pairs.h"
#include "film/pixel_filter.h"
#include "python/arrays.h"
#include "python/bindings.h"

namespace rayleaf {
namespace {

/// The pairs of samples `first` to `end`.
std::vector<Vec2f> pairs_of(uint32_t pixel, uint32_t first, uint32_t end, uint32_t dimension, uint32_t seed) {
    SamplePairs pairs;
    for (uint32_t s = first; s < end; ++s) pairs.add(Sampler(pixel, s, seed), dimension);
    pairs.compute();
    std::vector<Vec2f> result;
    for (size_t i = 0; i < pairs.count; ++i) result.push_back(pairs.pair(i));
    return result;
}

py::array_t<float> sampler_pairs(uint32_t pixel, uint32_t samples, uint32_t dimension, uint32_t seed,
                                 uint32_t together) {
    if (together < 1 || together > SamplePairs::kMost)
        throw InputError("sampler", "together", std::to_string(together), "1 to " + std::to_string(SamplePairs::kMost));
    py::array_t<float> pairs({static_cast<py::ssize_t>(samples), py::ssize_t{2}});
    auto out = pairs.mutable_unchecked<2>();
    for (uint32_t s = 0; s < samples; s += together) {
        const uint32_t end = std::min(samples, s + together);
        const std::vector<Vec2f> found = together == 1 ? std::vector{Sampler(pixel, s, seed).get2(dimension)}
                                                       : pairs_of(pixel, s, end, dimension, seed);
        for (uint32_t i = s; i < end; ++i) {
            out(i, 0) = found[i - s].x;
            out(i, 1) = found[i - s].y;
        }
    }
    return pairs;
}

py::array_t<double> filter_offsets(PixelFilterKind kind, float width, const Array<float>& random) {
    check_shape("filter", "random", random, {-1, 2});
    for (const float number : span_of(random))
        if (!(number >= 0.0f && number < 1.0f))
            throw InputError("filter", "random", number_text(number), "numbers from 0 to less than 1");
    const PixelFilter filter(kind, width);
    py::array_t<double> offsets({random.shape(0), py::ssize_t{2}});
    auto out = offsets.mutable_unchecked<2>();
    for (py::ssize_t i = 0; i < random.shape(0); ++i) {
        const Vec2d offset = filter.offset(Vec2f(random.data()[2 * i], random.data()[2 * i + 1]));
        out(i, 0) = offset.x;
        out(i, 1) = offset.y;
    }
    return offsets;
}

}  // namespace

void bind_sampling(py::module_& module) {
    using namespace py::literals;
    py::enum_<PixelFilterKind>(module, "PixelFilterKind", "Shapes of the pixel filter.")
        .value("BOX", PixelFilterKind::Box)
        .value("GAUSSIAN", PixelFilterKind::Gaussian)
        .value("BLACKMAN_HARRIS", PixelFilterKind::BlackmanHarris);
    module.def(
        "sampler_pairs", &sampler_pairs, "pixel"_a, "samples"_a, "dimension"_a, "seed"_a = 0, "together"_a = 1,
        "The renderer's random numbers for samples 0..n-1 of a pixel in one dimension: (n, 2) in [0, 1); so many "
        "are computed together, they are the same.");
    module.def(
        "filter_offsets", &filter_offsets, "kind"_a, "width"_a, "random"_a,
        "Where the pixel filter puts samples: offsets (n, 2) from the pixel's centre for random numbers (n, 2).");
}

}  // namespace rayleaf
