// Dicing: the vertices of a subpatch's grid, in single precision from control points rounded to float.
//
// Every vertex is evaluated at the patch's own parameters, never from a subdivided net, by sums whose order depends on
// the degree alone. So a vertex has the same bits in every subpatch that it belongs to, and on a border between patches
// too, since there only the border's control points count. Sums pair terms from both ends, (t0 + tn) + (t1 + tn-1) ...,
// so the bits do not depend on the direction in which a border is run through either.
#pragma once

#include "splines/bezier_patch.h"
#include "tessellation/dyadic_basis.h"
#include "tessellation/grid.h"

namespace rayleaf {

/// The largest degree that can be diced.
inline constexpr int kMostDicedDegree = 15;

/// Dices the cells [first_u, first_u + 16] x [first_v, first_v + 16] of the patch's uniform cells. The bases are those
/// of the patch's degrees at as many intervals as the patch has cells.
void dice(const PatchView& patch, const DyadicBasis& basis_u, int first_u, const DyadicBasis& basis_v, int first_v,
          Grid& grid);

}  // namespace rayleaf
