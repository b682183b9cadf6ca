#include "integrators/medium_majorants.h"

#include <algorithm>

namespace rayleaf {

BoundWalk::BoundWalk(const MediumSegment& segment) {
    const BoundDetail detail = segment.state.depth == 0 ? BoundDetail::Pieces : BoundDetail::Cells;
    const SceneMedia& media = segment.scene.media();
    for (const SceneMedium* medium : segment.media.all()) {
        if (medium->grid) {
            const Affine3d map = media.to_grid(*medium);
            const GridLine line(map.point(segment.ray.origin), map.vector(segment.ray.direction));
            walks_[count_++].emplace(*medium->grid, line, detail);
            continue;
        }
        Closures closures;
        media.evaluate(*medium, segment.ray.origin, segment.outgoing(), segment.state, closures);
        even_.majorant += max_component(closures.medium.extinction);
        even_.limit = even_.majorant;
        even_.mean += closures.medium.extinction;
        const Color& extinction = closures.medium.extinction;
        if (closures.medium.scatters()) even_.certain += std::min({extinction.x, extinction.y, extinction.z});
    }
    is_alone_ = count_ == 1 && segment.media.all().size() == 1;
    add_up();
}

void BoundWalk::advance() {
    for (size_t i = 0; i < count_; ++i)
        if (walks_[i]->end() <= end_) walks_[i]->advance();
    add_up();
}

void BoundWalk::add_up() {
    if (is_alone_) {
        end_ = walks_[0]->end();
        return;
    }
    bounds_ = even_;
    end_ = std::numeric_limits<double>::infinity();
    for (size_t i = 0; i < count_; ++i) {
        bounds_ += walks_[i]->bounds();
        end_ = std::min(end_, walks_[i]->end());
    }
}

SegmentBounds::SegmentBounds(const MediumSegment& segment) : end_(segment.end) {
    BoundWalk walk(segment);
    for (double t = 0.0; t < end_; walk.advance()) {
        const double border = std::min(walk.end(), end_);
        append(walk.bounds(), t, border);
        t = border;
    }
}

void SegmentBounds::append(const DensityBounds& bounds, double begin, double end) {
    // Where a cell's mean overlooks what it holds.
    constexpr float kLeastOfMajorant = 0.1f;
    const float mean = (bounds.mean.x + bounds.mean.y + bounds.mean.z) / 3.0f;
    const auto extinction = static_cast<double>(std::max(mean, kLeastOfMajorant * bounds.majorant));
    const double depth = extinction > 0.0 ? extinction * (end - begin) : 0.0;
    if (count_ < kMost) {
        pieces_[count_++] = {begin, extinction, depth_, bounds};
    } else {
        // The last stands for all that is left.
        Piece& last = pieces_[kMost - 1];
        last.bounds.majorant = std::max(last.bounds.majorant, bounds.majorant);
        last.bounds.limit = std::max(last.bounds.limit, bounds.limit);
        last.bounds.residual = last.bounds.majorant;
        last.bounds.certain = 0.0f;
        if (std::isfinite(end) && end > last.begin)
            last.extinction = (depth_ + depth - last.depth) / (end - last.begin);
    }
    depth_ += depth;
}

size_t SegmentBounds::piece_of(double t) const {
    const auto pieces = std::span(pieces_.data(), count_);
    const auto after = std::ranges::upper_bound(pieces, t, {}, &Piece::begin);
    return static_cast<size_t>(std::max<std::ptrdiff_t>(after - pieces.begin() - 1, 0));
}

double SegmentBounds::sample(float random) const {
    const double depth = -std::log1p(static_cast<double>(random) * std::expm1(-depth_));
    const auto pieces = std::span(pieces_.data(), count_);
    auto piece = std::ranges::upper_bound(pieces, depth, {}, &Piece::depth);
    while (piece != pieces.begin())
        if ((--piece)->extinction > 0.0) return piece->begin + (depth - piece->depth) / piece->extinction;
    return end_;
}

double SegmentBounds::density(double t) const {
    if (!(depth_ > 0.0)) return 0.0;
    return pieces_[piece_of(t)].extinction * dimmed(t, 0.0) / -std::expm1(-depth_);
}

double SegmentBounds::dimmed(double t, double /*beside*/) const {
    if (count_ == 0) return 1.0;
    const Piece& piece = pieces_[piece_of(t)];
    return std::exp(-piece.depth - piece.extinction * (t - piece.begin));
}

}  // namespace rayleaf
