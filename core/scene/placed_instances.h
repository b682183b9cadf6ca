// What a committed scene holds of each of its instances, beside what tracing does. Tables that one scene no longer
// needs are what the next one begins with: an edit changes what differs.
#pragma once

#include "base/spares.h"
#include "scene/description.h"
#include "shading/inputs.h"
#include "trace/tracer.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace rayleaf {

class PlacedInstances {
  public:
    std::vector<InstanceInfo> infos;
    std::vector<int> lists;           ///< of materials, by their index in the description; -1: none
    std::vector<int> interpolations;  ///< by their index in the description; -1: the scene's
    std::vector<int> light_groups;    ///< slots; -1: none
    std::vector<float> shadow_terminators;
    std::vector<uint8_t> visibility;  ///< as described
    std::vector<LightLinking> linkings;
    ChunkedVector<TracedInstance> traced;
    uint32_t moving = 0;  ///< instances that have a motion
    uint32_t linked = 0;  ///< instances to which the links of lights matter

    /// Makes them those of a description's instances.
    void update(const SceneDescription& description);
    /// How many chunks of instances they have in common with a description.
    size_t likeness(const SceneDescription& description) const;

  private:
    ChunkedVector<InstanceDescription> instances_;
    std::vector<std::shared_ptr<const Shape>> shapes_;
    std::vector<int> shape_of_;

    void resize(size_t count);
    void place(uint32_t index);
};

/// Thread-safe.
using PlacedInstancesStore = Spares<PlacedInstances>;

}  // namespace rayleaf
