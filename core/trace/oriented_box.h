// The box around an instance as it is turned: three slabs that rays must meet beside the box of the tree above.
#pragma once

namespace rayleaf {

/// In the space of the tree above the instances, padded as its boxes are. The axes are those of the shape, so a flat
/// shape that is turned has a flat one, where the tree's box is thick.
struct alignas(64) OrientedBox {
    float axis[3][3] = {};            ///< unit normals of the slabs; zero: any ray meets it
    float low[3] = {}, high[3] = {};  ///< where the slabs are along them
};

}  // namespace rayleaf
