#include "integrators/bounces.h"

namespace rayleaf {

void Bounces::scatter(const LobeSample& sample) {
    const bool diffuse = sample.kind == LobeKind::Diffuse;
    state_.camera = false;
    state_.diffuse = diffuse;
    state_.glossy = !diffuse;
    state_.volume = false;
    state_.singular = sample.singular;
    state_.transmission = sample.transmitted;
    state_.reflection = !sample.transmitted;
    sees_film_ &= sample.transmitted && !diffuse && sample.roughness <= settings_.film_glass_roughness;
    passed_ = 0;
    if (!sample.singular) least_density_ = std::min(least_density_, sample.density);
    ++state_.depth;
    is_last_ |= state_.depth > settings_.max_bounces;
    // What went through a surface counts as transmission whatever its lobe, as in Cycles.
    if (sample.transmitted) {
        is_last_ |= ++state_.transmission_depth > settings_.transmission_bounces;
        ray_kind_ = kVisibleTransmission;
    } else if (diffuse) {
        is_last_ |= ++state_.diffuse_depth > settings_.diffuse_bounces;
        ray_kind_ = kVisibleDiffuse;
    } else {
        is_last_ |= ++state_.glossy_depth > settings_.glossy_bounces;
        ray_kind_ = kVisibleGlossy;
    }
}

void Bounces::scatter_in_medium(float density) {
    least_density_ = std::min(least_density_, density);
    state_.camera = state_.diffuse = state_.glossy = state_.singular = state_.transmission = state_.reflection = false;
    state_.volume = true;
    sees_film_ = false;
    passed_ = 0;
    is_last_ |= ++state_.depth > settings_.max_bounces;
    is_last_ |= ++state_.volume_depth > settings_.volume_bounces;
    ray_kind_ = kVisibleVolume;
}

void Bounces::pass_through(double length) {
    passed_ += length;
    ++state_.transparent_depth;
}

void Bounces::simplify(Closures& closures) const {
    if (settings_.drops_caustics && ray_kind_ == kVisibleDiffuse)
        closures.drop_caustics(!settings_.reflective_caustics, !settings_.refractive_caustics);
    constexpr float kWidest = 0.5f;  // Cycles' limit of the roughness
    if (least_density_ < settings_.filter_glossy)
        closures.widen(kWidest * std::sqrt(1.0f - least_density_ / settings_.filter_glossy));
}

PathState Bounces::of_met_lamp() const {
    PathState state = state_;
    state.camera = state.diffuse = state.glossy = state.singular = state.reflection = state.transmission =
        state.volume = false;
    state.depth = std::max(state.depth, 1);
    return state;
}

PathState Bounces::of_sampled_light() const {
    PathState state = of_met_lamp();
    state.depth = state_.depth + 1;
    return state;
}

PathState Bounces::of_shadow_ray() const {
    PathState state = of_sampled_light();
    state.shadow = true;
    return state;
}

}  // namespace rayleaf
