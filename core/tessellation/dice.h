// Dicing: the vertices of a subpatch's grid, in single precision from control points rounded to float.
//
// Every vertex is evaluated at the patch's own parameters, never from a subdivided net, by sums whose order depends on
// the degree alone. So a vertex has the same bits in every subpatch that it belongs to, and on a border between patches
// too, since there only the border's control points count. Sums pair terms from both ends, (t0 + tn) + (t1 + tn-1) ...,
// so the bits do not depend on the direction of a border either.
#pragma once

#include "splines/bezier_patch.h"
#include "tessellation/dyadic_basis.h"
#include "tessellation/grid.h"

namespace rayleaf {

/// The largest degree that can be diced.
inline constexpr int kMostDicedDegree = 15;

/// The vertices of a subpatch along one direction: `first` and those after it of a basis of the patch's degree.
struct DiceAxis {
    const DyadicBasis* basis = nullptr;
    int first = 0;
    bool at_begin = false, at_end = false;  ///< whether the first or last vertex lies on the patch's border
};

/// Dices 17 x 17 vertices, or 5 x 5 with bases of a fourth as many intervals.
void dice(const PatchView& patch, const DiceAxis& u, const DiceAxis& v, const VertexRows& target);

/// Converts rows to blocks with boxes.
void pack(const GridRows& rows, Grid& grid);

}  // namespace rayleaf
