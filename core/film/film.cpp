#include "film/film.h"

namespace rayleaf {

Film::Film(int width, int height, std::vector<Pass> passes)
    : width_(width), height_(height), passes_(std::move(passes)) {
    for (const Pass pass : passes_)
        data_[static_cast<size_t>(pass)].assign(
            static_cast<size_t>(width) * static_cast<size_t>(height) * info(pass).channels.size(), 0.0f);
}

void Film::put(int x, int y, int width, int height, std::span<const PixelValues> values) {
    const std::scoped_lock lock(mutex_);
    for (const Pass pass : passes_) {
        std::vector<float>& data = data_[static_cast<size_t>(pass)];
        const size_t channels = info(pass).channels.size();
        for (int row = 0; row < height; ++row) {
            float* out =
                &data[(static_cast<size_t>(y + row) * static_cast<size_t>(width_) + static_cast<size_t>(x)) * channels];
            for (int column = 0; column < width; ++column) {
                const size_t pixel =
                    static_cast<size_t>(row) * static_cast<size_t>(width) + static_cast<size_t>(column);
                const Vec4f& value = values[pixel][static_cast<size_t>(pass)];
                for (size_t c = 0; c < channels; ++c) *out++ = value[static_cast<int>(c)];
            }
        }
    }
}

std::vector<float> Film::pixels(Pass pass) const {
    const std::scoped_lock lock(mutex_);
    return data_[static_cast<size_t>(pass)];
}

size_t Film::bytes() const {
    size_t sum = 0;
    for (const std::vector<float>& data : data_) sum += data.size() * sizeof(float);
    return sum;
}

}  // namespace rayleaf
