// Surface points of several hits at once, in the lanes of vectors of doubles.
//
// Each lane does what InstanceRecord::surface_point and PatchSurface::surface do for one hit, in the same order, so
// that the bits are the same. Where a patch has no normal of its own, or a number leaves the range that is expected, a
// lane says so, and its hit is done alone.
#pragma once

#include "splines/bezier_patch.h"
#include "trace/instance_record.h"
#include "trace/tracer.h"

#include <cstddef>
#include <cstdint>

namespace rayleaf {

/// What patches that are computed together have in common.
struct PatchForm {
    int degree_u = 0, degree_v = 0;
    bool rational = false;
    bool operator==(const PatchForm&) const = default;
};

/// Hits that are computed together. Rows are aligned for vectors.
// NOLINTNEXTLINE(clang-analyzer-optin.performance.Padding)
struct SurfaceLanes {
    static constexpr size_t kMost = 8;
    static constexpr int kMostDegree = 5;                                         ///< Blender's highest order is 6
    static constexpr size_t kMostPoints = (kMostDegree + 1) * (kMostDegree + 1);  ///< of a patch

    const InstanceRecord* records[kMost];
    alignas(64) double size[kMost];                              ///< as of InstanceRecord::start_offset
    alignas(64) double float_error[kMost], vertex_error[kMost];  ///< of the shape
    size_t count = 0;
    uint32_t done = 0;  ///< a bit each; the other hits must be done alone

    // Of hits on patches:
    const Vec4d* points[kMost];
    int64_t strides[kMost];                                                   ///< of the rows of points
    alignas(64) double u[kMost], v[kMost], length_u[kMost], length_v[kMost];  ///< parameters, and the spans' lengths

    // The surface at the hits, first local, as in LocalHit and LocalSurface, then in the world, as in SurfacePoint:
    alignas(64) double position[3][kMost], facet_position[3][kMost];
    alignas(64) float facet_normal[3][kMost], normal[3][kMost];
    alignas(64) float dp_du[3][kMost], dp_dv[3][kMost], dn_du[3][kMost], dn_dv[3][kMost];
    alignas(64) double start_offset[kMost], facet_error[kMost];  ///< in the world only
};

/// Whether there is a version for patches of this form.
bool has_lanes(const PatchForm& form);
/// Finds the local surface on patches. Here and below, rows beyond the last hit must hold some hit's numbers, and
/// `done` loses the hits that must be done alone.
void compute_patches(const PatchForm& form, SurfaceDetail detail, SurfaceLanes& lanes);
/// Carries the local surface of any shape into the world.
void place_surfaces(SurfaceDetail detail, SurfaceLanes& lanes);

}  // namespace rayleaf
