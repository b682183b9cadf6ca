// The unit normal of a patch, also where the Jacobian is singular: collapsed edges, coincident control points, poles.
//
// N = P_u x P_v vanishes there, yet the direction usually has a limit from inside the patch. Stages, each tried only if
// those before fail:
//   Regular      N itself; P_u and P_v are not nearly parallel and neither is rounding error.
//   SecondOrder  N expanded one step h towards the inside (a, b = +1 or -1 point inside):
//                    N + h (a (P_uu x P_v + P_u x P_uv) + b (P_uv x P_v + P_u x P_vv)).
//                The idea, and the choice of quadrant, are openNURBS' (ON_EvNormal); N is kept so that a patch that is
//                merely sheared keeps its own normal.
//   Inset        N at the point kInset further inside, which covers every higher order.
//   Neighbour    the normal that the caller finds on neighbouring patches.
//   Geometric    the normal that the caller gives, usually that of the facet, turned to the ray.
// The result is always unit and finite. All normals point to the side of P_u x P_v; the caller ensures the last two.
#pragma once

#include "base/vector.h"
#include "splines/bezier_patch.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>

namespace rayleaf {

enum class NormalStage : uint8_t { Regular, SecondOrder, Inset, Neighbour, Geometric };
inline constexpr size_t kNormalStageCount = 5;

/// The length of a finite step into the patch, as a share of the parameter range [0,1].
inline constexpr double kInset = 1e-3;
/// |P_u x P_v|² of less than this share of |P_u|² |P_v|² counts as degenerate (an angle of 1e-5).
inline constexpr double kDegenerateShare = 1e-10;
/// Derivatives shorter than these shares of the other derivative or of the position are compared with their rounding.
inline constexpr double kSuspiciousRatio = 1e-6, kSuspiciousLength = 1e-9;

struct LimitNormal {
    Vec3d normal{0, 0, 1};                 ///< unit
    Vec3d dn_du{0, 0, 0}, dn_dv{0, 0, 0};  ///< derivatives of the unit normal by u and v; at a degenerate point those
                                           ///< kInset inside, zero where there are none
    NormalStage stage = NormalStage::Regular;  ///< which stage answered
};

/// How often each stage answered. Each thread has its own counters; add them up.
struct NormalCounters {
    std::array<uint64_t, kNormalStageCount> counts{};

    void add(NormalStage stage) { ++counts[static_cast<size_t>(stage)]; }
    NormalCounters& operator+=(const NormalCounters& other) {
        for (size_t i = 0; i < counts.size(); ++i) counts[i] += other.counts[i];
        return *this;
    }
};

/// The normals to use where the patch itself gives no direction.
struct NormalFallback {
    std::function<std::optional<Vec3d>()> neighbour;  ///< called only when needed; may be empty; need not be unit
    Vec3d geometric{0, 0, 1};                         ///< need not be unit
};

/// `point` is patch.evaluate(u, v), which the caller has already.
LimitNormal limit_normal(const PatchView& patch, double u, double v, const PatchPoint& point,
                         const NormalFallback& fallback = {});
LimitNormal limit_normal(const PatchView& patch, double u, double v, const NormalFallback& fallback = {});

/// The same for a surface that is no single patch, with coordinates up to 1.
using SurfaceFunction = std::function<PatchPoint(double u, double v)>;
LimitNormal limit_normal(const SurfaceFunction& surface, double u, double v, const PatchPoint& point,
                         const NormalFallback& fallback = {});

}  // namespace rayleaf
