// Which lights shine on which objects, and whose shadows these cast: Blender's light linking.
//
// Lights that shine on the same objects share a set of receivers, lights whose shadows the same objects cast a set of
// blockers. Each object knows which sets it is in. Blockers are seen by rays of a kind of their own
// (trace/visibility.h).
#pragma once

#include "base/maybe.h"
#include "base/vector.h"
#include "lights/light_groups.h"
#include "trace/visibility.h"

#include <array>
#include <cstdint>
#include <string>

namespace rayleaf {

using LightSets = uint64_t;  ///< a bit for each set of receivers, and for the lights that shine on all
inline constexpr int kReceiverSets = 63;
inline constexpr LightSets kLightsOfAll = LightSets{1} << kReceiverSets;
inline constexpr LightSets kAllLightSets = ~LightSets{0};
/// All sets of receivers, as scenes are told.
inline constexpr int64_t kAnyLight = static_cast<int64_t>(~kLightsOfAll);

/// On what a light shines.
struct LightLink {
    int8_t receivers = -1;  ///< number of a set; -1: all objects
    int8_t blockers = -1;   ///< the same of those that cast its shadows

    /// The bit by which points know whether they are lit.
    LightSets set() const { return receivers < 0 ? kLightsOfAll : LightSets{1} << receivers; }
    bool operator==(const LightLink&) const = default;
};

/// What an object has to do with lights that are linked; `as_light` where it emits.
struct LightLinking {
    LightSets lit_by = kAllLightSets;   ///< with kLightsOfAll
    uint32_t blocks = kAllBlockerSets;  ///< a bit for each set of blockers
    LightLink as_light;

    bool operator==(const LightLinking&) const = default;
};

/// Throw InputError, which names the owner, for numbers that are none of sets.
LightSets checked_light_sets(const std::string& owner, int64_t lit_by);
LightLink checked_light_link(const std::string& owner, int64_t receivers, int64_t blockers);
LightLinking checked_light_linking(const std::string& owner, const std::array<int64_t, 4>& numbers);

/// A point that lights shine on.
struct LitPoint {
    Vec3d position{0, 0, 0};  ///< world
    LightSets lit_by = kAllLightSets;
    /// Of a surface that scatters what comes from one side alone: the unit normal on that side. Lights beyond are
    /// chosen seldom. Zero: light counts wherever it comes from.
    Vec3f normal{0, 0, 0};
    Maybe<LightGroups> groups = std::nullopt;  ///< what LightSet::sample has found
};

/// At the point, where nothing is known of the directions of its light.
inline double mean_cosine(const LitPoint& at) {
    return at.normal == Vec3f(0.0f) ? 1.0 : 0.5;
}

}  // namespace rayleaf
