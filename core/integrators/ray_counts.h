// How many rays of each kind an integrator sent.
#pragma once

#include "shading/closures.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>

namespace rayleaf {

enum class RayUse : uint8_t {
    Camera,
    Specular,    ///< mirrors and clear refractions
    Glossy,      ///< rough microfacets
    Hemisphere,  ///< from diffuse lobes
    Indirect,    ///< any beyond a hemisphere ray
    Medium,      ///< scattered by a medium, and any beyond such a ray
    Shadow,      ///< to sampled lights
    Occlusion    ///< of the pass
};
inline constexpr std::array kRayUseNames = {"camera",   "specular", "glossy", "hemisphere",
                                            "indirect", "medium",   "shadow", "occlusion"};

/// Of the one ray that goes on from a surface that a ray of use `before` met.
inline RayUse use_of_scattered(RayUse before, const LobeSample& sample) {
    if (before == RayUse::Medium) return RayUse::Medium;
    if (before == RayUse::Hemisphere || before == RayUse::Indirect) return RayUse::Indirect;
    if (sample.singular) return RayUse::Specular;
    return sample.kind == LobeKind::Diffuse ? RayUse::Hemisphere : RayUse::Glossy;
}

struct RayCounts {
    std::array<uint64_t, kRayUseNames.size()> of{};

    uint64_t catcher_paths = 0;  ///< that went on twice from a shadow catcher

    uint64_t hemispheres_sampled = 0, hemispheres_interpolated = 0;  ///< of surfaces met within the frame

    uint64_t& operator[](RayUse use) { return of[static_cast<size_t>(use)]; }
    uint64_t operator[](RayUse use) const { return of[static_cast<size_t>(use)]; }
    uint64_t sum() const { return std::accumulate(of.begin(), of.end(), uint64_t{0}); }
    RayCounts& operator+=(const RayCounts& other) {
        for (size_t i = 0; i < of.size(); ++i) of[i] += other.of[i];
        catcher_paths += other.catcher_paths;
        hemispheres_sampled += other.hemispheres_sampled;
        hemispheres_interpolated += other.hemispheres_interpolated;
        return *this;
    }
};

}  // namespace rayleaf
