#include "geometry/corner_rings.h"

#include <algorithm>

namespace rayleaf {
namespace {

using RefinedLevel = FaceCage::Level;

constexpr size_t kFewestFaces = 3;

int index_in(const OpenSubdiv::Far::ConstIndexArray& list, int wanted) {
    return static_cast<int>(std::find(list.begin(), list.end(), wanted) - list.begin());
}

Vec3d face_middle(const RefinedLevel& level, int face, std::span<const Vec3d> values) {
    const OpenSubdiv::Far::ConstIndexArray vertices = level.GetFaceVertices(face);
    Vec3d sum(0.0);
    for (const int vertex : vertices) sum += values[static_cast<size_t>(vertex)];
    return sum / vertices.size();
}

/// The face on the other side of a smooth edge, if there is exactly one.
std::optional<int> face_across(const RefinedLevel& level, int edge, int face) {
    const OpenSubdiv::Far::ConstIndexArray faces = level.GetEdgeFaces(edge);
    if (faces.size() != 2 || faces[0] == faces[1] || level.IsEdgeNonManifold(edge)) return std::nullopt;
    if (level.GetEdgeSharpness(edge) > 0.0f) return std::nullopt;
    return faces[0] == face ? faces[1] : faces[0];
}

/// Goes from face to face around a vertex, across the edge that leads to it.
std::optional<CornerRing> ring_around(const RefinedLevel& level, int first_face, int vertex,
                                      std::span<const Vec3d> values) {
    if (level.GetVertexSharpness(vertex) > 0.0f || level.IsVertexNonManifold(vertex)) return std::nullopt;
    const auto faces = static_cast<size_t>(level.GetVertexFaces(vertex).size());
    if (faces < kFewestFaces) return std::nullopt;
    CornerRing ring;
    ring.center = values[static_cast<size_t>(vertex)];
    int face = first_face, edge = level.GetFaceEdges(face)[index_in(level.GetFaceVertices(face), vertex)];
    do {
        const OpenSubdiv::Far::ConstIndexArray vertices = level.GetFaceVertices(face), edges = level.GetFaceEdges(face);
        const int corner = index_in(vertices, vertex);
        if (ring.edges.size() == faces || edges[corner] != edge) return std::nullopt;
        ring.edges.push_back(values[static_cast<size_t>(vertices[(corner + 1) % vertices.size()])]);
        ring.face_middles.push_back(face_middle(level, face, values));
        edge = edges[(corner + edges.size() - 1) % edges.size()];
        const std::optional<int> next = face_across(level, edge, face);
        if (!next) return std::nullopt;
        face = *next;
    } while (face != first_face);
    if (ring.edges.size() != faces) return std::nullopt;
    return ring;
}

}  // namespace

std::optional<std::vector<CornerRing>> corner_rings(const RefinedLevel& level, int face,
                                                    std::span<const Vec3d> values) {
    std::vector<CornerRing> rings;
    for (const int vertex : level.GetFaceVertices(face)) {
        std::optional<CornerRing> ring = ring_around(level, face, vertex, values);
        if (!ring) return std::nullopt;
        rings.push_back(std::move(*ring));
    }
    return rings;
}

}  // namespace rayleaf
