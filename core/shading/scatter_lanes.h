// Points whose closures are looked at, and a direction of them sampled, together in the lanes of vectors: the same bits
// as one by one (closure_view.h), for the closures that are most frequent.
#pragma once

#include "shading/closure_view.h"

#include <optional>
#include <span>

namespace rayleaf {

/// What is asked at a point, and what is found there.
struct ScatterQuery {
    const Closures* closures = nullptr;
    Vec3f outgoing{0, 0, 1}, facet_normal{0, 0, 1};
    Vec2f random{0, 0};  ///< the first two numbers of Closures::sample
    ClosureView* view = nullptr;
    std::optional<LobeSample>* sample = nullptr;
    bool answered = false;  ///< else both are left as they were
};

/// Answers those that it knows: a diffuse lobe, a reflection of rough facets, or the one and the other.
void sample_together(std::span<ScatterQuery> queries);

}  // namespace rayleaf
