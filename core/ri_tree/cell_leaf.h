// An interpolating cell: a polynomial of four variables for each number of an output ray.
//
// Departure from the paper, which interpolates the corners quadrilinearly. With the samples' derivatives known (ray
// differentials), sixteen corners determine every polynomial of total degree 3: the error falls with the fourth power
// of the cell's sides instead of the second. In terms of the Hermite data at the corners, on [-1, 1]^4:
//   sum over S of a_S prod(u_k, k in S)  +  sum over k of (u_k^2 - 1) (b_k + d_k u_k + sum over l of c_kl u_l)
// with at most three factors in S. The second sum vanishes at the corners and carries their derivatives. Without
// derivatives only the first sum is kept: quadrilinear, except that the product of all four is missing.
//
// Of unit vectors two components are kept; the third, the largest at the cell's centre, follows from them.
#pragma once

#include "ri_tree/line_space.h"
#include "ri_tree/output_ray.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace rayleaf {

inline constexpr int kLinearTerms = 15;
inline constexpr int kCubicTerms = 35;
inline constexpr int kMostLeafValues = 8;
/// Terms are read eight values at a time; the last read may reach beyond the end.
inline constexpr int kLeafPadding = 8;

/// Indices of the terms. Products of one to three factors come in lexicographic order of their axes.
inline constexpr int kConstantTerm = 0;
inline constexpr int kAxisTerms = 1;     ///< u_k
inline constexpr int kSquareTerms = 15;  ///< u_k^2 - 1
inline constexpr int kCubeTerms = 19;    ///< (u_k^2 - 1) u_k
inline constexpr int kMixedTerms = 23;   ///< (u_k^2 - 1) u_l, l among the other three in order

/// A unit vector by two of its components.
struct FoldedVector {
    uint8_t third = 0;  ///< the component left out; the two others follow in cyclic order
    int8_t sign = 1;    ///< sign of the component left out
};

/// Number of values in a leaf. Volume: the length. Others: depth of the first hit (fast_sample.h), two components of
/// its normal; then Simple: two texture coordinates; Glass: exit position, two components of the exit direction.
int leaf_value_count(OutputKind kind);

struct CellLeaf {
    SampleClass sample_class;
    float error = 0;           ///< estimated at the centre: distance (output_ray.h), share of the half extent
    float position_error = 0;  ///< of the first hit and of where the path leaves, local units
    FoldedVector normal, exit_direction;
    uint8_t terms = 0;   ///< kLinearTerms or kCubicTerms
    uint8_t values = 0;  ///< leaf_value_count
    /// Value i of term t is at [t * values + i]. Only the terms in use, and the padding, are stored.
    std::array<float, size_t{kCubicTerms} * kMostLeafValues + kLeafPadding> coefficients;

    size_t stored_bytes() const {
        return offsetof(CellLeaf, coefficients) + (size_t{terms} * values + kLeafPadding) * sizeof(float);
    }
};

/// A line in the form that answers need, local space.
struct LineGeometry {
    int axis = 0;
    std::array<double, 2> intercept{}, slope{};  ///< with the middle plane, relative to the box's middle; d_b / d_a
    Vec3d direction{0, 0, 1};                    ///< unit
};

inline Vec3d unfolded(const FoldedVector& folded, double a, double b) {
    double rest = 1.0 - a * a - b * b;
    if (rest < 0.0) {
        const double shrink = 1.0 / std::sqrt(1.0 - rest);
        a *= shrink;
        b *= shrink;
        rest = 0.0;
    }
    Vec3d v;
    v[folded.third] = folded.sign * std::sqrt(rest);
    v[(folded.third + 1) % 3] = a;
    v[(folded.third + 2) % 3] = b;
    return v;
}

/// The values that a leaf has for one line.
struct LeafValues {
    const float* first;
    size_t stride = 1;
};

/// Sets the output ray that a leaf's values stand for, local space. In a header, because it takes half of the time of
/// an interpolated ray.
inline void set_output(OutputKind kind, const CellLeaf& leaf, const LeafValues& values, const LineGeometry& line,
                       const Vec3d& box_center, OutputRay& out) {
    const auto value = [&](size_t i) { return static_cast<double>(values.first[i * values.stride]); };
    out.sample_class = leaf.sample_class;
    out.uv = Vec2d(0.0);
    out.length = 0.0;
    if (kind == OutputKind::Volume) {
        out.position = out.normal = out.exit_position = out.exit_direction = Vec3d(0.0);
        out.length = std::max(value(0), 0.0);
        return;
    }
    const int b = line.axis == 2 ? 0 : line.axis + 1, c = 3 - line.axis - b;
    const double depth = value(0);
    Vec3d from_middle;
    from_middle[line.axis] = depth;
    from_middle[b] = line.intercept[0] + line.slope[0] * depth;
    from_middle[c] = line.intercept[1] + line.slope[1] * depth;
    out.position = out.exit_position = box_center + from_middle;
    out.normal = unfolded(leaf.normal, value(1), value(2));
    if (kind == OutputKind::Simple) {
        out.uv = {value(3), value(4)};
        out.exit_direction = out.normal;
    } else if (kind == OutputKind::Mirror) {
        out.exit_direction = line.direction - out.normal * (2.0 * line.direction.dot(out.normal));
    } else {
        out.exit_position = {value(3), value(4), value(5)};
        out.exit_direction = unfolded(leaf.exit_direction, value(6), value(7));
    }
}

}  // namespace rayleaf
