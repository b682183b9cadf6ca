// A face and all faces that touch it, cut out of a larger mesh: everything that the limit of the face depends on.
//
// The values are those of the vertices, or of one UV map, indexed by corner. At the border of the cut the subdivision
// rules are wrong, but they do not affect the limit of the face.
#pragma once

#include "base/vector.h"

#include <memory>
#include <span>
#include <vector>

#include <opensubdiv/far/topologyRefiner.h>

namespace rayleaf {

/// Whose limit is wanted: this for vertices, or the channel of face-varying values.
inline constexpr int kOfVertices = -1;

class FaceCage {
  public:
    using Level = OpenSubdiv::Far::TopologyLevel;
    using Refiner = OpenSubdiv::Far::TopologyRefiner;

    /// `channel` of the mesh; `values` by vertex or by the channel's numbers.
    FaceCage(const Refiner& mesh, int level, int face, int channel, std::span<const Vec3d> values);

    /// Its face is number 0, its channel, if it has one, too.
    const Refiner& refiner() const { return *refiner_; }
    const std::vector<Vec3d>& values() const { return values_; }
    int channel() const { return channel_; }
    /// The value at a corner of the face.
    const Vec3d& value(int corner) const;
    /// The cages around the parts of the face after one step of subdivision, corner by corner.
    std::vector<FaceCage> refined() const;

  private:
    std::shared_ptr<const Refiner> refiner_;
    std::vector<Vec3d> values_;
    int channel_ = kOfVertices;  ///< of the refiner
};

/// Whether exactly two faces meet at a corner and share both edges there: the other one lies back to back.
bool is_between_two_faces(const FaceCage::Level& level, int face, int corner);
/// Whether exactly one of the two edges there is infinitely sharp, or a seam of the channel.
bool ends_crease_between_two_faces(const FaceCage::Level& level, int face, int corner, int channel);

}  // namespace rayleaf
