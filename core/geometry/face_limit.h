// The limit of one face of a cage, for one kind of values.
//
// Normally this is OpenSubdiv's surface of the face. But where two faces share both edges at a vertex, OpenSubdiv 3.5
// writes beyond its arrays if there is also a border, an infinitely sharp edge, or a neighbour of the same topology.
// Such faces are subdivided once, which moves borders and other vertices out of reach. An infinitely sharp edge that
// ends at that vertex stays, so the part there is subdivided further until its corners are the limit.
//
// OpenSubdiv takes long for each point of an irregular face. So where the corners are smooth, a quadtree of bicubic
// patches holds most of the face, and OpenSubdiv answers for the rest near irregular corners.
#pragma once

#include "geometry/face_cage.h"
#include "geometry/limit_quadtree.h"
#include "splines/bezier_patch.h"

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <opensubdiv/bfr/parameterization.h>
#include <opensubdiv/bfr/surface.h>

namespace rayleaf {

/// The end patch then covers 1/64 of a face's side, and lies within 1e-7 of the face's size of the limit.
inline constexpr int kApproximationLevels = 6;
/// A crease with finite sharpness must be refined until it has become smooth.
inline constexpr int kSharpLevels = 10;
/// Each step brings corners four times nearer to the limit: after all, within 6e-8 of the face's size.
inline constexpr int kMostParts = 12;

class FaceLimit {
  public:
    FaceLimit();
    ~FaceLimit();
    FaceLimit(FaceLimit&&) noexcept;
    FaceLimit& operator=(FaceLimit&&) noexcept;

    /// Whether the limit is one bicubic patch.
    bool is_regular() const;
    PatchPoint evaluate(const Vec2d& parameters) const;
    Vec3d position(const Vec2d& parameters) const;
    /// Positions in turn, faster where the second parameter stays.
    void positions(std::span<const Vec2d> parameters, Vec3d* positions) const;
    size_t bytes() const;

  private:
    friend class FaceLimitMaker;
    using Surface = OpenSubdiv::Bfr::Surface<double>;

    Surface surface_;
    std::vector<Vec3d> points_;     ///< control points and what OpenSubdiv derives from them
    LimitQuadtree quadtree_;        ///< of a face with smooth corners
    std::vector<FaceLimit> parts_;  ///< one a corner of the face, each with the unit square; or none
    std::vector<Vec3d> corners_;    ///< of a bilinear patch that ends the row of parts; or none
    /// Of a face that has parts or a quadtree.
    OpenSubdiv::Bfr::Parameterization parameters_;

    struct InPart {
        size_t part;
        Vec2d parameters;
    };
    InPart part_at(const Vec2d& parameters) const;
    /// The quadtree's quad and the parameters there.
    InPart quad_at(const Vec2d& parameters) const;
    std::optional<PatchPoint> in_quadtree(const Vec2d& parameters) const;
    PatchPoint by_opensubdiv(const Vec2d& parameters) const;
    Vec3d position(const Vec2d& parameters, LimitQuadtree::Walk& walk) const;
};

/// Makes the limits of a mesh's faces. Thread-safe.
class FaceLimitMaker {
  public:
    /// The mesh and the values, by vertex or by the channel's index, must outlive this.
    FaceLimitMaker(const FaceCage::Refiner& mesh, int channel, std::span<const Vec3d> values);
    ~FaceLimitMaker();
    FaceLimitMaker(const FaceLimitMaker&) = delete;
    FaceLimitMaker& operator=(const FaceLimitMaker&) = delete;

    /// Empty for faces without a limit.
    std::optional<FaceLimit> operator()(int face) const;

  private:
    class Factory;
    const FaceCage::Refiner* mesh_;
    int channel_;
    std::span<const Vec3d> values_;
    std::unique_ptr<const Factory> factory_;

    static std::optional<FaceLimit> in_parts(const FaceCage& cage, int steps);
    static std::optional<FaceLimit> of_cage(const FaceCage& cage, int steps);
};

}  // namespace rayleaf
