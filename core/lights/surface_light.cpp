#include "lights/surface_light.h"

#include "base/box_distance.h"
#include "base/short_list.h"
#include "geometry/facet.h"
#include "geometry/triangle_mesh.h"
#include "lights/chosen_light.h"

#include <algorithm>
#include <array>

#include <tbb/parallel_for.h>

namespace rayleaf {
namespace {

/// Per solid angle, of a place that is so far off.
double density_at(const Vec3d& offset, double distance, const Vec3d& area) {
    const double density = distance * distance * distance / std::abs(offset.dot(area));
    return std::isfinite(density) ? std::min(density, kLargestDensity) : 0.0;
}

}  // namespace

bool SurfaceLights::is_at_rest(uint32_t instance) const {
    const TracedInstance& traced = tracer_.instance(instance);
    return traced.shape->kind() == ShapeKind::TriangleMesh && !traced.motion && !traced.shape->deforms();
}

StillTriangle SurfaceLights::at_rest(const Element& of) const {
    const Shape& shape = *tracer_.instance(of.instance).shape;
    const ElementPoint middle = shape.element_point(of.element, Vec2f(1.0f / 3.0f));
    StillTriangle result;
    const Affine3d local_to_world = tracer_.local_to_world(of.instance, kMiddleTime);
    result.corners = static_cast<const TriangleMesh&>(shape).corners(of.element);
    for (Vec3d& corner : result.corners) corner = local_to_world.point(corner);
    result.area = area(local_to_world, shape, middle);
    for (const Vec2f& corner : {Vec2f(0, 0), Vec2f(1, 0), Vec2f(0, 1)}) {
        const SurfacePoint point = tracer_.place(of.instance, shape.element_point(of.element, corner).hit, kMiddleTime);
        result.facet_normal = point.facet_normal;
        result.start_offset = std::max(result.start_offset, point.start_offset);
    }
    if (const Color* even = even_emission_(of.instance, middle.hit)) {
        result.is_even = true;
        result.radiance = *even;
    }
    return result;
}

SeenTriangle SurfaceLights::seen(const Element& of, float time, const Vec3d& from) const {
    FacetCorners corners;
    if (of.at_rest != kNone) {
        corners = still_[of.at_rest].corners;
    } else {
        const Shape& shape = *tracer_.instance(of.instance).shape;
        if (shape.kind() != ShapeKind::TriangleMesh) return {};
        const Affine3d local_to_world = tracer_.local_to_world(of.instance, time);
        corners = static_cast<const TriangleMesh&>(shape).corners(of.element, time);
        for (Vec3d& corner : corners) corner = local_to_world.point(corner);
    }
    for (Vec3d& corner : corners) corner -= from;
    return SeenTriangle(corners);
}

Vec3d SurfaceLights::area(const Affine3d& local_to_world, const Shape& shape, const ElementPoint& point) {
    // A triangle's parameters cover the facet; its normal in ElementPoint may be a smooth one.
    const bool flat = shape.kind() == ShapeKind::TriangleMesh;
    const Vec3d local = flat ? normalized_or(Vec3d(point.hit.normal), Vec3d(0, 0, 1)) : Vec3d(point.normal);
    return local_to_world.normal(local) * double{point.area_factor};
}

Vec3d SurfaceLights::area(const Element& of, const ElementPoint& point, float time) const {
    return area(tracer_.local_to_world(of.instance, time), *tracer_.instance(of.instance).shape, point);
}

SurfaceLights::SurfaceLights(const std::vector<EmittingInstance>& emitters, const Tracer& tracer,
                             SurfaceEmission emission, EvenEmission even_emission, const CancelToken& cancel)
    : tracer_(tracer), emission_(std::move(emission)), even_emission_(std::move(even_emission)) {
    const bool linked =
        std::ranges::any_of(emitters, [](const EmittingInstance& each) { return each.link != LightLink(); });
    uint32_t still = 0;
    for (const EmittingInstance& emitter : emitters) {
        if (emitter.elements.empty()) continue;
        if (linked) links_.push_back(emitter.link);
        if (emitter.instance >= table_of_instance_.size()) table_of_instance_.resize(emitter.instance + 1, -1);
        table_of_instance_[emitter.instance] = static_cast<int32_t>(item_of_element_.size());
        const bool rests = is_at_rest(emitter.instance);
        auto& items = item_of_element_.emplace_back(tracer.instance(emitter.instance).shape->element_count(), kNone);
        for (const uint32_t element : emitter.elements) {
            items[element] = count();
            elements_.push_back({emitter.instance, element});
            if (rests) elements_.back().at_rest = still++;
        }
    }
    still_.resize(still);
    tbb::parallel_for(size_t{0}, elements_.size(), [&](size_t i) {
        cancel.throw_if_cancelled();
        if (elements_[i].at_rest != kNone) still_[elements_[i].at_rest] = at_rest(elements_[i]);
    });
}

/// Where an element was sampled.
struct SurfaceLights::Place {
    const Wanted* wanted = nullptr;
    double seen_density = 0;  ///< by solid angle; 0: it is sampled by area
    Vec3d area{0, 0, 0};
    SurfacePoint point;
};

/// Those of which it depends on the place what they emit.
struct SurfaceLights::Asked {
    ShortList<Place, kMostTogether> places;
    ShortList<ElementQuery, kMostTogether> elements;

