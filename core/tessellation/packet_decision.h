// Rays of a packet against a facet each, in double precision: the steps of FacetRay (geometry/facet.h), in each lane,
// to the bit.
#pragma once

#include "geometry/facet.h"
#include "tessellation/ray_packet.h"

#include <algorithm>
#include <cstdint>

namespace rayleaf {

/// A facet by lane, and where the lane's ray meets it.
struct alignas(64) FacetLanes {
    double corners[3][3][kPacketSize];  ///< number of the corner, axis
    double t[kPacketSize], u[kPacketSize], v[kPacketSize];
    double position[3][kPacketSize];

    void set(size_t lane, const FacetCorners& facet) {
        for (size_t k = 0; k < 3; ++k)
            for (int axis = 0; axis < 3; ++axis) corners[k][axis][lane] = facet[k][axis];
    }
    /// The same facet in all lanes.
    void set_all(const FacetCorners& facet) {
        for (size_t k = 0; k < 3; ++k)
            for (int axis = 0; axis < 3; ++axis) std::fill_n(corners[k][axis], kPacketSize, facet[k][axis]);
    }
    FacetHit hit(size_t lane) const {
        return {t[lane], u[lane], v[lane], {position[0][lane], position[1][lane], position[2][lane]}};
    }
};

/// Sets the hits of the lanes that it returns, of those asked.
using MeetFacets = uint32_t (*)(const RayPacket& rays, uint32_t lanes, FacetLanes& facets);
/// The version for this machine's processor.
MeetFacets decision_kernel();

}  // namespace rayleaf
