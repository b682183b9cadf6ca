// Rays of a packet against a facet each, in double precision: the steps of FacetRay (geometry/facet.h), in each lane,
// to the bit.
#pragma once

#include "geometry/facet.h"
#include "tessellation/ray_packet.h"

#include <cstdint>
#include <span>

namespace rayleaf {

/// Where the ray of each lane meets a facet.
struct alignas(64) FacetHits {
    double t[kPacketSize], u[kPacketSize], v[kPacketSize];
    double position[3][kPacketSize], normal[3][kPacketSize];

    FacetHit hit(size_t lane) const {
        return {t[lane],
                u[lane],
                v[lane],
                {position[0][lane], position[1][lane], position[2][lane]},
                {normal[0][lane], normal[1][lane], normal[2][lane]}};
    }
};

/// A facet by lane, and its hit.
struct alignas(64) FacetLanes {
    double corners[3][3][kPacketSize];  ///< number of the corner, axis
    FacetHits hits;

    void set(size_t lane, const FacetCorners& facet) {
        for (size_t k = 0; k < 3; ++k)
            for (int axis = 0; axis < 3; ++axis) corners[k][axis][lane] = facet[k][axis];
    }
};

/// Sets the hits of the lanes that it returns, of those asked.
using MeetFacets = uint32_t (*)(const RayPacket& rays, uint32_t lanes, FacetLanes& facets);
/// The version for this machine's processor.
MeetFacets decision_kernel();

/// Of some facets the nearest one of each lane; of several the first.
struct alignas(64) NearestFacets {
    FacetHits hits;
    double number[kPacketSize];  ///< in the list
};

/// Rays against all facets of a list, between their t_min and t_max.
struct MeetFewFacets {
    /// Sets the nearest of the lanes that it returns, of those asked.
    uint32_t (*closest)(const RayPacket& rays, uint32_t lanes, std::span<const FacetCorners> facets,
                        NearestFacets& nearest);
    /// Those of the lanes that meet any.
    uint32_t (*any)(const RayPacket& rays, uint32_t lanes, std::span<const FacetCorners> facets);
};
MeetFewFacets few_facets_kernel();

}  // namespace rayleaf
