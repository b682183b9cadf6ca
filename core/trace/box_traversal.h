// Rays on their way through a tree of boxes: a packet together while several of its rays meet a node, then each alone;
// or all alone from the beginning, in turn.
//
// Boxes are met in single precision; they are padded by more than rounding moves a ray or a box (kBoxPadding).
#pragma once

#include "tessellation/ray_packet.h"
#include "trace/box_tree.h"

#include <cstdint>
#include <limits>

namespace rayleaf {

/// What is done at an item that rays may meet: `visit` tests the lanes and lowers their `farthest`, below zero where a
/// ray need not go on.
struct BoxVisitor {
    using Visit = void (*)(void* owner, uint32_t item, uint32_t lanes, float* farthest);
    Visit visit;
    void* owner;
    const void* items = nullptr;  ///< what `visit` reads first, by item, to be fetched ahead of it; null: unknown
    uint32_t item_bytes = 0;      ///< of each
};

/// Where the boxes of a tree's nodes are at each ray's time: they move along lines (BoxTree::moving_bounds).
struct MovingBoxes {
    const BoxBounds* from;  ///< of the first node, at the earlier of two times; the later one follows
    size_t steps;           ///< from a node's to the next one's
    const float* share;     ///< of the later time, by lane
};

/// What is left of the way of a ray that needs no other hit.
inline constexpr float kDone = -std::numeric_limits<float>::infinity();

struct BoxTraversal {
    /// `lanes` meet a node together while there are more than `few`. `farthest` is by lane, along the unit direction.
    /// They begin at `root`: 0, or a node's child.
    void (*packet)(const BoxNode* nodes, uint32_t root, const RayPacket& rays, uint32_t lanes, int few, float* farthest,
                   const BoxVisitor& visitor);
    /// All rays alone, from the first node on, a step each in turn: what one has to wait for is fetched while the
    /// others go on. Faster where a tree is far larger than the processor's caches.
    void (*in_turn)(const BoxNode* nodes, const RayPacket& rays, uint32_t lanes, float* farthest,
                    const BoxVisitor& visitor);
    /// A ray of its own, as lane 0.
    void (*alone)(const BoxNode* nodes, uint32_t root, const Vec3f& origin, const Vec3f& direction, float* farthest,
                  const BoxVisitor& visitor);
    /// The same where boxes move.
    void (*moving_packet)(const BoxNode* nodes, uint32_t root, const MovingBoxes& boxes, const RayPacket& rays,
                          uint32_t lanes, int few, float* farthest, const BoxVisitor& visitor);
    void (*moving_in_turn)(const BoxNode* nodes, const MovingBoxes& boxes, const RayPacket& rays, uint32_t lanes,
                           float* farthest, const BoxVisitor& visitor);
    void (*moving_alone)(const BoxNode* nodes, uint32_t root, const MovingBoxes& boxes, const Vec3f& origin,
                         const Vec3f& direction, float* farthest, const BoxVisitor& visitor);
};
/// The versions for this machine's processor.
BoxTraversal box_traversal();

}  // namespace rayleaf