    Place& add(const Wanted& wanted, uint32_t instance, const LocalHit& hit) {
        Place& place = places.add();
        place.wanted = &wanted;
        elements.add(instance, hit, wanted.query->time, &place.point);
        return place;
    }
};

/// The query's light at a place that is so far off, but for the radiance and where the way to it ends; null where it is
/// seen edge on. `seen_density` and `area` as of Place.
LightSample* SurfaceLights::begin_light(const Wanted& wanted, const Vec3d& offset, double seen_density,
                                        const Vec3d& area) const {
    const double distance = offset.length();
    const double density = seen_density > 0.0 ? seen_density : density_at(offset, distance, area);
    Maybe<LightSample>& light = wanted.query->light;
    light.reset();
    if (!(density > 0)) return nullptr;
    LightSample& sample = light.emplace();
    sample.direction = Vec3f(offset * (1.0 / distance));
    sample.distance = distance;
    sample.density = static_cast<float>(density);
    sample.visibility = visibility(wanted.item);
    sample.instance = static_cast<int>(instance(wanted.item));
    sample.blockers = link(wanted.item).blockers;
    return &sample;
}

/// All but the radiance.
LightSample* SurfaceLights::light_at(const Place& place) const {
    const Vec3d offset = place.point.position - place.wanted->query->at->position;
    LightSample* light = begin_light(*place.wanted, offset, place.seen_density, place.area);
    if (!light) return nullptr;
    light->target = place.point.ray_origin(offset * (-1.0 / light->distance));  // on the side that looks here
    light->target_anchor = place.point.anchor();
    return light;
}

void SurfaceLights::sample(const StillTriangle& triangle, const Wanted& wanted, Asked& asked) const {
    const Vec3d& from = wanted.query->at->position;
    const SeenTriangle seen = this->seen(elements_[wanted.item], wanted.query->time, from);
    const Vec2f weights = seen ? seen.sample(wanted.random) : folded(wanted.random);
    const Vec3d position = triangle.at(weights), offset = position - from;
    LightSample* light = begin_light(wanted, offset, seen ? seen.density() : 0.0, triangle.area);
    if (!light) return;
    light->target = triangle.target(position, offset);
    light->radiance = triangle.radiance;
    if (triangle.is_even) return;
    const auto [instance, element, at_rest] = elements_[wanted.item];
    const Shape& shape = *tracer_.instance(instance).shape;
    asked.add(wanted, instance, shape.element_point_at(element, weights, wanted.query->time).hit);
}

void SurfaceLights::sample(const Wanted& wanted, Asked& asked) const {
    const Element& of = elements_[wanted.item];
    if (of.at_rest != kNone) return sample(still_[of.at_rest], wanted, asked);
    const LightQuery& query = *wanted.query;
    const SeenTriangle seen = this->seen(of, query.time, query.at->position);
    const ElementPoint chosen =
        tracer_.instance(of.instance)
            .shape->element_point_at(of.element, seen ? seen.sample(wanted.random) : wanted.random, query.time);
    const auto set = [&](Place& place) {
        place.wanted = &wanted;
        if (seen) place.seen_density = seen.density();
        place.area = area(of, chosen, query.time);
    };
    const Color* even = even_emission_(of.instance, chosen.hit);
    if (!even) return set(asked.add(wanted, of.instance, chosen.hit));
    Place place;
    set(place);
    place.point = tracer_.place(of.instance, chosen.hit, query.time);
    if (LightSample* light = light_at(place)) light->radiance = *even;
}

void SurfaceLights::sample(std::span<const Wanted> all) const {
    Asked asked;
    for (const Wanted& wanted : all) sample(wanted, asked);
    if (asked.places.empty()) return;
    tracer_.surface_points(asked.elements.all());
    ShortList<EmitterPoint, kMostTogether> points;
    ShortList<LightSample*, kMostTogether> lights;
    for (const Place& place : asked.places.all()) {
        LightQuery& query = *place.wanted->query;
        LightSample* light = query.light ? &*query.light : light_at(place);
        if (!light) continue;
        EmitterPoint& point = points.add();
        point.point = &place.point;
        point.outgoing = -light->direction;
        point.path = query.path;
        point.path.ray_length = static_cast<float>(light->distance);
        lights.add(light);
    }
    std::array<Color, kMostTogether> radiances;
    emission_(points.all(), radiances.data());
    for (size_t i = 0; i < lights.size(); ++i) lights[i]->radiance = radiances[i];
}

double SurfaceLights::density(uint32_t item, const Vec3d& from, const SurfacePoint& point) const {
    const Element& of = elements_[item];
    if (const SeenTriangle seen = this->seen(of, point.time, from)) return seen.density();
    const Vec3d offset = point.position - from;
    if (of.at_rest != kNone) return density_at(offset, offset.length(), still_[of.at_rest].area);
    const ElementPoint chosen =
        point.shape->element_point_at(of.element, Vec2f(point.local.u, point.local.v), point.time);
    return density_at(offset, offset.length(), area(of, chosen, point.time));
}

float SurfaceLights::brightness(const Ray& ray, const Hit& hit, PathState path) const {
    if (hit.instance >= table_of_instance_.size() || table_of_instance_[hit.instance] < 0) return 0.0f;
    if (const Color* even = even_emission_(hit.instance, hit.local)) return max_component(*even);
    const SurfacePoint point = tracer_.surface_point(hit.instance, hit.local, ray.time);
    path.ray_length = static_cast<float>(hit.t);
    const EmitterPoint seen{&point, -Vec3f(ray.direction), path};
    Color radiance;
    emission_({&seen, 1}, &radiance);
    return max_component(radiance);
}

std::optional<uint32_t> SurfaceLights::item_of(const SurfacePoint& point) const {
    if (point.instance >= table_of_instance_.size()) return std::nullopt;
    const int32_t table = table_of_instance_[point.instance];
    if (table < 0) return std::nullopt;
    const uint32_t item = item_of_element_[static_cast<size_t>(table)][point.shape->element_of(point.local)];
    if (item == kNone) return std::nullopt;
    return item;
}

uint16_t SurfaceLights::visibility(uint32_t item) const {
    return static_cast<uint16_t>(tracer_.instance(elements_[item].instance).visibility);
}

size_t SurfaceLights::bytes() const {
    size_t total = elements_.capacity() * sizeof(Element) + table_of_instance_.capacity() * sizeof(int32_t) +
                   links_.capacity() * sizeof(LightLink) + still_.capacity() * sizeof(StillTriangle);
    for (const auto& table : item_of_element_) total += table.capacity() * sizeof(uint32_t);
    return total;
}

}  // namespace rayleaf
