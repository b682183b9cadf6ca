// The limit of a cage, face by face: the door to OpenSubdiv.
//
// A face has parameters of its own: a quad the unit square, its corners counter-clockwise from (0, 0); any other face a
// square of half the size for each corner. Near a vertex without the regular four faces, and near creases, the limit is
// an endless row of ever smaller patches; past kApproximationLevels one smooth patch ends it.
#pragma once

#include "geometry/subdivision_cage.h"
#include "splines/bezier_patch.h"

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace rayleaf {

/// A square in a face's parameters: a corner and two sides.
struct FaceSquare {
    Vec2d origin{0, 0}, next{0, 0}, previous{0, 0};  ///< at a corner; towards the next corner and the previous one
};

/// The limit of all faces for one kind of values.
class LimitFaces {
  public:
    LimitFaces();
    ~LimitFaces();
    LimitFaces(LimitFaces&&) noexcept;
    LimitFaces& operator=(LimitFaces&&) noexcept;

    /// Whether a face is one bicubic patch.
    bool is_regular(uint32_t face) const;
    /// The value and its derivatives by the face's parameters.
    PatchPoint evaluate(uint32_t face, const Vec2d& parameters) const;
    Vec3d position(uint32_t face, const Vec2d& parameters) const;
    /// Positions in turn, faster where the second parameter stays.
    void positions(uint32_t face, std::span<const Vec2d> parameters, Vec3d* positions) const;
    /// Frees a face, which must not be evaluated any more.
    void forget(uint32_t face);
    size_t bytes() const;

  private:
    friend class CageTopology;
    struct Faces;
    std::unique_ptr<Faces> faces_;
};

/// How the faces of a cage are connected.
class CageTopology {
  public:
    /// The cage must have been validated.
    explicit CageTopology(const SubdivisionCage& cage);
    ~CageTopology();
    CageTopology(const CageTopology&) = delete;
    CageTopology& operator=(const CageTopology&) = delete;

    uint32_t edge_count() const;
    std::array<uint32_t, 2> edge_vertices(uint32_t edge) const;
    /// The edge from a corner of a face to the next one.
    uint32_t face_edge(uint32_t face, uint32_t corner) const;
    /// The faces at an edge, any number.
    std::vector<uint32_t> edge_faces(uint32_t edge) const;

    /// Limits of positions, one a vertex.
    LimitFaces limit(const std::vector<Vec3d>& vertices) const;
    /// Limits of a UV map (z is 0), by its index in the cage.
    LimitFaces uv_limit(size_t map) const;
    /// The square of a corner's part of a face, half as long as the face.
    static FaceSquare corner_square(int face_size, int corner);

  private:
    struct Refiner;
    std::unique_ptr<Refiner> refiner_;
};

}  // namespace rayleaf
