// All lights of a scene, and the choice of one: first among each sun, the world, and all lights that have a place; then
// among those by the tree.
#include "lights/chosen_light.h"
#include "lights/light.h"
#include "lights/light_groups.h"
#include "lights/light_tree.h"
#include "lights/mean_factor.h"
#include "lights/scene_lamp.h"
#include "lights/surface_light.h"
#include "lights/world_light.h"

#include <algorithm>
#include <cmath>

namespace rayleaf {
namespace {

bool shines(const Lamp& lamp) {
    return is_finite(lamp.strength) && !is_black(lamp.strength);
}

}  // namespace

struct LightSet::Implementation {
    std::vector<PlacedLamp> lamps;  ///< the tree's items start with these, then come the surfaces'
    std::vector<DistantLamp> suns;
    size_t lamps_with_size = 0;  ///< the first of the lamps: those that rays can hit
    LightTree hittable{{}};      ///< over those
    SurfaceLights surfaces;
    WorldEmission world_emission;
    uint8_t world_visibility;
    LampEmission lamp_emission;
    std::shared_ptr<const WorldLight> world;
    LightTree tree{{}};
    bool has_links = false;  ///< some light does not shine on all, or has no shadows of some
    std::vector<uint32_t> emitters_with_blockers;

    Implementation(const std::vector<EmittingInstance>& emitters, const Tracer& tracer, Emissions emissions)
        : surfaces(emitters, tracer, std::move(emissions.surface), std::move(emissions.even)),
          world_emission(std::move(emissions.world)),
          world_visibility(emissions.world_visibility),
          lamp_emission(std::move(emissions.lamp)) {}

    void add(const Lamp& lamp, size_t number);
    void build_tree(const CancelToken& cancel);

    /// Whether light of the tree's item arrives at a position; the choice inside the tree asks it.
    auto reaches(const Vec3d& position) const {
        return [this, &position](uint32_t item) { return item >= lamps.size() || lamps[item].reaches(position); };
    }
    /// Where suns and the world shine as well as the tree.
    bool has_groups() const { return !suns.empty() || world; }
    const LightGroups& weigh(const LitPoint& at, Maybe<LightGroups>& result) const;
    /// As they were found before, or in `room`.
    const LightGroups& groups(const LitPoint& at, Maybe<LightGroups>& room) const {
        return at.groups ? *at.groups : weigh(at, room);
    }
    /// Of lights that have a place, where any shines on the point.
    double tree_probability(const LitPoint& at) const {
        Maybe<LightGroups> room;
        return has_groups() ? groups(at, room).tree_probability() : 1.0;
    }
    /// Of choosing this item of the tree.
    double probability(const LitPoint& at, uint32_t item) const {
        const Float4* first = at.groups ? &at.groups->first_of_tree : nullptr;
        return tree_probability(at) * tree.probability(at, item, reaches(at.position), first);
    }
    static LightGroups::Weight weight(const DistantLamp& lamp, const LitPoint& at) {
        const double cosine = lamp.sun.cosine(at.normal);
        return {cosine, lamp.irradiance() * cosine};
    }
    LightGroups::Weight world_weight(const LitPoint& at) const {
        const double cosine = mean_cosine(at);
        return {0.5 * (1.0 + cosine) * world->share(), world->irradiance() * cosine};
    }
    bool shines_on(const LitPoint& at, const LampTraits& lamp) const {
        return !has_links || (lamp.link.set() & at.lit_by) != 0;
    }
    /// What `sample` knows of its light when it has come to the tree.
    struct InTree {
        double choice;        ///< what is left of its random number
        double probability;   ///< of the tree
        const Float4* first;  ///< LightTree::first_weights if they are known, else null
    };
    /// What the lamp's program makes of light from a place of it, of suns a direction, along `direction` to who sees
    /// it at a distance.
    Color shaded(const LampTraits& lamp, const Color& radiance, const Vec3d& place, const Vec3d& direction,
                 double distance, const PathState& path) const {
        return radiance * lamp_emission({lamp.number, place, -Vec3f(direction), of_length(path, distance)});
    }
    /// Completes a sample of a lamp that was chosen with this probability; makes it empty where nothing arrives.
    void complete(const LampTraits& lamp, double probability, const PathState& path, Maybe<LightSample>& light) const;
    bool asks_path() const {
        const auto has_program = [](const auto& lamp) { return lamp.traits.has_program; };
        return world || surfaces.count() > 0 || std::ranges::any_of(lamps, has_program) ||
               std::ranges::any_of(suns, has_program);
    }
    Maybe<LightSample> sample_sun(const DistantLamp& lamp, double probability, const Vec2f& random,
                                  const PathState& path) const;
    Maybe<LightSample> sample_world(double probability, const Vec2f& random, const PathState& path) const;
    Maybe<LightSample> sample_lamp(const PlacedLamp& lamp, const Vec3d& position, double probability,
                                   const Vec2f& random, const PathState& path) const;
    Maybe<LightSample> sample_tree(const LitPoint& at, float random_y, const InTree& in_tree, float time,
                                   const PathState& path) const;
    Maybe<LightSample> sample_surface(uint32_t surface, const Vec3d& position, double probability, const Vec2f& random,
                                      float time, const PathState& path) const;
};

const LightGroups& LightSet::Implementation::weigh(const LitPoint& at, Maybe<LightGroups>& room) const {
    LightGroups& result = room.emplace();
    for (const DistantLamp& lamp : suns)
        if (shines_on(at, lamp.traits)) result.add(weight(lamp, at));
    if (world) result.add(world_weight(at));
    if (tree.shines_on(at)) {
        result.first_of_tree = tree.first_weights(at, reaches(at.position));
        const LightGroups::Weight of_tree = tree.weight(at, result.first_of_tree, reaches(at.position));
        result.has_tree = of_tree.irradiance > 0.0;
        if (result.has_tree) result.of_tree = of_tree;
    }
    result.add(result.of_tree);
    result.complete();
    return result;
}

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
}

