// The tube around the rings of one subpatch of a bevelled curve.
#pragma once

#include "splines/sweep_path.h"
#include "tessellation/dicer.h"

namespace rayleaf {

/// Around everything within `reach` of a place of the profile, at all rings.
SubpatchBounds::Tube tube_around(const SweepRing (&rings)[kGridVertices], const Vec2d& middle, double reach);

}  // namespace rayleaf
