#include "film/film_sums.h"

#include "film/shadow_catcher.h"

#include <algorithm>

namespace rayleaf {

FilmSums::FilmSums(int width, int height, std::vector<Pass> passes)
    : width_(width),
      height_(height),
      passes_(std::move(passes)),
      summed_(without_mattes(passes_)),
      mattes_(mattes_for(width, height, passes_)) {
    samples_.assign(static_cast<size_t>(width) * static_cast<size_t>(height), 0);
    for (const Pass pass : summed_)
        terms_[static_cast<size_t>(pass)].emplace_back(samples_.size() * info(pass).channels.size(), 0.0);
}

bool FilmSums::has(Pass pass) const {
    return std::find(passes_.begin(), passes_.end(), pass) != passes_.end();
}

size_t FilmSums::bytes() const {
    size_t numbers = 0;
    for (const auto& terms : terms_)
        for (const std::vector<double>& term : terms) numbers += term.size();
    return numbers * sizeof(double) + samples_.size() * sizeof(int) + (mattes_ ? mattes_->bytes() : 0);
}

void FilmSums::add(int x, int y, int samples, PixelSums& sums) {
    const std::scoped_lock lock(mutex_);
    const size_t place = pixel(x, y);
    for (const Pass pass : summed_) {
        if (samples_[place] > 0) add_terms(place, pass, sums);
        keep_terms(place, pass, sums);
    }
    samples_[place] += samples;
}

void FilmSums::add_mattes(int x, int y, int samples, const PixelMattes& mattes) {
    const std::scoped_lock lock(mutex_);
    mattes_->add(x, y, samples, mattes);
}

/// Adds the terms of a pixel to `sums`.
void FilmSums::add_terms(size_t pixel, Pass pass, PixelSums& sums) const {
    const size_t channels = info(pass).channels.size();
    for (const std::vector<double>& term : terms(pass))
        for (size_t c = 0; c < channels; ++c) sums.of(pass).add_term(c, term[pixel * channels + c]);
}

void FilmSums::keep_terms(size_t pixel, Pass pass, PixelSums& sums) {
    const size_t channels = info(pass).channels.size();
    std::vector<std::vector<double>>& kept = terms_[static_cast<size_t>(pass)];
    for (size_t c = 0; c < channels; ++c) {
        const ExactSums::Terms found = sums.of(pass).terms(c);
        for (size_t i = 0; i < found.size(); ++i) {
            if (i == kept.size() && found[i] != 0.0) kept.emplace_back(kept.front().size(), 0.0);
            if (i < kept.size()) kept[i][pixel * channels + c] = found[i];
        }
    }
}

int FilmSums::least_samples() const {
    return *std::min_element(samples_.begin(), samples_.end());
}

int FilmSums::most_samples() const {
    return *std::max_element(samples_.begin(), samples_.end());
}

std::vector<float> FilmSums::pixels(Pass pass) const {
    if (is_matte(pass)) return mattes_->pixels(pass);
    const auto share = [this] { return shadow_share(means(Pass::shadow_catcher), means(Pass::footage_light)); };
    if (pass == Pass::shadow_catcher) return share();
    if (pass == Pass::combined && has(Pass::footage)) return with_shadow(means(pass), share(), means(Pass::footage));
    return means(pass);
}

/// Of sums, divided as the pass's rule says.
std::vector<float> FilmSums::means(Pass pass) const {
    const std::vector<Pass> needed = computed_passes({pass});
    const size_t channels = info(pass).channels.size();
    std::vector<float> pixels;
    pixels.reserve(samples_.size() * channels);
    PixelSums sums;
    for (size_t place = 0; place < samples_.size(); ++place) {
        sums.clear(needed);
        for (const Pass each : needed)
            if (has(each)) add_terms(place, each, sums);
        const PixelValues values = sums.values(needed, samples_[place]);
        for (size_t c = 0; c < channels; ++c) pixels.push_back(values[pass][static_cast<int>(c)]);
    }
    return pixels;
}

}  // namespace rayleaf
