#include "film/film.h"

#include "film/shadow_catcher.h"

#include <algorithm>

namespace rayleaf {

Film::Film(int width, int height, std::vector<Pass> passes)
    : width_(width),
      height_(height),
      passes_(std::move(passes)),
      summed_(without_mattes(passes_)),
      mattes_(mattes_for(width, height, passes_)) {
    for (const Pass pass : summed_)
        data_[static_cast<size_t>(pass)].assign(
            static_cast<size_t>(width) * static_cast<size_t>(height) * info(pass).channels.size(), 0.0f);
}

template <typename Update>
void Film::update(Pass pass, const Window& tile, std::span<const PixelValues> values, const Update& update) {
    const size_t channels = info(pass).channels.size();
    for (int row = 0; row < tile.height; ++row) {
        float* out = at(pass, tile.x, tile.y + row);
        const PixelValues* in = &values[static_cast<size_t>(row) * static_cast<size_t>(tile.width)];
        for (int column = 0; column < tile.width; ++column) {
            const Vec4f& value = in[column][pass];
            for (size_t c = 0; c < channels; ++c) update(*out++, value[static_cast<int>(c)]);
        }
    }
}

void Film::put(const Window& tile, std::span<const PixelValues> values) {
    const std::scoped_lock lock(mutex_);
    for (const Pass pass : summed_) update(pass, tile, values, [](float& old, float value) { old = value; });
}

void Film::refine(const Window& tile, std::span<const PixelValues> values, float share) {
    const std::scoped_lock lock(mutex_);
    const auto add = [](float& old, float value) { old += value; };
    const auto approach = [share](float& old, float value) { old += (value - old) * share; };
    for (const Pass pass : summed_) {
        const PassRule by = rule(pass).rule;
        if (by == PassRule::Count) update(pass, tile, values, add);
        if (by != PassRule::Count && by != PassRule::FirstSample) update(pass, tile, values, approach);
    }
}

void Film::hold_means() {
    const std::scoped_lock lock(mutex_);
    holds_means_ = true;
}

std::vector<float> Film::finished(Pass pass) const {
    std::vector<float> values = data(pass);
    if (!holds_means_) return values;
    if (const PassRuleInfo info = rule(pass); info.rule == PassRule::Divided) {
        const std::vector<float>& color = data(info.color);
        for (size_t i = 0; i < values.size(); i += 3) {
            const Vec4f value =
                divided({values[i], values[i + 1], values[i + 2], 0}, {color[i], color[i + 1], color[i + 2], 0});
            std::copy_n(&value.x, 3, &values[i]);
        }
    }
    const size_t channels = rayleaf::info(pass).channels.size();
    if (const std::optional<size_t> share = share_of_light(pass))
        for (size_t i = *share; i < values.size(); i += channels) values[i] = std::clamp(values[i], 0.0f, 1.0f);
    return values;
}

void Film::add_mattes(const Window& tile, int samples, std::span<const PixelMattes> mattes) {
    const std::scoped_lock lock(mutex_);
    for (size_t i = 0; i < mattes.size(); ++i)
        mattes_->add(tile.x + static_cast<int>(i) % tile.width, tile.y + static_cast<int>(i) / tile.width, samples,
                     mattes[i]);
}

void Film::put_blocks(const Window& tile, std::span<const PixelValues> values, int size) {
    const std::scoped_lock lock(mutex_);
    for (size_t i = 0; i < values.size(); ++i) {
        const int left = (tile.x + static_cast<int>(i) % tile.width) * size;
        const int low = (tile.y + static_cast<int>(i) / tile.width) * size;
        const int right = std::min(left + size, width_), high = std::min(low + size, height_);
        for (const Pass pass : summed_) {
            const Vec4f& value = values[i][pass];
            const size_t channels = info(pass).channels.size();
            for (int row = low; row < high; ++row) {
                float* out = at(pass, left, row);
                for (int column = left; column < right; ++column)
                    for (size_t c = 0; c < channels; ++c) *out++ = value[static_cast<int>(c)];
            }
        }
    }
}

std::vector<float> Film::pixels(Pass pass) const {
    const std::scoped_lock lock(mutex_);
    if (is_matte(pass)) return has(pass) ? mattes_->pixels(pass) : std::vector<float>();
    if (pass == Pass::shadow_catcher && has(pass)) return caught_share();
    if (pass == Pass::combined && has(pass) && has(Pass::footage))
        return with_shadow(finished(pass), caught_share(), data(Pass::footage));
    return finished(pass);
}

std::vector<float> Film::caught_share() const {
    return shadow_share(data(Pass::shadow_catcher), data(Pass::footage_light));
}

bool Film::has(Pass pass) const {
    return is_matte(pass) ? mattes_ && mattes_->has(matte_kind(pass)) : !data_[static_cast<size_t>(pass)].empty();
}

size_t Film::bytes() const {
    const std::scoped_lock lock(mutex_);
    size_t sum = mattes_ ? mattes_->bytes() : 0;
    for (const std::vector<float>& data : data_) sum += data.size() * sizeof(float);
    return sum;
}

}  // namespace rayleaf
