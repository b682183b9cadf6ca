// How fine a shape's facets must be: from its instances and the view.
#pragma once

#include "base/content_hash.h"
#include "tessellation/dicer.h"
#include "trace/tracer.h"

#include <cstdint>
#include <span>
#include <vector>

namespace rayleaf {

/// How fine a shape's facets must be, and a hash of all that this depends on.
struct ShapeTolerance {
    FacetTolerance tolerance;
    ContentHash key;
};

/// The tolerance of each shape that is diced: at most the wanted fraction of a pixel at the instance where that is
/// smallest in local units, at the point of the part's box nearest to the eye. It changes by steps of the eye's
/// distance, so that what was diced is kept when the camera or an object moves a little.
/// `shape_of`: of each instance, the number of its shape; `wanted`: by these numbers, whose are not 0. The others' are
/// empty, and so are those of shapes that are not diced.
std::vector<ShapeTolerance> facet_tolerances(const ChunkedVector<TracedInstance>& instances,
                                             std::span<const uint32_t> shape_of, std::span<const uint8_t> wanted,
                                             const DicingView& view);

}  // namespace rayleaf
