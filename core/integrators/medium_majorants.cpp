#include "integrators/medium_majorants.h"

namespace rayleaf {

Majorants::Majorants(const MediumSegment& segment) {
    const SceneMedia& media = segment.scene.media();
    for (const SceneMedium* medium : segment.media.all()) {
        if (medium->grid) {
            const Affine3d map = media.to_grid(*medium);
            lines_[count_++] = {medium->grid.get(), {map.point(segment.ray.origin), map.vector(segment.ray.direction)}};
            continue;
        }
        Closures closures;
        media.evaluate(*medium, segment.ray.origin, segment.outgoing(), segment.state, closures);
        even_ += max_component(closures.medium.extinction);
    }
}

MajorantStep Majorants::at(double t) const {
    MajorantStep sum{even_, std::numeric_limits<double>::infinity()};
    for (size_t i = 0; i < count_; ++i) {
        const MajorantStep own = lines_[i].grid->at(lines_[i].ray, t);
        sum.majorant += own.majorant;
        sum.end = std::min(sum.end, own.end);
    }
    return sum;
}

namespace {

/// The mean of the bound from `t` to an end that is finite.
double mean_majorant(const Majorants& majorants, double t, double end) {
    double sum = 0.0;
    for (double from = t; from < end;) {
        const MajorantStep step = majorants.at(from);
        const double to = step.end > from ? std::min(step.end, end) : end;
        if (step.majorant > 0.0f) sum += static_cast<double>(step.majorant) * (to - from);
        from = to;
    }
    return sum / (end - t);
}

}  // namespace

RoughDepth::RoughDepth(const Majorants& majorants, double end) : end_(end) {
    constexpr double kShareOfBound = 0.5;
    double t = 0.0;
    while (count_ < kMost && t < end) {
        const MajorantStep step = majorants.at(t);
        const bool is_last = count_ + 1 == kMost || !(step.end > t);
        const double border = is_last ? end : std::min(step.end, end);
        // The last piece stands for all that is left.
        const bool is_many = is_last && step.end < end && std::isfinite(end);
        const double majorant = is_many ? mean_majorant(majorants, t, end) : static_cast<double>(step.majorant);
        const double extinction = kShareOfBound * majorant;
        pieces_[count_++] = {t, extinction, depth_};
        if (extinction > 0.0) depth_ += extinction * (border - t);
        t = border;
    }
}

double RoughDepth::sample(float random) const {
    const double depth = -std::log1p(static_cast<double>(random) * std::expm1(-depth_));
    for (size_t i = count_; i-- > 0;)
        if (pieces_[i].extinction > 0.0 && depth >= pieces_[i].depth)
            return pieces_[i].begin + (depth - pieces_[i].depth) / pieces_[i].extinction;
    return end_;
}

double RoughDepth::density(double t) const {
    if (!(depth_ > 0.0)) return 0.0;
    for (size_t i = count_; i-- > 0;)
        if (t >= pieces_[i].begin)
            return pieces_[i].extinction *
                   std::exp(-pieces_[i].depth - pieces_[i].extinction * (t - pieces_[i].begin)) / -std::expm1(-depth_);
    return 0.0;
}

double RoughDepth::dimmed(double t, double /*beside*/) const {
    for (size_t i = count_; i-- > 0;)
        if (t >= pieces_[i].begin) return std::exp(-pieces_[i].depth - pieces_[i].extinction * (t - pieces_[i].begin));
    return 1.0;
}

}  // namespace rayleaf
