// The choice of a light: first among each sun, the world, and all lights that have a place; then among those by the
// tree. Many are made together: what their lights emit is then asked of each program for all at once.
#include "lights/chosen_light.h"
#include "lights/light_set_parts.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace rayleaf {

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

void LightSet::Implementation::complete(const LampTraits& lamp, const Waiting& chosen, Asked& asked) const {
    if (!chosen.query->light) return;
    LightSample& light = chosen.light();
    light.visibility = lamp.visibility;
    light.casts_shadow = lamp.casts_shadow;
    light.lamp_group = lamp.light_group;
    light.blockers = lamp.link.blockers;
    if (!lamp.has_program) return chosen.finish();
    const Vec3d direction(light.direction), place = std::isfinite(light.distance) ? light.target : direction;
    ask(asked.lamp_points.add(), lamp, place, direction, light.distance, chosen.query->path);
    asked.lamps.add(chosen);
}

void LightSet::Implementation::sample_sun(const DistantLamp& lamp, const Waiting& chosen, const Vec2f& random,
                                          Asked& asked) const {
    chosen.query->light = lamp.sun.sample(random);
    complete(lamp.traits, chosen, asked);
}

void LightSet::Implementation::sample_world(const Waiting& chosen, const Vec2f& random, Asked& asked) const {
    chosen.query->light = world->sample(random);
    chosen.light().visibility = static_cast<uint16_t>(seen_by(world_visibility | kOfFootage));
    asked.in_world.add(chosen);
}

void LightSet::Implementation::sample_tree(LightQuery& query, const InTree& in_tree, Asked& asked) const {
    const LitPoint& at = *query.at;
    const std::optional<LightTree::Choice> chosen =
        tree.choose(at, in_tree.choice, reaches(at.position), in_tree.first);
    if (!chosen) return;
    const uint32_t item = chosen->item;
    const Waiting waiting{&query, chosen->probability * in_tree.probability};
    const Vec2f random(below_one(chosen->left_over), query.random.y);
    if (item < lamps.size()) {
        query.light = lamps[item].sample(at.position, random);
        complete(lamps[item].traits, waiting, asked);
    } else {
        asked.surfaces.add(waiting);
        asked.elements.add(static_cast<uint32_t>(item - lamps.size()), random, &query);
    }
}

void LightSet::Implementation::choose(LightQuery& query, Asked& asked) const {
    LitPoint& at = *query.at;
    query.light.reset();
    if (!has_groups()) return sample_tree(query, {double{query.random.x}, 1.0, nullptr}, asked);
    const LightGroups& groups = at.groups ? *at.groups : weigh(at, at.groups);
    if (!(groups.total.cosine > 0.0)) return;
    double choice = query.random.x;
    const auto within = [&](double probability) { return Vec2f(below_one(choice / probability), query.random.y); };
    const DistantLamp* last = nullptr;
    for (const DistantLamp& lamp : suns) {
        if (!shines_on(at, lamp.traits)) continue;
        const double probability = groups.probability(weight(lamp, at));
        if (choice < probability) return sample_sun(lamp, {&query, probability}, within(probability), asked);
        choice -= probability;
        last = &lamp;
    }
    if (world) {
        const double probability = groups.probability(world_weight(at));
        if (choice < probability || !groups.has_tree)
            return sample_world({&query, probability}, within(probability), asked);
        choice -= probability;
    }
    if (!groups.has_tree) {  // rounding may leave `choice` just past the last sun
        if (!last) return;
        const double probability = groups.probability(weight(*last, at));
        return sample_sun(*last, {&query, probability}, within(probability), asked);
    }
    const double probability = groups.tree_probability();
    const double left_over = std::clamp(choice / probability, 0.0, 1.0 - 0x1p-53);
    sample_tree(query, {left_over, probability, &groups.first_of_tree}, asked);
}

void LightSet::Implementation::see_world(Asked& asked) const {
    if (asked.in_world.empty()) return;
    ShortList<WorldDirection, kMostTogether> seen;
    for (const Waiting& waiting : asked.in_world) {
        WorldDirection& each = seen.add();
        each.direction = waiting.light().direction;
        each.path = waiting.query->path;
    }
    std::array<Color, kMostTogether> radiances;
    world_emission(seen.all(), radiances.data());
    for (size_t i = 0; i < seen.size(); ++i) {
        asked.in_world[i].light().radiance = radiances[i];
        asked.in_world[i].finish();
    }
}

void LightSet::Implementation::ask_lamps(Asked& asked) const {
    if (asked.lamps.empty()) return;
    std::array<Color, kMostTogether> factors;
    lamp_emission(asked.lamp_points.all(), factors.data());
    for (size_t i = 0; i < asked.lamps.size(); ++i) {
        asked.lamps[i].light().radiance *= factors[i];
        asked.lamps[i].finish();
    }
}

void LightSet::Implementation::ask_surfaces(Asked& asked) const {
    if (asked.surfaces.empty()) return;
    surfaces.sample(asked.elements.all());
    for (const Waiting& waiting : asked.surfaces)
        if (waiting.query->light) waiting.finish();
}

void LightSet::Implementation::sample(std::span<LightQuery> queries) const {
    Asked asked;
    for (LightQuery& query : queries) choose(query, asked);
    see_world(asked);
    ask_lamps(asked);
    ask_surfaces(asked);
}

void LightSet::sample(std::span<LightQuery> queries) const {
    for (size_t first = 0; first < queries.size(); first += kMostTogether)
        implementation_->sample(queries.subspan(first, std::min(kMostTogether, queries.size() - first)));
}

Maybe<LightSample> LightSet::sample(const LitPoint& at, const Vec2f& random, float time, const PathState& path) const {
    LitPoint weighed = at;
    LightQuery query{&weighed, random, time, path, {}};
    implementation_->sample({&query, 1});
    return query.light;
}

}  // namespace rayleaf
