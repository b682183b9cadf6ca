// Points whose closures are looked at, lit, and a direction of them sampled, together in the lanes of vectors: the same
// bits as one by one (closure_view.h), for the closures that are most frequent.
#pragma once

#include "shading/closure_view.h"

#include <array>
#include <optional>
#include <span>

namespace rayleaf {

/// Lights of one point, at most.
inline constexpr size_t kMostLights = 2;
using LitByLights = std::array<Closures::Evaluation, kMostLights>;

/// What is asked at a point, and what is found there.
struct ScatterQuery {
    const Closures* closures = nullptr;
    Vec3f outgoing{0, 0, 1}, facet_normal{0, 0, 1};
    Vec2f random{0, 0};  ///< the first two numbers of Closures::sample
    /// Decides on which side lights are, as the facet's normal does for directions that are sampled.
    Vec3f light_side{0, 0, 1};
    std::array<const Vec3f*, kMostLights> lights{};  ///< directions from which light arrives, unit; null: none
    ClosureView* view = nullptr;
    std::optional<LobeSample>* sample = nullptr;
    LitByLights* lit = nullptr;  ///< by `lights`
    bool answered = false;       ///< else all three are left as they were
};

/// Answers those that it knows: a diffuse lobe, a reflection of rough facets, or the one and the other.
void sample_together(std::span<ScatterQuery> queries);

}  // namespace rayleaf
