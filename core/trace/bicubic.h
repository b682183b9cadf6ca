// Bicubic patches in single precision: what the rival tracers of the benchmarks evaluate at a hit, and convex bodies at
// a crossing (ri_tree/convex_body.h).
#pragma once

#include "base/vector.h"

namespace rayleaf {

/// Control points, u fastest; the fourth number is 0 and makes each a vector of four.
struct alignas(16) BicubicPatch {
    float points[16][4] = {};
};

struct BicubicPoint {
    Vec3f position{0, 0, 0}, du{0, 0, 0}, dv{0, 0, 0};
};

/// Additions and multiplications of one evaluation, three coordinates each: basis and its derivative twice (2 * 22),
/// four rows of two sums (4 * 2 * 3 * 7), then three sums (3 * 3 * 7).
inline constexpr int kBicubicFlops = 2 * 22 + 4 * 2 * 3 * 7 + 3 * 3 * 7;

namespace bicubic {

struct Basis {
    float value[4], slope[4];
    explicit Basis(float t) {
        const float s = 1.0f - t, ss = s * s, tt = t * t, st = s * t;
        value[0] = ss * s;
        value[1] = 3.0f * ss * t;
        value[2] = 3.0f * s * tt;
        value[3] = tt * t;
        slope[0] = -3.0f * ss;
        slope[1] = 3.0f * (ss - 2.0f * st);
        slope[2] = 3.0f * (2.0f * st - tt);
        slope[3] = 3.0f * tt;
    }
};

/// Four at a time: compilers make one vector of it.
inline void weighted_sum(const float (&weights)[4], const float (*points)[4], float (&sum)[4]) {
    for (int c = 0; c < 4; ++c) sum[c] = weights[0] * points[0][c];
    for (int i = 1; i < 4; ++i) {
        for (int c = 0; c < 4; ++c) sum[c] += weights[i] * points[i][c];
    }
}

/// Value and first derivatives, four numbers each.
struct Tangent {
    float value[4], du[4], dv[4];
};

inline Tangent tangent(const float (&points)[16][4], float u, float v) {
    const Basis basis_u(u), basis_v(v);
    float rows[4][4], slopes[4][4];
    for (int j = 0; j < 4; ++j) {
        weighted_sum(basis_u.value, points + 4 * j, rows[j]);
        weighted_sum(basis_u.slope, points + 4 * j, slopes[j]);
    }
    Tangent result;
    weighted_sum(basis_v.value, rows, result.value);
    weighted_sum(basis_v.value, slopes, result.du);
    weighted_sum(basis_v.slope, rows, result.dv);
    return result;
}

}  // namespace bicubic

inline BicubicPoint evaluate(const BicubicPatch& patch, float u, float v) {
    const auto [position, du, dv] = bicubic::tangent(patch.points, u, v);
    return {{position[0], position[1], position[2]}, {du[0], du[1], du[2]}, {dv[0], dv[1], dv[2]}};
}

}  // namespace rayleaf
