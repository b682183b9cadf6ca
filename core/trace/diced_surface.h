// A surface cut into subpatches, and what is known of each: made once, before it is decided whether its facets stay in
// memory or go through the geometry cache.
#pragma once

#include "base/cancel.h"
#include "tessellation/dicer.h"
#include "tessellation/facet_blocks.h"
#include "tessellation/level.h"

#include <memory>
#include <vector>

namespace rayleaf {

/// Parts of a subpatch lie this near to its fine facets, in units of what their second differences tell: those are of
/// neighbouring vertices, between which a second derivative may rise a little.
inline constexpr float kPartDistance = 2.0f;

struct DicedSurface {
    std::unique_ptr<const Dicer> dicer;
    std::vector<SubpatchDetail> details;      ///< none where the dicer has no levels
    std::vector<SubpatchBounds::Tube> tubes;  ///< of subpatches without levels
    std::vector<Box3f> boxes;                 ///< of subpatches, at all levels
    Box3f box;                                ///< of all

    /// Measures every subpatch. Throws Cancelled soon after `cancel` says so.
    DicedSurface(std::unique_ptr<const Dicer> dicer, const CancelToken& cancel);
};

/// Surfaces as the facets of all see them.
std::vector<DicedForm> diced(const std::vector<DicedSurface>& forms);

}  // namespace rayleaf
