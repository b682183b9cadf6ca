// What the fast tree stores of a traced line: numbers that interpolate well, and their derivatives by the line.
//
// The first hit lies on the line, so one number gives it: its distance from the box's middle plane along the dominant
// axis. Interpolating that instead of a point keeps hits on their rays.
#pragma once

#include "ri_tree/convex_body.h"
#include "ri_tree/line_space.h"
#include "ri_tree/output_ray.h"
#include "ri_tree/path_changes.h"
#include "ri_tree/sample_tracer.h"

#include <array>
#include <cstdint>

namespace rayleaf {

/// A point of the lattice that the corners and middles of all cells lie on: shares of the root cell's sides, times
/// 2^31.
struct LatticePoint {
    uint8_t direction = 0;
    std::array<uint32_t, kLineAxes> place{};
    bool operator==(const LatticePoint&) const = default;
};

inline constexpr int kMostSampleValues = 10;

/// Indices of a sample's values.
namespace sample_value {
inline constexpr int kLength = 0;  ///< Volume
inline constexpr int kDepth = 0;   ///< of the first hit beyond the middle plane, along the dominant axis, local units
inline constexpr int kNormal = 1;  ///< three
inline constexpr int kUv = 4;      ///< Simple: two
inline constexpr int kExitPosition = 4;   ///< Glass: three
inline constexpr int kExitDirection = 7;  ///< Glass: three
}  // namespace sample_value

int sample_value_count(OutputKind kind);

struct FastSample {
    SampleClass sample_class;
    std::array<float, kMostSampleValues> values;
    /// Derivatives by the line's coordinates, in units of the root cell's half sides. Not set if only values are kept.
    std::array<std::array<float, kLineAxes>, kMostSampleValues> changes;
};

/// Whether derivatives are kept. They are not for meshes, where normals change differently on each triangle.
enum class SampleContents : uint8_t { Values, ValuesAndChanges };

/// The sample of a lattice point: followed through the body, if there is one; traced where that is uncertain.
FastSample take_sample(const SampleTracer& tracer, const ConvexBody* body, const LineSpace& space,
                       const LatticePoint& point, SampleContents contents);

/// Derivatives of a line's ray at its origin by the line's coordinates, in units of the root cell's half sides.
RayChanges line_changes(const LineSpace& space, const Ray& lattice_ray, int axis);

}  // namespace rayleaf
