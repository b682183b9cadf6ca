// The polygon mesh whose limit is a subdivision surface (Catmull and Clark 1978), as it comes from outside. The limit
// of the bilinear scheme is the mesh itself: quads ruled, other faces ruled between their middles.
//
// A corner is one vertex of one face; corners are numbered face by face, counter-clockwise seen from the outside.
#pragma once

#include "geometry/triangle_mesh.h"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace rayleaf {

/// Sharpness that counts as infinite (OpenSubdiv's constant).
inline constexpr float kInfiniteSharpness = 10.0f;

/// The most corners of a face and faces of a vertex: every face at such a vertex depends on all of them.
inline constexpr int kMostAtVertex = 1024;

enum class SubdivisionScheme : uint8_t { CatmullClark, Bilinear };

/// The rule for border vertices that belong to a single face.
enum class BorderCorners : uint8_t { Sharp, Smooth };

/// Where texture coordinates stay linear, as Blender's modifier has it.
enum class UvSmoothing : uint8_t {
    None,                         ///< everywhere
    KeepCorners,                  ///< at corners of islands
    KeepCornersJunctions,         ///< and where islands meet
    KeepCornersJunctionsConcave,  ///< and at their darts and concave corners
    KeepBoundaries,               ///< along all borders of islands
    All                           ///< nowhere
};

/// The spans are read during construction only.
struct SubdivisionCage {
    std::string name;                         ///< for messages
    std::span<const float> vertices;          ///< x,y,z each, object space
    std::span<const int32_t> face_sizes;      ///< corners of each face, 3 or more
    std::span<const int32_t> corners;         ///< vertex indices, face by face
    std::span<const int32_t> crease_edges;    ///< two vertex indices each; edges of no face are left out
    std::span<const float> crease_sharpness;  ///< one an edge: 0 is smooth
    std::span<const int32_t> crease_vertices;
    std::span<const float> vertex_sharpness;  ///< one for each of these
    std::span<const int32_t> material_slots;  ///< one a face; empty: slot 0 everywhere
    std::span<const float> corner_normals;    ///< x,y,z each, unit, to the outside: counts as the normal; or empty
    SubdivisionScheme scheme = SubdivisionScheme::CatmullClark;
    BorderCorners border_corners = BorderCorners::Smooth;
    UvSmoothing uv_smoothing = UvSmoothing::KeepBoundaries;
    std::vector<CornerAttribute> uv_maps;     ///< two channels, smoothed with the surface; one value a corner
    AttributeId active_uv = kNoAttribute;     ///< the map that is the surface's `uv`
    std::vector<CornerAttribute> attributes;  ///< bilinear within faces; one value a corner
    /// Of a surface that deforms, the vertices at even times of the shutter, time by time; `vertices` are those in its
    /// middle.
    std::span<const float> moved_vertices = {};
};

/// Throws InputError for cages that have no limit surface. Edges may have any number of faces.
void validate(const SubdivisionCage& cage);

}  // namespace rayleaf
