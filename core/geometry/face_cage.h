// A face and all faces that meet it: what the limit of that face depends on, cut out of a larger mesh.
//
// The values whose limit is wanted are those of the vertices, or those of one UV map, which corners number. Beyond the
// corners of the face the rules at the cut's own border are wrong; they have no say in the face's limit.
#pragma once

#include "base/vector.h"

#include <memory>
#include <span>
#include <vector>

#include <opensubdiv/far/topologyRefiner.h>

namespace rayleaf {

/// Whose limit: the vertices', or of face-varying values the channel.
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

/// Whether the faces around a corner are two, which share both edges there: the other one lies on the face's back.
bool is_between_two_faces(const FaceCage::Level& level, int face, int corner);
/// Whether one of the two edges there is sharp for ever, or a seam of the channel, and the other is not.
bool ends_crease_between_two_faces(const FaceCage::Level& level, int face, int corner, int channel);

}  // namespace rayleaf
