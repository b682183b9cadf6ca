// How dense the media along a segment of a ray may be: the sum of what bounds each.
#pragma once

#include "integrators/medium_tracking.h"

namespace rayleaf {

class Majorants {
  public:
    explicit Majorants(const MediumSegment& segment);

    MajorantStep at(double t) const;

  private:
    struct Line {
        const MajorantGrid* grid;
        GridLine ray;
    };
    std::array<Line, MediumStack::kMost> lines_;
    size_t count_ = 0;
    float even_ = 0;  ///< extinction of those that are the same everywhere
};

/// A density over the segment that is roughly where light is lost: exponential by half the bound, piece by piece.
class RoughDepth {
  public:
    RoughDepth(const Majorants& majorants, double end);

    /// The place for `random` in [0, 1). Infinite or beyond the end where there is nothing on the way.
    double sample(float random) const;
    double density(double t) const;
    /// Roughly what is left of light from there; what is beside the ray is not known.
    double dimmed(double t, double /*beside*/) const;

  private:
    struct Piece {
        double begin, extinction, depth;  ///< optical depth up to its begin
    };
    static constexpr size_t kMost = 128;
    std::array<Piece, kMost> pieces_;
    size_t count_ = 0;
    double end_, depth_ = 0;
};

}  // namespace rayleaf
