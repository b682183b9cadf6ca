// What an operation's `text` may name: Blender's own identifiers, in capitals as Blender writes them, one enumeration
// per operation. A program stores the position in the list.
#pragma once

#include "shading/operation.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace rayleaf {

// clang-format off
#define RAYLEAF_MATH_VARIANTS(X) \
    X(ADD) X(SUBTRACT) X(MULTIPLY) X(DIVIDE) X(MULTIPLY_ADD) X(POWER) X(LOGARITHM) X(SQRT) X(INVERSE_SQRT) X(ABSOLUTE) \
    X(EXPONENT) X(MINIMUM) X(MAXIMUM) X(LESS_THAN) X(GREATER_THAN) X(SIGN) X(COMPARE) X(SMOOTH_MIN) X(SMOOTH_MAX) \
    X(ROUND) X(FLOOR) X(CEIL) X(TRUNC) X(FRACT) X(MODULO) X(FLOORED_MODULO) X(WRAP) X(SNAP) X(PINGPONG) X(SINE) \
    X(COSINE) X(TANGENT) X(ARCSINE) X(ARCCOSINE) X(ARCTANGENT) X(ARCTAN2) X(SINH) X(COSH) X(TANH) X(RADIANS) X(DEGREES)
#define RAYLEAF_VECTOR_MATH_VARIANTS(X) \
    X(ADD) X(SUBTRACT) X(MULTIPLY) X(DIVIDE) X(MULTIPLY_ADD) X(CROSS_PRODUCT) X(PROJECT) X(REFLECT) X(REFRACT) \
    X(FACEFORWARD) X(DOT_PRODUCT) X(DISTANCE) X(LENGTH) X(SCALE) X(NORMALIZE) X(ABSOLUTE) X(MINIMUM) X(MAXIMUM) \
    X(FLOOR) X(CEIL) X(FRACTION) X(MODULO) X(WRAP) X(SNAP) X(SINE) X(COSINE) X(TANGENT) X(POWER) \
    X(SIGN) X(ROUND)
#define RAYLEAF_BLEND_VARIANTS(X) \
    X(MIX) X(DARKEN) X(MULTIPLY) X(BURN) X(LIGHTEN) X(SCREEN) X(DODGE) X(ADD) X(OVERLAY) X(SOFT_LIGHT) X(LINEAR_LIGHT) \
    X(DIFFERENCE) X(EXCLUSION) X(SUBTRACT) X(DIVIDE) X(HUE) X(SATURATION) X(COLOR) X(VALUE)
#define RAYLEAF_CLAMP_VARIANTS(X) X(MINMAX) X(RANGE)
#define RAYLEAF_MAP_RANGE_VARIANTS(X) X(LINEAR) X(STEPPED) X(SMOOTHSTEP) X(SMOOTHERSTEP)
#define RAYLEAF_MAPPING_VARIANTS(X) X(POINT) X(TEXTURE) X(VECTOR) X(NORMAL)
#define RAYLEAF_LAYER_WEIGHT_VARIANTS(X) X(FRESNEL) X(FACING)
#define RAYLEAF_NORMAL_MAP_VARIANTS(X) X(TANGENT) X(OBJECT) X(WORLD)
#define RAYLEAF_MICROFACET_VARIANTS(X) X(SHARP) X(GGX) X(MULTI_GGX) X(BECKMANN) X(ASHIKHMIN_SHIRLEY)
#define RAYLEAF_PRINCIPLED_VARIANTS(X) X(GGX) X(MULTI_GGX)
#define RAYLEAF_LIGHT_PATH_VARIANTS(X) \
    X(is_camera) X(is_shadow) X(is_diffuse) X(is_glossy) X(is_singular) X(is_reflection) X(is_transmission) \
    X(is_volume) X(ray_length) X(ray_depth) X(diffuse_depth) X(glossy_depth) X(transparent_depth) X(transmission_depth) \
    X(portal_depth)
#define RAYLEAF_FRACTAL_VARIANTS(X) \
    X(FBM) X(MULTIFRACTAL) X(HYBRID_MULTIFRACTAL) X(RIDGED_MULTIFRACTAL) X(HETERO_TERRAIN)
#define RAYLEAF_VORONOI_VARIANTS(X) X(F1) X(F2) X(SMOOTH_F1) X(DISTANCE_TO_EDGE) X(N_SPHERE_RADIUS)
#define RAYLEAF_GRADIENT_VARIANTS(X) \
    X(LINEAR) X(QUADRATIC) X(EASING) X(DIAGONAL) X(SPHERICAL) X(QUADRATIC_SPHERE) X(RADIAL)
