#include "shading/operation.h"

#include "shading/variants.h"

#include <array>

namespace rayleaf {
namespace {

constexpr OperationFamily family(Operation operation) {
    if (operation >= Operation::diffuse) return OperationFamily::Closure;
    switch (operation) {
        case Operation::image:
        case Operation::environment:
            return OperationFamily::Texture;
        case Operation::transform:
        case Operation::wireframe:
        case Operation::ambient_occlusion:
        case Operation::bevel:
        case Operation::raycast:
        case Operation::bump:
        case Operation::fresnel:
        case Operation::layer_weight:
        case Operation::normal_map:
            return OperationFamily::Input;
        default:
            return operation < Operation::math ? OperationFamily::Input : OperationFamily::Arithmetic;
    }
}

/// UDIM tiles of one image.
constexpr int kMostTiles = 1000;

struct IntCounts {
    int least, most;
};

constexpr IntCounts int_counts(Operation operation) {
    switch (operation) {
        case Operation::attribute:
        case Operation::grid_value:
        case Operation::component:
        case Operation::table:
        case Operation::musgrave:
        case Operation::white_noise:
        case Operation::magic:
        case Operation::gabor:
        case Operation::radial_tangent:
        case Operation::box_projection:
        case Operation::aov:
        case Operation::bevel:
            return {1, 1};
        case Operation::noise:
        case Operation::ambient_occlusion:
            return {1, 3};
        case Operation::voronoi:
            return {3, 5};
        case Operation::raycast:
            return {1, 2};
        case Operation::wave:
        case Operation::brick:
            return {2, 2};
        case Operation::transform:
            return {2, 3};
        case Operation::diffuse:
        case Operation::toon:
        case Operation::glossy:
        case Operation::refraction:
            return {0, 1};
        case Operation::uv:
        case Operation::math:
        case Operation::map_range:
        case Operation::vector_rotate:
        case Operation::wireframe:
        case Operation::bump:
        case Operation::principled:
        case Operation::metal:
            return {0, 1};
        case Operation::mix:
        case Operation::normal_map:
        case Operation::tangent:
        case Operation::glass:
            return {0, 2};
        case Operation::subsurface:
            return {0, 3};
        case Operation::principled_layers:
            return {0, 4};
        case Operation::image:
            return {1, 4 + 2 * kMostTiles};
        case Operation::environment:
            return {1, 3};
        default:
            return {0, 0};
    }
}

constexpr OperationInfo describe(Operation operation, std::string_view identifier, int least, int most) {
    const IntCounts ints = int_counts(operation);
    return {identifier,
            least,
            most,
            family(operation),
            ints.least,
            ints.most,
            operation == Operation::table || operation == Operation::ies || operation == Operation::sky};
}

constexpr std::array kOperations = {
#define OPERATION(identifier, least, most, description) describe(Operation::identifier, #identifier, least, most),
#include "shading/operations.def"
#undef OPERATION
};

#define RAYLEAF_NAME(name) #name,
constexpr std::string_view kMath[] = {RAYLEAF_MATH_VARIANTS(RAYLEAF_NAME)};
constexpr std::string_view kVectorMath[] = {RAYLEAF_VECTOR_MATH_VARIANTS(RAYLEAF_NAME)};
constexpr std::string_view kBlend[] = {RAYLEAF_BLEND_VARIANTS(RAYLEAF_NAME)};
constexpr std::string_view kClamp[] = {RAYLEAF_CLAMP_VARIANTS(RAYLEAF_NAME)};
constexpr std::string_view kMapRange[] = {RAYLEAF_MAP_RANGE_VARIANTS(RAYLEAF_NAME)};
constexpr std::string_view kMapping[] = {RAYLEAF_MAPPING_VARIANTS(RAYLEAF_NAME)};
constexpr std::string_view kLayerWeight[] = {RAYLEAF_LAYER_WEIGHT_VARIANTS(RAYLEAF_NAME)};
constexpr std::string_view kNormalMap[] = {RAYLEAF_NORMAL_MAP_VARIANTS(RAYLEAF_NAME)};
constexpr std::string_view kMicrofacet[] = {RAYLEAF_MICROFACET_VARIANTS(RAYLEAF_NAME)};
constexpr std::string_view kPrincipled[] = {RAYLEAF_PRINCIPLED_VARIANTS(RAYLEAF_NAME)};
constexpr std::string_view kLightPath[] = {RAYLEAF_LIGHT_PATH_VARIANTS(RAYLEAF_NAME)};
constexpr std::string_view kFractal[] = {RAYLEAF_FRACTAL_VARIANTS(RAYLEAF_NAME)};
constexpr std::string_view kVoronoi[] = {RAYLEAF_VORONOI_VARIANTS(RAYLEAF_NAME)};
constexpr std::string_view kGradient[] = {RAYLEAF_GRADIENT_VARIANTS(RAYLEAF_NAME)};
constexpr std::string_view kWave[] = {RAYLEAF_WAVE_VARIANTS(RAYLEAF_NAME)};
constexpr std::string_view kVectorRotate[] = {RAYLEAF_VECTOR_ROTATE_VARIANTS(RAYLEAF_NAME)};
constexpr std::string_view kTransform[] = {RAYLEAF_TRANSFORM_VARIANTS(RAYLEAF_NAME)};
constexpr std::string_view kToon[] = {RAYLEAF_TOON_VARIANTS(RAYLEAF_NAME)};
constexpr std::string_view kHair[] = {RAYLEAF_HAIR_VARIANTS(RAYLEAF_NAME)};
constexpr std::string_view kHairFibre[] = {RAYLEAF_HAIR_FIBRE_VARIANTS(RAYLEAF_NAME)};
constexpr std::string_view kPhase[] = {RAYLEAF_PHASE_VARIANTS(RAYLEAF_NAME)};
#undef RAYLEAF_NAME

}  // namespace

const OperationInfo& operation_info(Operation operation) {
    return kOperations[static_cast<size_t>(operation)];
}

std::optional<Operation> operation_named(std::string_view identifier) {
    for (size_t i = 0; i < kOperations.size(); ++i)
        if (kOperations[i].identifier == identifier) return static_cast<Operation>(i);
    return std::nullopt;
}

std::span<const std::string_view> variants_of(Operation operation) {
    switch (operation) {
        case Operation::math:
            return kMath;
        case Operation::volume_scatter:
            return kPhase;
        case Operation::vector_math:
            return kVectorMath;
        case Operation::mix:
            return kBlend;
        case Operation::clamp:
            return kClamp;
        case Operation::map_range:
            return kMapRange;
        case Operation::mapping:
            return kMapping;
        case Operation::layer_weight:
            return kLayerWeight;
        case Operation::normal_map:
            return kNormalMap;
        case Operation::light_path:
            return kLightPath;
        case Operation::musgrave:
            return kFractal;
        case Operation::voronoi:
            return kVoronoi;
        case Operation::gradient:
            return kGradient;
        case Operation::wave:
            return kWave;
        case Operation::vector_rotate:
            return kVectorRotate;
        case Operation::transform:
            return kTransform;
        case Operation::toon:
            return kToon;
        case Operation::hair:
            return kHair;
        case Operation::hair_fibre:
        case Operation::hair_facets:
            return kHairFibre;
        case Operation::glossy:
        case Operation::refraction:
        case Operation::glass:
        case Operation::metal:
            return kMicrofacet;
        case Operation::principled:
        case Operation::principled_layers:
            return kPrincipled;
        default:
            return {};
    }
}

}  // namespace rayleaf
