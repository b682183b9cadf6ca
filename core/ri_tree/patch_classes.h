// Which elements of a shape join smoothly: the equivalence classes of RI, section 2.5.
//
// Patches of a spline are joined where they share a border and their normals agree along it, triangles where they share
// two vertices and their shading normals agree at both and the material is one. Splines are never joined to one
// another. Where texture coordinates are stored, they must agree too: then the seam of a closed spline separates its
// classes.
#pragma once

#include "base/cancel.h"
#include "geometry/shape.h"
#include "rays/hit.h"

#include <cstdint>
#include <vector>

namespace rayleaf {

enum class TextureSeams : uint8_t { Joined, Parted };

class PatchClasses {
  public:
    /// Throws Cancelled soon after `cancel` says so.
    PatchClasses(const Shape& shape, TextureSeams seams, const CancelToken& cancel = kNeverCancelled);

    /// 1 and up, or kFacetedClass on splines that are shaded flat.
    uint32_t of(const Shape& shape, const LocalHit& hit) const { return class_of_[shape.element_of(hit)]; }
    uint32_t of_element(uint32_t element) const { return class_of_[element]; }
    /// How many classes there are, without faceted ones.
    uint32_t count() const { return count_; }
    size_t bytes() const { return class_of_.capacity() * sizeof(uint32_t); }

  private:
    std::vector<uint32_t> class_of_;  ///< by element
    uint32_t count_ = 0;
};

}  // namespace rayleaf