LightSet::LightSet(const std::vector<Lamp>& lamps, const std::vector<EmittingInstance>& emitters, const Tracer& tracer,
                   Emissions emissions, std::shared_ptr<const WorldLight> world_light, const CancelToken& cancel)
    : implementation_(std::make_unique<Implementation>(emitters, tracer, std::move(emissions))) {
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

void LightSet::Implementation::complete(const LampTraits& lamp, double probability, const PathState& path,
                                        Maybe<LightSample>& light) const {
    if (!light) return;
    if (lamp.has_program) {
        const Vec3d direction(light->direction), place = std::isfinite(light->distance) ? light->target : direction;
        light->radiance = shaded(lamp, light->radiance, place, direction, light->distance, path);
    }
    light->visibility = lamp.visibility;
    light->casts_shadow = lamp.casts_shadow;
    light->lamp_group = lamp.light_group;
    light->blockers = lamp.link.blockers;
    choose_by(probability, light);
}

Maybe<LightSample> LightSet::Implementation::sample_sun(const DistantLamp& lamp, double probability,
                                                        const Vec2f& random, const PathState& path) const {
    Maybe<LightSample> light = lamp.sun.sample(random);
    complete(lamp.traits, probability, path, light);
    return light;
}

Maybe<LightSample> LightSet::Implementation::sample_world(double probability, const Vec2f& random,
                                                          const PathState& path) const {
    Maybe<LightSample> light = world->sample(random);
    light->radiance = world_emission(light->direction, path);
    light->visibility = static_cast<uint16_t>(seen_by(world_visibility | kOfFootage));
    choose_by(probability, light);
    return light;
}

Maybe<LightSample> LightSet::Implementation::sample_lamp(const PlacedLamp& lamp, const Vec3d& position,
                                                         double probability, const Vec2f& random,
                                                         const PathState& path) const {
    Maybe<LightSample> light = lamp.sample(position, random);
    complete(lamp.traits, probability, path, light);
    return light;
}

Maybe<LightSample> LightSet::Implementation::sample_surface(uint32_t surface, const Vec3d& position, double probability,
                                                            const Vec2f& random, float time,
                                                            const PathState& path) const {
    Maybe<LightSample> light = surfaces.sample(surface, position, random, time, path);
    if (light) choose_by(probability, light);
    return light;
}

Maybe<LightSample> LightSet::Implementation::sample_tree(const LitPoint& at, float random_y, const InTree& in_tree,
                                                         float time, const PathState& path) const {
    const std::optional<LightTree::Choice> chosen =
        tree.choose(at, in_tree.choice, reaches(at.position), in_tree.first);
    if (!chosen) return std::nullopt;
    const uint32_t item = chosen->item;
    const double probability = chosen->probability * in_tree.probability;
    const Vec2f random(below_one(chosen->left_over), random_y);
    if (item < lamps.size()) return sample_lamp(lamps[item], at.position, probability, random, path);
    const auto surface = static_cast<uint32_t>(item - lamps.size());
    return sample_surface(surface, at.position, probability, random, time, path);
}

Maybe<LightSample> LightSet::sample(const LitPoint& at, const Vec2f& random, float time, const PathState& path) const {
    const Implementation& set = *implementation_;
    if (!set.has_groups()) return set.sample_tree(at, random.y, {double{random.x}, 1.0, nullptr}, time, path);
    Maybe<LightGroups> room;
    const LightGroups& groups = set.groups(at, room);
    if (!(groups.total.cosine > 0.0)) return std::nullopt;
    double choice = random.x;
    const auto within = [&](double probability) { return Vec2f(below_one(choice / probability), random.y); };
    const DistantLamp* last = nullptr;
    for (const DistantLamp& lamp : set.suns) {
        if (!set.shines_on(at, lamp.traits)) continue;
        const double probability = groups.probability(set.weight(lamp, at));
        if (choice < probability) return set.sample_sun(lamp, probability, within(probability), path);
        choice -= probability;
        last = &lamp;
    }
    if (set.world) {
        const double probability = groups.probability(set.world_weight(at));
        if (choice < probability || !groups.has_tree) return set.sample_world(probability, within(probability), path);
        choice -= probability;
    }
    if (!groups.has_tree) {  // rounding may leave `choice` just past the last sun
        if (!last) return std::nullopt;
        const double probability = groups.probability(set.weight(*last, at));
        return set.sample_sun(*last, probability, within(probability), path);
    }
    const double probability = groups.tree_probability();
    const double left_over = std::clamp(choice / probability, 0.0, 1.0 - 0x1p-53);
    return set.sample_tree(at, random.y, {left_over, probability, &groups.first_of_tree}, time, path);
}

void LightSet::weigh(LitPoint& at) const {
    if (implementation_->has_groups()) implementation_->weigh(at, at.groups);
}

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
        auto chosen = set.tree.choose(likely, random, set.reaches(likely.position));
        // Elsewhere on its way the ray may be lit by those that do not reach the likely place.
        if (!chosen) chosen = set.tree.choose(likely, random, [](uint32_t) { return true; });
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
    return static_cast<float>(std::min(choice * set.surfaces.density(from.position, point), kLargestDensity));
}

float LightSet::world_density(const Vec3f& direction, const LitPoint& from) const {
    const Implementation& set = *implementation_;
    if (!set.world) return 0.0f;
    Maybe<LightGroups> room;
    const double choice = set.groups(from, room).probability(set.world_weight(from));
    return static_cast<float>(choice * set.world->density(direction));
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
            radiance = set.shaded(lamp, radiance, place, ray.direction, distance, path);
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
