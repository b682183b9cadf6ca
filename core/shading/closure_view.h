// Closures as they are seen from one direction: what all values, densities and samples there have in common is computed
// once.
#pragma once

#include "shading/closures.h"

namespace rayleaf {

/// One lobe. Not initialised: closures may have many lobes, and have few.
struct LobeView {
    float probability;  ///< with which sampling chooses it
    float cosine;       ///< of the viewer's angle to its normal
    float masking;      ///< of microfacets: share of them that the viewer sees
    float mirrored;     ///< the same over four cosines: makes of the density of normals that of mirrored directions
    float glint;        ///< of singular ones: how often its mirror direction is sampled, in multiples of its share
    bool bent;          ///< `bump_shadow` darkens it
};

/// Belongs to closures that do not change.
struct ClosureView {
    Vec3f outgoing{0, 0, 1};
    bool any = false;     ///< some lobe can be chosen
    bool halves = false;  ///< some lobe asks for half vectors
    LobeView lobes[Closures::kMaxLobes];

    ClosureView() = default;
    ClosureView(const Closures& closures, const Vec3f& from) { look(closures, from); }
    /// Without glints: they are 1.
    void look(const Closures& closures, const Vec3f& from);
    /// Sets the probabilities anew, by the glints that the lobes have now.
    void weigh(const Closures& closures);
};

}  // namespace rayleaf
