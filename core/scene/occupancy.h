// What lies where in a scene: whether an instance has its box to itself, as a body of glass must for rays to skip its
// inside.
#pragma once

#include "base/cancel.h"
#include "scene/description.h"
#include "scene/grouped_boxes.h"
#include "trace/tracer.h"

#include <cstdint>
#include <map>
#include <vector>

namespace rayleaf {

/// Instances are found through a tree of their boxes, their elements through one a shape that is made when it is first
/// needed. One thread at a time.
class Occupancy {
  public:
    /// All of them must live as long. Throws Cancelled soon after `cancel` says so, now and later.
    Occupancy(const SceneDescription& description, const Tracer& tracer, const CancelToken& cancel);

    /// Whether something of the scene may lie in the world box of an instance, beside the instance itself: the box of
    /// an element, or a lamp.
    bool is_occupied(uint32_t instance);

  private:
    const SceneDescription& description_;
    const Tracer& tracer_;
    const CancelToken& cancel_;
    std::vector<uint32_t> order_;  ///< instances, along a curve that fills space
    GroupedBoxes instances_;       ///< by place in that order
    std::map<const Shape*, GroupedBoxes> elements_;

    bool has_element_in(const Shape& shape, const Box3d& box);
};

}  // namespace rayleaf
