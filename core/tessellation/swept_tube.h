// The tube around the rings of one subpatch of a bevelled curve.
#pragma once

#include "splines/sweep_path.h"
#include "tessellation/dicer.h"

#include <span>

namespace rayleaf {

/// Around everything within `reach` of a place of the profile, at all rings, of which there are 5, 9 or 17.
SubpatchBounds::Tube tube_around(std::span<const SweepRing> rings, const Vec2d& middle, double reach);

/// The box of a ring, whose profile lies within `extent`.
Box3d box_of(const SweepRing& ring, double extent);

}  // namespace rayleaf
