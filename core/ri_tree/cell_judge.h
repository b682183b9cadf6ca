// Decides whether a cell of the fast tree is final, and how its lines are answered: a pure function of its samples.
//
// Departures from the paper: a cell whose directions differ too much at the corners, or are wrong at the centre, is
// halved instead of traced for ever. A cell that is not close enough at the depth limit is traced. Cells of several
// classes have a depth limit of their own, and are traced there: interpolating some of their lines from the corners of
// one class took as long as it saved.
#pragma once

#include "ri_tree/cell_leaf.h"
#include "ri_tree/fast_sample.h"
#include "ri_tree/ray_cache.h"

#include <array>

namespace rayleaf {

enum class CellVerdict : uint8_t {
    Unknown,
    Halved,        ///< not final
    Interpolated,  ///< has a leaf
    Missed,
    ManyClasses,  ///< this and what follows: traced
    Angle,
    LargeCell,
    Error
};

inline constexpr int kCenterSample = kCellCorners;
using CellSamples = std::array<FastSample, kCellCorners + 1>;

/// Whether a cell has reached the depth limits.
struct CellDepths {
    bool deepest = false;        ///< at the depth limit
    bool deepest_mixed = false;  ///< at the depth limit for cells of several classes
};

class CellJudge {
  public:
    CellJudge(const SampleTracer& tracer, const LineSpace& space, const RayCacheSettings& settings);

    SampleContents contents() const { return contents_; }
    /// The verdict on samples of several classes; any two samples that differ suffice.
    static CellVerdict judge_mixed(const CellDepths& depths) {
        return depths.deepest_mixed ? CellVerdict::ManyClasses : CellVerdict::Halved;
    }
    /// `leaf` is set if the verdict is Interpolated.
    CellVerdict judge(const CellKey& key, const CellDepths& depths, const CellSamples& samples, CellLeaf& leaf) const;

  private:
    const LineSpace& space_;
    OutputKind kind_;
    SampleContents contents_;
    RayCacheSettings settings_;

    bool spreads_too_far(const CellKey& key, const CellSamples& samples) const;
    bool fit(const CellKey& key, const CellSamples& samples, CellLeaf& leaf) const;
    bool is_close(const CellKey& key, const FastSample& center, const std::array<double, kMostLeafValues>& residual,
                  CellLeaf& leaf) const;
};

}  // namespace rayleaf
