// The tube around the rings of one subpatch of a bevelled curve.
#pragma once

#include "splines/sweep_path.h"
#include "tessellation/dicer.h"

#include <span>

namespace rayleaf {

/// Around everything within `reach` of a place of the profile, at all rings: 5, 9 or 17.
SubpatchBounds::Tube tube_around(std::span<const SweepRing> rings, const Vec2d& middle, double reach);

/// Around a ring of a profile that reaches so far.
Box3d box_of(const SweepRing& ring, double extent);

}  // namespace rayleaf
