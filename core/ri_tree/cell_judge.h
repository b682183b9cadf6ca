// Whether a cell of the fast tree is final, and what its lines are answered with: a pure function of its samples.
//
// Departures from the paper: directions that differ too much at the corners, and a direction that is wrong at the
// centre, are reasons to halve a cell, not to trace its lines for ever. A cell that is not close enough at the depth
// limit is traced. Cells of several classes have a depth limit of their own, and are traced there: the share of them
// that some corners could answer did not pay for telling.
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

/// How far below the depth limits a cell is.
struct CellDepths {
    bool deepest = false;        ///< no deeper cell is allowed
    bool deepest_mixed = false;  ///< nor one of several classes
};

class CellJudge {
  public:
    CellJudge(const SampleTracer& tracer, const LineSpace& space, const RayCacheSettings& settings);

    SampleContents contents() const { return contents_; }
    /// Of samples of several classes; any two of them tell.
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