#define RAYLEAF_WAVE_VARIANTS(X) X(SIN) X(SAW) X(TRI)
#define RAYLEAF_VECTOR_ROTATE_VARIANTS(X) X(AXIS_ANGLE) X(X_AXIS) X(Y_AXIS) X(Z_AXIS) X(EULER_XYZ)
#define RAYLEAF_TRANSFORM_VARIANTS(X) X(POINT) X(VECTOR) X(NORMAL)
#define RAYLEAF_TOON_VARIANTS(X) X(DIFFUSE) X(GLOSSY)
#define RAYLEAF_HAIR_VARIANTS(X) X(REFLECTION) X(TRANSMISSION)
#define RAYLEAF_HAIR_FIBRE_VARIANTS(X) X(COLOR) X(MELANIN) X(ABSORPTION)
#define RAYLEAF_PHASE_VARIANTS(X) X(HENYEY_GREENSTEIN) X(FOURNIER_FORAND) X(DRAINE) X(RAYLEIGH) X(MIE)
// clang-format on

#define RAYLEAF_ENUMERATOR(name) name,
enum class MathVariant : uint8_t { RAYLEAF_MATH_VARIANTS(RAYLEAF_ENUMERATOR) };
enum class VectorMathVariant : uint8_t { RAYLEAF_VECTOR_MATH_VARIANTS(RAYLEAF_ENUMERATOR) };
enum class BlendVariant : uint8_t { RAYLEAF_BLEND_VARIANTS(RAYLEAF_ENUMERATOR) };
enum class ClampVariant : uint8_t { RAYLEAF_CLAMP_VARIANTS(RAYLEAF_ENUMERATOR) };
enum class MapRangeVariant : uint8_t { RAYLEAF_MAP_RANGE_VARIANTS(RAYLEAF_ENUMERATOR) };
enum class MappingVariant : uint8_t { RAYLEAF_MAPPING_VARIANTS(RAYLEAF_ENUMERATOR) };
enum class LayerWeightVariant : uint8_t { RAYLEAF_LAYER_WEIGHT_VARIANTS(RAYLEAF_ENUMERATOR) };
enum class NormalMapVariant : uint8_t { RAYLEAF_NORMAL_MAP_VARIANTS(RAYLEAF_ENUMERATOR) };
enum class MicrofacetVariant : uint8_t { RAYLEAF_MICROFACET_VARIANTS(RAYLEAF_ENUMERATOR) };
enum class PrincipledVariant : uint8_t { RAYLEAF_PRINCIPLED_VARIANTS(RAYLEAF_ENUMERATOR) };
enum class LightPathVariant : uint8_t { RAYLEAF_LIGHT_PATH_VARIANTS(RAYLEAF_ENUMERATOR) };
enum class FractalType : uint8_t { RAYLEAF_FRACTAL_VARIANTS(RAYLEAF_ENUMERATOR) };
enum class VoronoiFeature : uint8_t { RAYLEAF_VORONOI_VARIANTS(RAYLEAF_ENUMERATOR) };
enum class GradientVariant : uint8_t { RAYLEAF_GRADIENT_VARIANTS(RAYLEAF_ENUMERATOR) };
enum class WaveProfile : uint8_t { RAYLEAF_WAVE_VARIANTS(RAYLEAF_ENUMERATOR) };
enum class VectorRotateVariant : uint8_t { RAYLEAF_VECTOR_ROTATE_VARIANTS(RAYLEAF_ENUMERATOR) };
enum class TransformVariant : uint8_t { RAYLEAF_TRANSFORM_VARIANTS(RAYLEAF_ENUMERATOR) };
enum class ToonVariant : uint8_t { RAYLEAF_TOON_VARIANTS(RAYLEAF_ENUMERATOR) };
enum class HairVariant : uint8_t { RAYLEAF_HAIR_VARIANTS(RAYLEAF_ENUMERATOR) };
enum class HairColoring : uint8_t { RAYLEAF_HAIR_FIBRE_VARIANTS(RAYLEAF_ENUMERATOR) };
enum class PhaseVariant : uint8_t { RAYLEAF_PHASE_VARIANTS(RAYLEAF_ENUMERATOR) };
#undef RAYLEAF_ENUMERATOR

/// The variant of `noise`, which no text names: what the operations after it read. Unread counts as all.
enum class NoiseUse : uint8_t { Unread, Factor, All };

/// The texts an operation takes, in the order of its enumeration; empty if it takes none.
std::span<const std::string_view> variants_of(Operation operation);

}  // namespace rayleaf
