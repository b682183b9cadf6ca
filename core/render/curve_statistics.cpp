#include "render/curve_statistics.h"

#include "geometry/strands.h"
#include "geometry/swept_surface.h"

namespace rayleaf {

void CurveStatistics::add(const Shape& shape) {
    if (shape.kind() == ShapeKind::SweptSurface) {
        const auto& swept = static_cast<const SweptSurface&>(shape);
        splines += swept.path().splines.size();
        pieces += swept.path().pieces.size();
    } else if (shape.kind() == ShapeKind::Strands) {
        const auto& hair = static_cast<const Strands&>(shape);
        strands += hair.strand_count();
        segments += hair.element_count();
    }
}

}  // namespace rayleaf
