// A surface cut into subpatches, and what is known of each: made once, before it is decided whether its facets stay in
// memory or go through the geometry cache.
#pragma once

#include "base/cancel.h"
#include "tessellation/dicer.h"
#include "tessellation/facet_blocks.h"
#include "tessellation/level.h"

#include <atomic>
#include <memory>
#include <vector>

namespace rayleaf {

/// Parts of a subpatch lie this near to its fine facets, in units of what their second differences tell: those are of
/// neighbouring vertices, between which a second derivative may rise a little.
inline constexpr float kPartDistance = 2.0f;

/// How many grids that were diced slowly to be measured may wait to become facets, so that they are not diced twice.
/// What is diced has the same bits either way. Thread-safe.
class WaitingGrids {
  public:
    /// Whether there is room for one more.
    bool take() { return room_.fetch_sub(1, std::memory_order_relaxed) > 0; }

  private:
    std::atomic<int64_t> room_{int64_t{1} << 14};  ///< 57 MB
};

struct DicedSurface {
    std::unique_ptr<const Dicer> dicer;
    std::vector<SubpatchDetail> details;      ///< none where the dicer has no levels
    MeasuredGrids grids;                      ///< of slow subpatches whose facets will be as fine
    std::vector<SubpatchBounds::Tube> tubes;  ///< of subpatches without levels
    std::vector<Box3f> boxes;                 ///< of subpatches, at all levels
    Box3f box;                                ///< of all

    /// Measures every subpatch. Throws Cancelled soon after `cancel` says so.
    DicedSurface(std::unique_ptr<const Dicer> dicer, const FacetTolerance& tolerance, WaitingGrids& waiting,
                 const CancelToken& cancel);
};

/// Surfaces as the facets of all see them.
std::vector<DicedForm> diced(const std::vector<DicedSurface>& forms);

}  // namespace rayleaf
