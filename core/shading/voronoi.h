// Cells around points that are scattered over space, one in each cube of the lattice (Worley, "A Cellular Texture Basis
// Function", 1996), as Blender's Voronoi Texture has them.
#pragma once

#include "base/vector.h"
#include "shading/variants.h"

#include <cstdint>

namespace rayleaf {

enum class VoronoiMetric : uint8_t { Euclidean, Manhattan, Chebychev, Minkowski };

/// By which the points of cells are chosen.
enum class VoronoiHash : uint8_t { Jenkins, Pcg };

struct VoronoiParameters {
    VoronoiFeature feature = VoronoiFeature::F1;
    VoronoiMetric metric = VoronoiMetric::Euclidean;  ///< of F1, F2 and SMOOTH_F1, in more than one dimension
    float exponent = 0.5f;                            ///< Minkowski's
    float smoothness = 1;                             ///< SMOOTH_F1, 0..1: how far cells blend into each other
    float randomness = 1;                             ///< 0..1: how far points may lie from the corner of their cube
    // Since Blender 4.0. Not of N_SPHERE_RADIUS.
    float detail = 0;                         ///< 0..15: octaves beyond the first; the last one may be a fraction
    float roughness = 0;                      ///< 0..1: amplitude of an octave over that of the one before
    float lacunarity = 2;                     ///< frequency of an octave over that of the one before
    bool normalize = false;                   ///< divide by the most that the result can be
    VoronoiHash hash = VoronoiHash::Jenkins;  ///< Pcg since Blender 5.0, in more than one dimension
};

/// What is known of the feature's point.
struct VoronoiResult {
    float distance = 0;       ///< to the point; to the nearest border; or the radius around the point
    Color color{0, 0, 0};     ///< 0..1 by chance; 0 of borders and radii
    Vec4f place{0, 0, 0, 0};  ///< the point; components beyond the dimensions are 0, but for 1: in w
};

/// The texture at `point`, of which the first `dimensions` (1..4) components count; 1: only w. Coordinates that are not
/// finite count as 0.
VoronoiResult voronoi_texture(int dimensions, const Vec4f& point, const VoronoiParameters& parameters);

}  // namespace rayleaf
