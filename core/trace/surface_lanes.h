// Points on the exact surface of spline patches for several hits at once, in the lanes of vectors of doubles.
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

/// Hits on patches of one form. Rows are aligned for vectors.
// NOLINTNEXTLINE(clang-analyzer-optin.performance.Padding)
struct SurfaceLanes {
    static constexpr size_t kMost = 8;
    static constexpr int kMostDegree = 5;                                         ///< Blender's highest order is 6
    static constexpr size_t kMostPoints = (kMostDegree + 1) * (kMostDegree + 1);  ///< of a patch

    // Of each hit:
    const Vec4d* points[kMost];  ///< the patch's
    const InstanceRecord* records[kMost];
    alignas(64) double u[kMost], v[kMost], length_u[kMost], length_v[kMost];  ///< parameters, and the spans' lengths
    alignas(64) double facet_position[3][kMost];                              ///< local
    alignas(64) float facet_normal[3][kMost];                                 ///< local, not unit
    alignas(64) double size[kMost];                                           ///< as of InstanceRecord::start_offset
    alignas(64) double float_error[kMost], vertex_error[kMost];               ///< of the shape
    size_t count = 0;

    // What becomes of it, as in SurfacePoint:
    uint32_t done = 0;  ///< a bit each; the other hits must be done alone
    alignas(64) double position[3][kMost], facet_position_out[3][kMost], start_offset[kMost], facet_error[kMost];
    alignas(64) float facet_normal_out[3][kMost], normal[3][kMost], dp_du[3][kMost], dp_dv[3][kMost];
    alignas(64) float dn_du[3][kMost], dn_dv[3][kMost];
};

/// Whether there is a version for patches of this form.
bool has_lanes(const PatchForm& form);
/// Fills the second part from the first. Rows beyond the last hit must hold some hit's numbers.
void compute_surfaces(const PatchForm& form, SurfaceDetail detail, SurfaceLanes& lanes);

}  // namespace rayleaf
