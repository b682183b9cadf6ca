// A layer of fibres on a surface, as cloth has it: Blender's sheen since 4.0 (Zeltner, Burley, Chiang: "Practical
// Multiple-Scattering Sheen Using Linearly Transformed Cosines", SIGGRAPH 2022 Talks).
//
// In the frame with z the normal and the viewer in the half plane x > 0, the layer's value is that of a cosine lobe
// whose directions are transformed linearly by the inverse of [a 0 b; 0 a 0; 0 0 1].
#pragma once

#include "shading/closures.h"

namespace rayleaf {

struct Microfibres {
    float albedo;     ///< share of the light that the layer reflects
    float narrowing;  ///< the matrix's a, above 0
    float skew;       ///< the matrix's b
};

/// `roughness` 0..1; `cosine` of the viewer's angle to the normal.
Microfibres microfibres(float roughness, float cosine);
/// Gives a lobe with a normal its shape; the weight is the caller's.
void set_microfibres(Lobe& lobe, const Microfibres& fibres, const Vec3f& outgoing);

}  // namespace rayleaf
