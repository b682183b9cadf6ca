#include "shading/operations_closure.h"

#include "shading/microfibres.h"
#include "shading/operations_hair.h"
#include "shading/operations_input.h"
#include "shading/operations_math.h"
#include "shading/operations_microfacet.h"
#include "shading/operations_volume.h"
#include "shading/principled.h"
#include "shading/principled_layers.h"
#include "shading/variants.h"

namespace rayleaf {

Vec3f clearing_normal(const Vec3f& facet_normal, const Vec3f& outgoing, const Vec3f& normal) {
    // The mirror direction rises above the facet by at least this sine, less where the viewer himself is lower.
    constexpr float kLeastRise = 0.01f, kShareOfViewer = 0.9f;
    const float view_z = std::max(facet_normal.dot(outgoing), 0.0f);
    const float wanted = std::min(kLeastRise, kShareOfViewer * view_z);
    const float rise = 2.0f * normal.dot(outgoing) * normal.dot(facet_normal) - facet_normal.dot(outgoing);
    if (rise >= wanted && normal.dot(outgoing) > 0.0f) return normal;
    // In the plane of both normals let the shading normal be tilted by `a` from the facet's, and the viewer lie at
    // angle `phi` and distance `length` from the plane's origin. The mirror direction rises by length cos(2 a - phi).
    const Vec3f across = normalized_or(normal - facet_normal * facet_normal.dot(normal), Vec3f(0.0f));
    const float view_x = across.dot(outgoing);
    const float length = std::hypot(view_x, view_z);
    if (!(length > 0.0f) || is_black(across)) return facet_normal;
    const float phi = std::atan2(view_x, view_z);
    const float half_width = std::acos(std::min(wanted / length, 1.0f));
    const float tilt = std::atan2(normal.dot(across), normal.dot(facet_normal));
    const float a = std::clamp(tilt, 0.5f * (phi - half_width), 0.5f * (phi + half_width));
    return normalized_or(across * std::sin(a) + facet_normal * std::cos(a), facet_normal);
}

Color weight_of(const Operands& operands) {
    return operands.vector(0, Color(1.0f));
}

namespace {

Vec3f wanted_normal(const Operands& operands, uint32_t i, const ShadingInputs& inputs) {
    const Vec3f own = facing_normal(inputs);
    return operands.connected(i) ? normalized_or(operands.vector(i), own) : own;
}

}  // namespace

Vec3f matte_normal(const Operands& operands, uint32_t i, const ShadingInputs& inputs, Clearing clearing) {
    const Vec3f wanted = wanted_normal(operands, i, inputs);
    return clearing == Clearing::All ? clearing_normal(facing_facet_normal(inputs), inputs.outgoing, wanted) : wanted;
}

Vec3f mirror_normal(const Operands& operands, uint32_t i, const ShadingInputs& inputs, Clearing clearing) {
    const Vec3f wanted = wanted_normal(operands, i, inputs);
    return clearing == Clearing::None ? wanted : clearing_normal(facing_facet_normal(inputs), inputs.outgoing, wanted);
}

float index_beyond(float ior, const ShadingInputs& inputs) {
    constexpr float kLeastIndex = 1e-5f;  // as Cycles
    const float inside = std::max(ior, kLeastIndex);
    return is_backfacing(inputs) ? 1.0f / inside : inside;
}

namespace {

Lobe diffuse_lobe(const Operands& operands, std::span<const int32_t> ints, const ShadingInputs& inputs,
                  Clearing clearing) {
    Lobe lobe;
    lobe.type = LobeType::Diffuse;
    lobe.weight = weight_of(operands) * operands.vector(1);
    lobe.roughness = operands.scalar(2);
    if (!ints.empty() && ints[0] != 0) lobe.fresnel_0 = operands.vector(1);
    lobe.normal = matte_normal(operands, 3, inputs, clearing);
    return lobe;
}

Lobe translucent_lobe(const Operands& operands, const ShadingInputs& inputs, Clearing clearing) {
    Lobe lobe;
    lobe.type = LobeType::Translucent;
    lobe.weight = weight_of(operands) * operands.vector(1);
    lobe.normal = mirror_normal(operands, 2, inputs, clearing);  // as Cycles
    return lobe;
}

Lobe velvet_lobe(const Operands& operands, const ShadingInputs& inputs, Clearing clearing) {
    Lobe lobe;
    lobe.type = LobeType::Velvet;
    lobe.kind = LobeKind::Glossy;  // as Cycles' passes have it
    lobe.weight = weight_of(operands) * operands.vector(1);
    lobe.roughness = operands.scalar(2);
    lobe.normal = matte_normal(operands, 3, inputs, clearing);
    return lobe;
}

Lobe microfibre_lobe(const Operands& operands, const ShadingInputs& inputs, Clearing clearing) {
    Lobe lobe;
    lobe.normal = matte_normal(operands, 3, inputs, clearing);
    const Microfibres fibres = microfibres(operands.scalar(2), lobe.normal.dot(inputs.outgoing));
    set_microfibres(lobe, fibres, inputs.outgoing);
    lobe.weight = weight_of(operands) * operands.vector(1) * fibres.albedo;
    return lobe;
}

Lobe toon_lobe(ToonVariant variant, const Operands& operands, std::span<const int32_t> ints,
               const ShadingInputs& inputs, Clearing clearing) {
    Lobe lobe;
    const bool glossy = variant == ToonVariant::GLOSSY;
    lobe.type = glossy ? LobeType::ToonGlossy : LobeType::ToonDiffuse;
    lobe.kind = glossy ? LobeKind::Glossy : LobeKind::Diffuse;
    lobe.weight = weight_of(operands) * operands.vector(1);
    lobe.roughness = operands.scalar(2);
    lobe.softness = operands.scalar(3);
    lobe.in_front = !ints.empty() && ints[0] != 0;
    lobe.normal = matte_normal(operands, 4, inputs, clearing);
    return lobe;
}

SubsurfaceMethod subsurface_method(std::span<const int32_t> ints) {
    return ints.empty() ? SubsurfaceMethod::FixedRadius : static_cast<SubsurfaceMethod>(ints[0]);
}

/// Light that a diffuse lobe has scattered before may leave bodies where it entered them, which is faster: but what is
/// lit from behind lights nothing then. By profiles it always does, as in Cycles: they may add light where a body is
/// thin, and would multiply it from bounce to bounce.
bool leaves_where_it_entered(std::span<const int32_t> ints, const ShadingInputs& inputs) {
    const bool walks_on = ints.size() > 2 && ints[2] != 0 && subsurface_method(ints) != SubsurfaceMethod::Profile;
    return !walks_on && inputs.path.diffuse_depth > 0;
}

SubsurfaceParameters subsurface_parameters(const Operands& operands, std::span<const int32_t> ints,
                                           const ShadingInputs& inputs, Clearing clearing) {
    SubsurfaceParameters p;
    p.albedo = operands.vector(1);
    p.weight = weight_of(operands) * p.albedo;
    p.radius = operands.vector(3) * (leaves_where_it_entered(ints, inputs) ? 0.0f : operands.scalar(2));
    p.ior = operands.scalar(4);
    p.anisotropy = operands.scalar(5);
    p.method = subsurface_method(ints);
    p.normal = mirror_normal(operands, 6, inputs, clearing);
    if (ints.size() > 1 && ints[1] != 0) {
        const float roughness = saturate(operands.scalar(7, 1.0f));
        p.is_refracted = true;
        p.entry_alpha = roughness * roughness;
        p.entry_ior = p.ior;
    }
    return p;
}

PrincipledParameters principled_parameters(PrincipledVariant variant, const Operands& operands,
                                           std::span<const int32_t> ints, const ShadingInputs& inputs,
                                           Clearing clearing) {
    PrincipledParameters p;
    p.multiple_scattering = variant == PrincipledVariant::MULTI_GGX;
    p.weight = weight_of(operands);
    p.base_color = operands.vector(1);
    p.metallic = saturate(operands.scalar(2));
    p.specular = operands.scalar(3);
    p.specular_tint = operands.scalar(4);
    p.roughness = saturate(operands.scalar(5));
    p.anisotropic = saturate(operands.scalar(6));
    p.anisotropic_rotation = operands.scalar(7);
    p.sheen = operands.scalar(8);
    p.sheen_tint = operands.scalar(9);
    p.clearcoat = operands.scalar(10);
    p.clearcoat_roughness = saturate(operands.scalar(11));
    p.ior = index_beyond(operands.scalar(12), inputs);
    p.transmission = saturate(operands.scalar(13));
    p.transmission_roughness = saturate(operands.scalar(14));
    p.emission = operands.vector(15) * operands.scalar(16);
    p.alpha = saturate(operands.scalar(17, 1.0f));
    p.normal = mirror_normal(operands, 18, inputs, clearing);
    p.matte_normal = clearing == Clearing::All ? p.normal : matte_normal(operands, 18, inputs, clearing);
    p.clearcoat_normal = mirror_normal(operands, 19, inputs, clearing);
    p.tangent = operands.vector(20, inputs.point->dp_du);
    p.outgoing = inputs.outgoing;
    p.subsurface = saturate(operands.scalar(21));
    p.subsurface_color = operands.vector(22, p.base_color);
    p.subsurface_radius = operands.vector(23);
    p.subsurface_ior = operands.scalar(24, p.subsurface_ior);
    p.subsurface_anisotropy = operands.scalar(25);
    p.subsurface_method = subsurface_method(ints);
    p.after_diffuse = leaves_where_it_entered(ints, inputs);
    return p;
}

void write_aov(int32_t slot, const Color& value, std::span<Vec4f> aovs) {
    if (slot < 0 || static_cast<size_t>(slot) >= aovs.size() || !is_finite(value)) return;
    aovs[static_cast<size_t>(slot)] += Vec4f(value.x, value.y, value.z, 1.0f);
}

void read_sheen_and_coat(const Operands& operands, PrincipledLayers& p) {
    p.sheen = std::max(operands.scalar(8), 0.0f);
    p.sheen_roughness = saturate(operands.scalar(9));
    p.sheen_tint = not_negative(operands.vector(10));
    p.coat = std::max(operands.scalar(11), 0.0f);
    p.coat_roughness = saturate(operands.scalar(12));
    p.coat_ior = std::max(operands.scalar(13), 1.0f);
    p.coat_tint = not_negative(operands.vector(14));
}

PrincipledLayers principled_layers(PrincipledVariant variant, const Operands& operands, std::span<const int32_t> ints,
                                   const ShadingInputs& inputs, Clearing clearing) {
    constexpr float kLeastIndex = 1e-5f;  // as Cycles
    PrincipledLayers p;
    p.multiple_scattering = variant == PrincipledVariant::MULTI_GGX;
    p.weight = weight_of(operands);
    p.base_color = not_negative(operands.vector(1));
    p.metallic = saturate(operands.scalar(2));
    p.specular_level = std::max(operands.scalar(3), 0.0f);
    p.specular_tint = not_negative(operands.vector(4));
    p.roughness = saturate(operands.scalar(5));
    p.anisotropic = saturate(operands.scalar(6));
    p.rotation = operands.scalar(7);
    read_sheen_and_coat(operands, p);
    p.emission = operands.vector(15) * operands.scalar(16);
    p.alpha = saturate(operands.scalar(17, 1.0f));
    p.ior = std::max(operands.scalar(18), kLeastIndex);
    p.from_inside = is_backfacing(inputs);
    p.transmission = saturate(operands.scalar(19));
    p.normal = mirror_normal(operands, 20, inputs, clearing);
    p.matte_normal = clearing == Clearing::All ? p.normal : matte_normal(operands, 20, inputs, clearing);
    p.coat_normal = mirror_normal(operands, 21, inputs, clearing);
    p.matte_coat_normal = clearing == Clearing::All ? p.coat_normal : matte_normal(operands, 21, inputs, clearing);
    p.tangent = operands.vector(22, inputs.point->dp_du);
    p.outgoing = inputs.outgoing;
    p.diffuse_roughness = saturate(operands.scalar(23));
    p.subsurface = saturate(operands.scalar(24));
    p.subsurface_radius = operands.vector(25);
    p.subsurface_ior = operands.scalar(26, p.subsurface_ior);
    p.subsurface_anisotropy = operands.scalar(27);
    p.subsurface_method = subsurface_method(ints);
    p.film = {operands.scalar(28), operands.scalar(29, p.film.ior)};
    if (ints.size() > 1 && ints[1] != 0) {
        p.film.observer = FilmObserver::Gaussians;
        p.film_on_metal = false;
    }
    p.coat_by_facets = ints.size() > 3 && ints[3] != 0;
    p.is_sheet = operands.scalar(30) > 0.0f;
    p.after_diffuse = leaves_where_it_entered(ints, inputs);
    return p;
}

}  // namespace

void add_closure(Operation operation, uint8_t variant, const Operands& operands, std::span<const int32_t> ints,
                 const ShadingInputs& inputs, Closures& closures) {
    if (operation == Operation::aov) return write_aov(ints[0], operands.vector(0), closures.aovs);
    const Color weight = weight_of(operands);
    if (is_black(weight)) return;
    switch (operation) {
        case Operation::emission:
        case Operation::background:
            closures.emission += weight * operands.vector(1) * operands.scalar(2);
            return;
        case Operation::holdout:
            closures.holdout += (weight.x + weight.y + weight.z) / 3.0f;
            return;
        case Operation::volume_absorption:
        case Operation::volume_scatter:
        case Operation::volume_principled:
            add_volume_closure(operation, variant, operands, inputs, closures);
            return;
        default:
            break;
    }
    if (inputs.point == nullptr) return;  // the world scatters nothing
    const Clearing clearing = closures.clearing;
    switch (operation) {
        case Operation::diffuse:
            closures.add(diffuse_lobe(operands, ints, inputs, clearing));
            return;
        case Operation::translucent:
            closures.add(translucent_lobe(operands, inputs, clearing));
            return;
        case Operation::velvet:
            closures.add(velvet_lobe(operands, inputs, clearing));
            return;
        case Operation::microfibres:
            closures.add(microfibre_lobe(operands, inputs, clearing));
            return;
        case Operation::toon:
            closures.add(toon_lobe(static_cast<ToonVariant>(variant), operands, ints, inputs, clearing));
            return;
        case Operation::glossy:
        case Operation::refraction:
        case Operation::glass:
        case Operation::metal:
            add_microfacets(operation, static_cast<MicrofacetVariant>(variant), operands, ints, inputs, closures);
            return;
        case Operation::smooth_normal:
            closures.smooth_normal = matte_normal(operands, 1, inputs, clearing);
            return;
        case Operation::transparent:
            closures.transparency += weight * operands.vector(1);
            return;
        case Operation::ray_portal: {
            const Vec3f direction = normalized_or(operands.vector(3), -inputs.outgoing);
            closures.add({operands.vector(1) * weight, operands.vector(2), direction});
            return;
        }
        case Operation::hair:
        case Operation::hair_fibre:
        case Operation::hair_facets:
            add_hair(operation, variant, operands, inputs, closures);
            return;
        case Operation::subsurface:
            add_subsurface(subsurface_parameters(operands, ints, inputs, clearing), closures);
            return;
        case Operation::principled:
            add_principled(
                principled_parameters(static_cast<PrincipledVariant>(variant), operands, ints, inputs, clearing),
                closures);
            return;
        case Operation::principled_layers:
            add_principled_layers(
                principled_layers(static_cast<PrincipledVariant>(variant), operands, ints, inputs, clearing), closures);
            return;
        default:
            return;
    }
}

}  // namespace rayleaf
