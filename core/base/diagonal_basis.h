// The frame that Cycles builds around a normal. It is used where the choice of the frame shows in the picture.
#pragma once

#include "base/vector.h"

namespace rayleaf {

/// Two unit vectors that complete unit `n` to a right-handed orthonormal frame, the first at right angles to the
/// diagonal of the axes. They turn smoothly with `n` but beside that diagonal.
inline void diagonal_basis(const Vec3f& n, Vec3f& tangent, Vec3f& bitangent) {
    Vec3f across = Vec3f(1.0f, 1.0f, 1.0f).cross(n);
    if (across == Vec3f(0.0f)) across = Vec3f(-1.0f, 1.0f, 1.0f).cross(n);
    tangent = normalized_or(across, Vec3f(0.0f));
    bitangent = n.cross(tangent);
}

}  // namespace rayleaf
