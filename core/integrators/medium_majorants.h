// How dense the media along a segment of a ray are: the sum of what bounds each, piece by piece.
#pragma once

#include "base/maybe.h"
#include "integrators/medium_tracking.h"

namespace rayleaf {

/// From the origin on; within a piece the bounds stay. Finds only what is asked for.
class BoundWalk {
  public:
    /// Camera rays see the detail of cells: their light has most of the noise, and later rays it would slow down more.
    explicit BoundWalk(const MediumSegment& segment);

    const DensityBounds& bounds() const { return is_alone_ ? walks_[0]->bounds() : bounds_; }
    double end() const { return end_; }  ///< of the piece, along the ray; may be infinite
    void advance();

  private:
    std::array<Maybe<GridWalk>, MediumStack::kMost> walks_;
    size_t count_ = 0;
    bool is_alone_ = false;                       ///< one that varies, and nothing else
    DensityBounds even_ = DensityBounds::none();  ///< of those that are the same everywhere
    DensityBounds bounds_ = DensityBounds::none();
    double end_ = 0;

    void add_up();
};

/// All pieces of a segment, for those who ask several times. With it goes a density that is roughly where light is
/// lost: exponential by the mean of each piece.
class SegmentBounds {
  public:
    explicit SegmentBounds(const MediumSegment& segment);

    /// The place for `random` in [0, 1). Infinite or beyond the end where there is nothing on the way.
    double sample(float random) const;
    double density(double t) const;
    /// Roughly what is left of light from there; what is beside the ray is not known.
    double dimmed(double t, double /*beside*/) const;
    const DensityBounds& at(double t) const { return pieces_[piece_of(t)].bounds; }

    /// As BoundWalk.
    class Walk {
      public:
        explicit Walk(const SegmentBounds& all) : all_(all) {}
        const DensityBounds& bounds() const { return all_.pieces_[piece_].bounds; }
        double end() const { return piece_ + 1 < all_.count_ ? all_.pieces_[piece_ + 1].begin : all_.end_; }
        void advance() { piece_ += piece_ + 1 < all_.count_ ? 1 : 0; }

      private:
        const SegmentBounds& all_;
        size_t piece_ = 0;
    };

  private:
    struct Piece {
        double begin, extinction, depth;  ///< optical depth up to its begin
        DensityBounds bounds;
    };
    static constexpr size_t kMost = 256;
    std::array<Piece, kMost> pieces_;
    size_t count_ = 0;
    double end_, depth_ = 0;

    size_t piece_of(double t) const;
    void append(const DensityBounds& bounds, double begin, double end);
};

}  // namespace rayleaf
