// A lamp of a scene, of whatever kind, with what all kinds have.
#pragma once

#include "lights/area_lamp.h"
#include "lights/point_lamp.h"
#include "lights/sun.h"

#include <variant>

namespace rayleaf {

struct LampTraits {
    uint16_t visibility;
    LightLink link;
    bool casts_shadow;
    size_t number;  ///< in the list of lamps
    bool has_program;
    double factor;  ///< of the program, in the mean
    int light_group;
};

/// A kind of lamp has the members of PointLamp: what it emits, how it is sampled and hit, its bounds and reach.
struct PlacedLamp {
    std::variant<PointLamp, AreaLamp> shape;
    LampTraits traits;

    bool has_size() const {
        return std::visit([](const auto& lamp) { return lamp.has_size(); }, shape);
    }
    bool reaches(const Vec3d& position) const {
        return std::visit([&](const auto& lamp) { return lamp.reaches(position); }, shape);
    }
    Maybe<LightSample> sample(const Vec3d& position, const Vec2f& random) const {
        return std::visit([&](const auto& lamp) { return lamp.sample(position, random); }, shape);
    }
    bool may_be_met(const Ray& ray, double end) const {
        return std::visit([&](const auto& lamp) { return lamp.may_be_met(ray, end); }, shape);
    }
    std::optional<LampIntersection> hit(const Ray& ray, double end, const Vec3d& from) const {
        return std::visit([&](const auto& lamp) { return lamp.hit(ray, end, from); }, shape);
    }
    std::optional<LitPart> lit_part_of(const Ray& ray, double end) const {
        return std::visit([&](const auto& lamp) { return lamp.lit().part_of(ray, end); }, shape);
    }
    LightTreeItem tree_item() const {
        const auto item = [this](const auto& lamp) {
            return LightTreeItem{lamp.bounds(), lamp.intensity() * traits.factor, traits.link.set(), lamp.cone(),
                                 lamp.is_bounded()};
        };
        return std::visit(item, shape);
    }
};

struct DistantLamp {
    Sun sun;
    LampTraits traits;

    double irradiance() const { return sun.irradiance() * traits.factor; }
};

}  // namespace rayleaf
