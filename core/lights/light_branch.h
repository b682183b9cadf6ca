// Up to four nodes of the light tree that hang together, weighed side by side.
#pragma once

#include "base/float4.h"
#include "base/vector.h"
#include "lights/cosines.h"
#include "lights/light_linking.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace rayleaf {

/// Where a light shines, by the cosine to its normals, which lie in a cone.
struct LightCone {
    Vec3f axis{0, 0, 0};  ///< unit; zero: it shines alike in all directions
    float cosine = 1;     ///< of the angle between the axis and a normal, at most
    /// Whether it shines to the side of the normals, and to the other, outside `body`.
    bool ahead = true, back = true;
    Box3d body = {};  ///< around an object from within which both sides may be seen; world; empty: there is none
};

struct LightBranch {
    static constexpr size_t kMost = 4;

    /// By node: the sphere about its box, what it shines, and how; nodes that are not there shine nothing.
    std::array<double, kMost> x{}, y{}, z{};
    Float4 radius{}, intensity{};  ///< a share of the tree's
    Float4 axis_x{}, axis_y{}, axis_z{}, spread_cosine{}, spread_sine{};
    Float4 no_axis{};  ///< 1 where a node shines alike in all directions, else 0
    Float4 side{};     ///< that is seen: 1, that of the normals, or -1, the other; 0: both are

    std::array<uint32_t, kMost> node{};   ///< of the tree
    std::array<uint32_t, kMost> below{};  ///< of a leaf its item, else the branch of its children
    std::array<int32_t, kMost> body{};    ///< of the tree's bodies, where one side alone is seen from outside; else -1
    uint32_t count = 0;
    uint32_t leaves = 0;   ///< a bit for each
    uint32_t bounded = 0;  ///< leaves that shine on a part of space alone
    bool has_bodies = false;
    bool has_views = false;
    std::array<int32_t, kMost> view{-1, -1, -1, -1};  ///< of the tree's views; -1: light gets everywhere from there
    uint32_t parent = 0, lane_of_parent = 0;

    bool is_leaf(size_t lane) const { return (leaves >> lane & 1u) != 0; }
    void set_cone(size_t lane, const LightCone& cone);
    /// By which one of them is chosen at a point.
    struct Weights {
        /// Intensity over squared distance, times the cosines at the lights and at the point, about the mean of each
        /// over a node.
        Float4 numbers{};
        Float4 cosines{};  ///< these alone; 1 within a node

        /// A share of them by the cosines alone, for as much in all: estimates know little of shadows, and a bright
        /// light that does not arrive would leave few samples to the others.
        Float4 evened() const;
    };
    /// All are zero where `shining`, the intensities of those that count, is zero, and only there.
    Weights weights(const LitPoint& at, Float4 shining, Float4 sides) const;
    /// A bit for each whose sphere the position is in.
    uint32_t around(const Vec3d& position) const;

  private:
    /// From a position to the middles, and how long that is.
    struct Ways {
        Float4 x, y, z, squared;
    };
    Ways ways(const Vec3d& position) const;
};

}  // namespace rayleaf
