// All lights of a scene: how they are kept, the densities with which they are chosen, and what rays meet of them.
#include "lights/chosen_light.h"
#include "lights/light_set_parts.h"
#include "lights/mean_factor.h"

#include <algorithm>
#include <cmath>

namespace rayleaf {
namespace {

bool shines(const Lamp& lamp) {
    return is_finite(lamp.strength) && !is_black(lamp.strength);
}

}  // namespace

void LightSet::Implementation::add(const Lamp& lamp, size_t number) {
    has_links |= lamp.link != LightLink();
    const LampTraits traits{static_cast<uint16_t>(seen_by(lamp.visibility)),
                            lamp.link,
                            lamp.casts_shadow,
                            number,
                            lamp.emission != nullptr,
                            mean_factor(lamp, number, lamp_emission),
                            lamp.light_group};
    switch (lamp.kind) {
        case LampKind::Sun:
            suns.push_back({Sun(lamp), traits});
            return;
        case LampKind::Rectangle:
        case LampKind::Disk:
            lamps.push_back({AreaLamp(lamp), traits});
            break;
        case LampKind::Point:
        case LampKind::Spot:
            lamps.push_back({PointLamp(lamp), traits});
            break;
    }
}

void LightSet::Implementation::build_tree(const CancelToken& cancel) {
    const auto others =
        std::stable_partition(lamps.begin(), lamps.end(), [](const PlacedLamp& lamp) { return lamp.has_size(); });
    lamps_with_size = static_cast<size_t>(others - lamps.begin());
    std::vector<LightTreeItem> items;
    for (const PlacedLamp& lamp : lamps) items.push_back(lamp.tree_item());
    hittable = LightTree({items.begin(), items.begin() + static_cast<ptrdiff_t>(lamps_with_size)}, cancel);
    const std::vector<LightTreeItem> of_surfaces = surfaces.tree_items(cancel);
    items.insert(items.end(), of_surfaces.begin(), of_surfaces.end());
    tree = LightTree(items, cancel);
    tree.look_around([this](const Vec3d& from, const Vec3d& along) { return obstacle(from, along); }, cancel);
}

/// What lets light through is passed, but for the few times that would take long.
std::optional<LightTree::Obstacle> LightSet::Implementation::obstacle(const Vec3d& from, const Vec3d& direction) const {
    constexpr int kMostPassed = 8;
    // Surfaces are seen coarsely: a ray stands for many directions, from anywhere on the light.
    constexpr float kSpread = 0.2f, kWidth = 0.01f;
    const double size = tracer.bounds().size().length(), step = 1e-6 * size;
    Ray ray;
    ray.direction = direction;
    ray.beam = RayBeam::cone(kWidth * static_cast<float>(size), kSpread);
    double passed = step;
    for (int i = 0; i <= kMostPassed; ++i) {
        ray.origin = from + direction * passed;
        const Maybe<Hit> hit = tracer.closest_hit(ray, kVisibleShadow);
        if (!hit) return std::nullopt;
        passed += hit->t;
        if (blocks(hit->instance, hit->local)) {
            const Vec3d normal(tracer.surface_point(hit->instance, hit->local).facet_normal);
            return LightTree::Obstacle{passed, normal.dot(direction) < 0.0 ? normal : -normal};
        }
        passed += step;
    }
    return std::nullopt;
}

LightSet::LightSet(const std::vector<Lamp>& lamps, const std::vector<EmittingInstance>& emitters, const Tracer& tracer,
                   Emissions emissions, std::shared_ptr<const WorldLight> world_light, const CancelToken& cancel)
    : implementation_(std::make_unique<Implementation>(emitters, tracer, std::move(emissions), cancel)) {
    Implementation& set = *implementation_;
    for (size_t i = 0; i < lamps.size(); ++i)
        if (shines(lamps[i])) set.add(lamps[i], i);
    for (const EmittingInstance& emitter : emitters) {
        set.has_links |= emitter.link != LightLink();
        if (emitter.link.blockers >= 0) set.emitters_with_blockers.push_back(emitter.instance);
    }
    if (world_light && !world_light->is_uniform()) set.world = std::move(world_light);
    set.build_tree(cancel);
    empty_ = set.suns.empty() && !set.world && set.tree.empty();
    holds_several_ = set.lamps.size() + set.suns.size() + emitters.size() + (set.world ? 1 : 0) > 1;
    asks_path_ = set.asks_path();
}

LightSet::~LightSet() = default;

PassedLights LightSet::passed(const Ray& ray, double end, const LitPoint& likely, float random) const {
    const Implementation& set = *implementation_;
    PassedLights result;
    result.far_share = 1.0 - set.tree_probability(likely);
    const auto add = [&](uint32_t item) {
        const LightTree::Light light = set.tree.light(item);
        std::optional<LitPart> part = LitPart{0.0, end};
        if (item < set.lamps.size()) part = set.lamps[item].lit_part_of(ray, end);
        if (part && (light.set & likely.lit_by) != 0)
            result.lights[result.count++] = {light.center, light.radius, light.intensity, part->begin, part->end};
    };
    if (set.tree.count() > PassedLights::kMost) {
        const auto choose = [&](const auto& reaches) {
            return set.tree.choose(likely, random, reaches, set.tree.first_weights(likely, reaches));
        };
        auto chosen = choose(set.reaches(likely.position));
        // Elsewhere on its way the ray may be lit by those that do not reach the likely place.
        if (!chosen) chosen = choose([](uint32_t) { return true; });
        if (chosen) add(chosen->item);
    } else {
        for (uint32_t item = 0; item < set.tree.count(); ++item) add(item);
    }
    return result;
}

PassedLights LightSet::placed(LightSets lit_by) const {
    const LightTree& tree = implementation_->tree;
    PassedLights result;
    for (uint32_t item = 0; tree.count() <= PassedLights::kMost && item < tree.count(); ++item)
        if (const LightTree::Light light = tree.light(item); (light.set & lit_by) != 0)
            result.lights[result.count++] = {light.center, light.radius, light.intensity, 0.0, 0.0};
    return result;
}

bool LightSet::weighs_passed() const {
    const Implementation& set = *implementation_;
    return set.has_groups() || set.tree.count() > PassedLights::kMost;
}

float LightSet::emitter_density(const LitPoint& from, const SurfacePoint& point) const {
    const Implementation& set = *implementation_;
    const std::optional<uint32_t> item = set.surfaces.item_of(point);
    if (!item || (set.surfaces.link(*item).set() & from.lit_by) == 0) return 0.0f;
    const auto in_tree = static_cast<uint32_t>(*item + set.lamps.size());
    const double choice = set.probability(from, in_tree);
    return static_cast<float>(std::min(choice * set.surfaces.density(*item, from.position, point), kLargestDensity));
}

float LightSet::world_density(const Vec3f& direction, const LitPoint& from) const {
    const Implementation& set = *implementation_;
    if (!set.world) return 0.0f;
    Maybe<LightGroups> room;
    return static_cast<float>(set.groups(from, room).of_world() * set.world->density(direction));
}

void LightSet::lamp_hits(const Ray& ray, double end, const LitPoint& from, Visibility kind, const PathState& path,
                         const std::function<void(const LampHit&)>& add) const {
    const Implementation& set = *implementation_;
    const auto report = [&](const LampTraits& lamp, const LampIntersection& hit, double choice) {
        Color radiance = hit.radiance;
        if (lamp.has_program) {
            const bool is_far = !std::isfinite(hit.t);
            const Vec3d place = is_far ? ray.direction : ray.at(hit.t);
            // As for one that is sampled, however the ray came here through what is transparent.
            const double distance = is_far ? hit.t : (place - from.position).length();
            LampPoint seen;
            Color factor;
            Implementation::ask(seen, lamp, place, ray.direction, distance, path);
            set.lamp_emission({&seen, 1}, &factor);
            radiance *= factor;
        }
        add({hit.t, radiance, static_cast<float>(std::min(hit.density * choice, kLargestDensity)), lamp.light_group,
             lamp.link.blockers});
    };
    set.hittable.visit_crossed(ray, end, [&](uint32_t item) {
        const PlacedLamp& lamp = set.lamps[item];
        if (!(lamp.traits.visibility & kind) || !set.shines_on(from, lamp.traits)) return;
        const auto hit = std::visit([&](const auto& shape) { return shape.hit(ray, end, from.position); }, lamp.shape);
        if (hit) report(lamp.traits, *hit, set.probability(from, item));
    });
    if (std::isfinite(end)) return;
    Maybe<LightGroups> room;
    for (const DistantLamp& lamp : set.suns) {
        if (!(lamp.traits.visibility & kind) || !set.shines_on(from, lamp.traits)) continue;
        if (const auto hit = lamp.sun.hit(ray))
            report(lamp.traits, *hit, set.groups(from, room).probability(set.weight(lamp, from)));
    }
}

bool LightSet::may_meet_lamps(const Ray& ray, double end) const {
    const Implementation& set = *implementation_;
    const auto may_be_met = [&](uint32_t item) { return set.lamps[item].may_be_met(ray, end); };
    return set.hittable.any_crossed(ray, end, may_be_met) ||
           (!std::isfinite(end) &&
            std::ranges::any_of(set.suns, [&](const DistantLamp& lamp) { return lamp.sun.is_met(ray); }));
}

std::optional<float> LightSet::brightness_along(const Ray& ray, Visibility kind, const PathState& path,
                                                float least) const {
    const Implementation& set = *implementation_;
    constexpr double kNowhere = std::numeric_limits<double>::infinity();
    bool may_end_on_surface = false;
    double far = 0, lamp_end = kNowhere, of_lamp = 0;
    const auto brightness = [](const LampTraits& lamp, const LampIntersection& hit) {
        return double{max_component(hit.radiance)} * lamp.factor;
    };
    for (const DistantLamp& lamp : set.suns)
        if (const auto hit = lamp.sun.hit(ray); hit && (lamp.traits.visibility & kind))
            far = std::max(far, brightness(lamp.traits, *hit));
    if (set.world && (set.world_visibility & kind))  // a density of what makes the irradiance all around
        far = std::max(far, set.world->density(Vec3f(ray.direction)) * 4.0 * set.world->irradiance());
    set.tree.visit_crossed(ray, kNowhere, [&](uint32_t item) {
        if (item >= set.lamps.size()) {
            may_end_on_surface = may_end_on_surface || set.tree.is_crossed(item, ray);
            return;
        }
        const PlacedLamp& lamp = set.lamps[item];
        if (!(lamp.traits.visibility & kind) || !lamp.has_size()) return;
        const auto hit = lamp.hit(ray, lamp_end, ray.origin);
        if (!hit || !(hit->t < lamp_end)) return;
        lamp_end = hit->t;
        of_lamp = brightness(lamp.traits, *hit);
    });
    if (!may_end_on_surface && !(far > least) && !(of_lamp > least)) return std::nullopt;
    const Maybe<Hit> hit = set.surfaces.tracer().closest_hit(ray, kind);
    if (lamp_end < (hit ? hit->t : kNowhere)) return static_cast<float>(of_lamp);
    return hit ? set.surfaces.brightness(ray, *hit, path) : static_cast<float>(far);
}

bool LightSet::has_links() const {
    return implementation_->has_links;
}

const std::vector<uint32_t>& LightSet::emitters_with_blockers() const {
    return implementation_->emitters_with_blockers;
}

bool LightSet::has_hittable_lamps_with_blockers() const {
    const Implementation& set = *implementation_;
    return std::ranges::any_of(
               set.lamps, [](const PlacedLamp& lamp) { return lamp.has_size() && lamp.traits.link.blockers >= 0; }) ||
           std::ranges::any_of(
               set.suns, [](const DistantLamp& lamp) { return lamp.sun.has_size() && lamp.traits.link.blockers >= 0; });
}

size_t LightSet::bytes() const {
    const Implementation& set = *implementation_;
    return sizeof(Implementation) + set.lamps.capacity() * sizeof(PlacedLamp) +
           set.suns.capacity() * sizeof(DistantLamp) + set.surfaces.bytes() + set.tree.bytes() + set.hittable.bytes() +
           (set.world ? set.world->bytes() : 0);
}

size_t LightSet::count() const {
    const Implementation& set = *implementation_;
    return set.lamps.size() + set.suns.size() + set.surfaces.count() + (set.world ? 1 : 0);
}

}  // namespace rayleaf
