// The choice of a light: first among each sun, the world, and all lights that have a place; then among those by the
// tree. Many are made together: what their lights emit is then asked of each program for all at once.
#include "lights/chosen_light.h"
#include "lights/light_set_parts.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace rayleaf {

const LightGroups& LightSet::Implementation::weigh(const LitPoint& at, Maybe<LightGroups>& room) const {
    constexpr LightGroups::Weight kAll{1.0, 1.0}, kNone{};
    const bool in_tree = tree.shines_on(at), is_one_of_several = has_groups() || tree.count() > 1;
    const Float4 first = in_tree && is_one_of_several ? tree.first_weights(at, reaches(at.position)) : Float4{};
    const LightGroups::Weight of_world = world ? world_weight(at) : kNone;
    LightGroups::Weight of_tree = in_tree ? kAll : kNone;
    if (in_tree && has_groups()) of_tree = tree.weight(at, first, reaches(at.position));
    if (!(of_tree.irradiance > 0.0)) of_tree = kNone;
    LightGroups::Weight total = of_world + of_tree;
    for (const DistantLamp& lamp : suns)
        if (shines_on(at, lamp.traits)) total = total + weight(lamp, at);
    LightGroups& result = room.emplace(total);
    result.divide(of_world, of_tree, [&] {
        double sum = 0;
        for (const DistantLamp& lamp : suns)
            if (shines_on(at, lamp.traits)) sum += result.probability(weight(lamp, at));
        return sum;
    });
    result.first_of_tree = in_whole_parts(first, result.of_tree() * kPartsOfChoice);
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
    const LightGroups& groups = at.groups ? *at.groups : weigh(at, at.groups);
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
    if (const double probability = groups.of_world(); probability > 0.0) {
        if (choice < probability || !(groups.of_tree() > 0.0))
            return sample_world({&query, probability}, within(probability), asked);
        choice -= probability;
    }
    if (const double probability = groups.of_tree(); probability > 0.0) {
        const double left_over = std::clamp(choice / probability, 0.0, 1.0 - 0x1p-53);
        sample_tree(query, {left_over, probability, groups.first_of_tree}, asked);
    } else if (last) {  // rounding may leave `choice` just past the last sun
        const double of_last = groups.probability(weight(*last, at));
        sample_sun(*last, {&query, of_last}, within(of_last), asked);
    }
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
