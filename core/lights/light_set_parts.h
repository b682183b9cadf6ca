// What a LightSet holds, for the files that make and ask it.
#pragma once

#include "base/short_list.h"
#include "lights/chosen_light.h"
#include "lights/light.h"
#include "lights/light_groups.h"
#include "lights/light_tree.h"
#include "lights/scene_lamp.h"
#include "lights/surface_light.h"
#include "lights/world_light.h"

namespace rayleaf {

struct LightSet::Implementation {
    std::vector<PlacedLamp> lamps;  ///< the tree's items start with these, then come the surfaces'
    std::vector<DistantLamp> suns;
    size_t lamps_with_size = 0;  ///< the first of the lamps: those that rays can hit
    LightTree hittable{{}};      ///< over those
    const Tracer& tracer;
    SurfaceLights surfaces;
    Blocking blocks;
    WorldEmission world_emission;
    uint8_t world_visibility;
    LampEmission lamp_emission;
    std::shared_ptr<const WorldLight> world;
    LightTree tree{{}};
    bool has_links = false;  ///< some light does not shine on all, or has no shadows of some
    std::vector<uint32_t> emitters_with_blockers;

    Implementation(const std::vector<EmittingInstance>& emitters, const Tracer& tracer_of_scene, Emissions emissions,
                   const CancelToken& cancel)
        : tracer(tracer_of_scene),
          surfaces(emitters, tracer, std::move(emissions.surface), std::move(emissions.even), cancel),
          blocks(std::move(emissions.blocks)),
          world_emission(std::move(emissions.world)),
          world_visibility(emissions.world_visibility),
          lamp_emission(std::move(emissions.lamp)) {}

    void add(const Lamp& lamp, size_t number);
    void build_tree(const CancelToken& cancel);
    /// What light from a place meets on its way.
    std::optional<LightTree::Obstacle> obstacle(const Vec3d& from, const Vec3d& direction) const;

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
        return has_groups() ? groups(at, room).of_tree() : 1.0;
    }
    /// Of choosing this item of the tree.
    double probability(const LitPoint& at, uint32_t item) const {
        Maybe<LightGroups> room;
        const LightGroups& known = groups(at, room);
        return known.of_tree() * tree.probability(at, item, reaches(at.position), known.first_of_tree);
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
    /// What the lamp's program is asked about light from a place of it, of suns a direction, along `direction` to who
    /// sees it at a distance. Here and elsewhere what is asked is filled in its place: a copy would wait for its parts.
    static void ask(LampPoint& point, const LampTraits& lamp, const Vec3d& place, const Vec3d& direction,
                    double distance, const PathState& path) {
        point.lamp = lamp.number;
        point.position = place;
        point.outgoing = -Vec3f(direction);
        point.path = path;
        point.path.ray_length = static_cast<float>(distance);
    }
    /// A light that is chosen with a probability, and of which it is still to be asked what it emits.
    struct Waiting {
        LightQuery* query;
        double probability;

        LightSample& light() const { return *query->light; }
        void finish() const { choose_by(probability, query->light); }
    };
    /// What programs are asked, for queries that come together.
    struct Asked {
        ShortList<Waiting, kMostTogether> in_world, lamps, surfaces;
        ShortList<LampPoint, kMostTogether> lamp_points;
        ShortList<SurfaceLights::Wanted, kMostTogether> elements;
    };
    /// What `choose` knows of its light when it has come to the tree.
    struct InTree {
        double choice;       ///< what is left of its random number
        double probability;  ///< of the tree
        Float4 first;        ///< weights of the tree's first branch
    };
    bool asks_path() const {
        const auto has_program = [](const auto& lamp) { return lamp.traits.has_program; };
        return world || surfaces.count() > 0 || std::ranges::any_of(lamps, has_program) ||
               std::ranges::any_of(suns, has_program);
    }
    /// Completes the sample of a lamp that was chosen, as far as its program need not be asked.
    void complete(const LampTraits& lamp, const Waiting& chosen, Asked& asked) const;
    void sample_sun(const DistantLamp& lamp, const Waiting& chosen, const Vec2f& random, Asked& asked) const;
    void sample_world(const Waiting& chosen, const Vec2f& random, Asked& asked) const;
    void sample_tree(LightQuery& query, const InTree& in_tree, Asked& asked) const;
    void choose(LightQuery& query, Asked& asked) const;
    void see_world(Asked& asked) const;
    void ask_lamps(Asked& asked) const;
    void ask_surfaces(Asked& asked) const;
    /// At most kMostTogether.
    void sample(std::span<LightQuery> queries) const;
};

}  // namespace rayleaf
