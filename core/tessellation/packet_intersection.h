// Rays of a packet against one block of facets, in single precision.
//
// The test is that of a single ray (grid_intersection.h), widened by what rounding may do, so that it finds all facets
// that a true ray may hit. Double precision decides about those in the end (packet_decision.h). But where a ray passes
// a facet's edges by more than rounding may do, it hits it for sure: then nothing beyond that facet matters, and for
// shadows nothing else at all.
#pragma once

#include "tessellation/grid.h"
#include "tessellation/ray_packet.h"

#include <algorithm>
#include <cstdint>

namespace rayleaf {

/// Facets that rays of a packet may hit, by lane. Not initialized but for the numbers.
struct OpenFacets {
    struct Facet {
        uint32_t block, triangle;
        float near;  ///< along the float ray: it lies nowhere nearer, but for rounding
    };
    /// Between two blocks a lane holds no more; one block may add all its facets.
    static constexpr uint32_t kMost = 8;

    uint32_t count[kPacketSize] = {};
    Facet facets[kPacketSize][kMost + kBlockTriangles];

    void add(size_t lane, const Facet& facet) { facets[lane][count[lane]++] = facet; }
    void clear() { std::fill_n(count, kPacketSize, 0u); }
    /// Takes out one that is not beyond `farthest`, and those before it that are. False if there is none.
    bool take(size_t lane, float farthest, Facet& facet) {
        while (count[lane] > 0) {
            facet = facets[lane][--count[lane]];
            if (facet.near <= farthest) return true;
        }
        return false;
    }
};

/// So few rays are tested against a block faster one by one.
inline constexpr int kFewBlockRays = 3;

/// The numbers of a block's vertices, filled up to whole vectors.
inline constexpr int kVertexRoom = (3 * kBlockSize + kPacketSize - 1) / kPacketSize * kPacketSize;

/// The vertices of a block, [3][25], with room behind: floats, or steps of a fixed number (VertexFormat::Fixed).
struct BlockVertices {
    const float* floats = nullptr;
    const int32_t* fixed = nullptr;  ///< where there are no floats
    uint32_t facets = ~0u;           ///< those that have an area, a bit each: no other is found
};

/// Tests the lanes of `mask` up to `farthest`, the distance along the unit direction by lane, and adds what they may
/// hit to `open`, but for the facet that they start on: triangle 2 * (j * 4 + i) of cell (i, j), or the one after it.
/// Returns the lanes that hit one for sure; `farthest` is then how far the nearest such facet may reach.
using FindInBlock = uint32_t (*)(const BlockVertices& vertices, uint32_t block, const RayPacket& rays, uint32_t mask,
                                 float* farthest, OpenFacets& open);

struct PacketKernels {
    void (*shear)(RayPacket& rays, uint32_t lanes);
    /// A few rays one after the other, the block's vertices in the lanes. More of them in the lanes, the vertices one
    /// after the other: that costs a fraction.
    FindInBlock find;
};
/// The versions for this machine's processor.
PacketKernels packet_kernels();

}  // namespace rayleaf
