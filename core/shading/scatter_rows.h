// What the kernels of scatter_lanes.cpp read and write.
#pragma once

#include "shading/scatter_lanes.h"

#include <cstddef>

namespace rayleaf {

/// The queries of a run and their answers, each number in a row of its own.
struct ScatterLanes {
    static constexpr size_t kMost = 16;
    using Row = float[kMost];
    struct Rows3 {
        Row x, y, z;
    };
    struct LobeRows {
        Row is_there;  ///< 1: it is; so are other answers to yes and no
        Rows3 weight, normal, tangent;
        Row probability, cosine;  ///< answers
    };

    alignas(64) Rows3 outgoing, facet_normal, smooth_normal;
    Row random_x, random_y;
    LobeRows diffuse, facets;
    // Of the diffuse lobe.
    Row is_disney, is_bent, is_by_facets, roughness;
    // Of the facets.
    Row alpha_x, alpha_y, ior, is_schlick, is_joint;
    Rows3 fresnel_0;
    // Answers.
    Row masking, mirrored;
    Row is_any, is_found, is_facets;
    Rows3 direction, value;
    Row density;
    /// A light at each point, and what the lobes make of it; all zero where there is none.
    struct Light {
        Rows3 incoming, value;
        Row density;
    };
    Rows3 light_side;
    Light lights[kMostLights];
    size_t count, light_count;
};

}  // namespace rayleaf
