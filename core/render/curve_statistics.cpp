#include "render/curve_statistics.h"

#include "geometry/strands.h"
#include "geometry/swept_surface.h"

namespace rayleaf {

void CurveStatistics::add(const Shape& shape) {
    if (shape.kind() == ShapeKind::SweptSurface) {
        const auto& swept = static_cast<const SweptSurface&>(shape);
        ++swept_surfaces;
        splines += swept.path().splines.size();
        pieces += swept.path().pieces.size();
        swept_bytes += swept.bytes();
    } else if (shape.kind() == ShapeKind::Strands) {
        const auto& hair = static_cast<const Strands&>(shape);
        ++strand_objects;
        strands += hair.strand_count();
        segments += hair.element_count();
        strand_bytes += hair.bytes();
    }
}

}  // namespace rayleaf
