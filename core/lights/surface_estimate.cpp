// What surfaces that emit look like to the light tree: where each element is, how bright, and which way.
#include "lights/chosen_light.h"
#include "lights/surface_light.h"

#include <algorithm>
#include <array>

#include <tbb/parallel_for.h>

namespace rayleaf {
namespace {

/// Where an element is looked at to guess what it emits: parameters inside a triangle too.
constexpr Vec2f kLightProbes[] = {Vec2f(0.2f, 0.2f), Vec2f(0.6f, 0.2f), Vec2f(0.2f, 0.6f), Vec2f(0.75f, 0.75f)};
/// An element whose probes saw less than this share of the mean is still sampled as often as one with that share.
constexpr double kSmallestShare = 0.05;

/// Of more elements, none asks what its sides see: it would take longer than it saves.
constexpr size_t kMostThatLook = 1 << 12;

/// Places from which it is asked whether an object is around all: from the middle of the scene's box, as a share of its
/// size. They are inside a ball.
constexpr double kPlaceInScene = 0.2;

/// When a moving element is looked at, to guess where it is near; and one at rest.
constexpr float kLookTimes[] = {0.0f, 0.25f, 0.5f, 0.75f, 1.0f}, kStillTimes[] = {kMiddleTime};

/// Whether a ray that leaves the surface meets the same object.
bool is_shut_in(const Tracer& tracer, const SurfacePoint& point, const Vec3f& direction) {
    Ray ray;
    point.release(ray, Vec3d(direction));
    const Maybe<Hit> hit = tracer.closest_hit(ray, kVisibleDiffuse);
    return hit && hit->instance == point.instance;
}

/// The normals at an element's probes as a cone. A side on which all probes are shut in, the inside of a ball, is seen
/// from within the object alone.
class ConeOfProbes {
  public:
    void add(const Tracer& tracer, const SurfacePoint& point, const Vec3d& normal, bool looks) {
        normals_[count_++] = normal;
        sum_ += normal;
        ahead_ = ahead_ && looks && is_shut_in(tracer, point, Vec3f(normal));
        back_ = back_ && looks && is_shut_in(tracer, point, -Vec3f(normal));
    }
    /// `body`: of the whole object.
    LightCone cone(const Box3d& body) const {
        const double length = sum_.length();
        if (!(length > 0.0)) return {};
        LightCone result{Vec3f(sum_ / length)};
        for (size_t i = 0; i < count_; ++i)
            result.cosine = std::min(result.cosine, static_cast<float>(sum_.dot(normals_[i]) / length));
        if (ahead_ == back_) return result;
        result.ahead = back_;
        result.back = ahead_;
        result.body = body;
        return result;
    }

  private:
    std::array<Vec3d, std::size(kLightProbes)> normals_;
    size_t count_ = 0;
    Vec3d sum_{0, 0, 0};
    bool ahead_ = true, back_ = true;  ///< shut in there
};

}  // namespace

SurfaceLights::Estimate SurfaceLights::estimate(const Element& of, bool looks) const {
    const uint32_t instance = of.instance, element = of.element;
    const Shape& shape = *tracer_.instance(instance).shape;
    const Affine3d local_to_world = tracer_.local_to_world(instance, kMiddleTime);
    const bool moves = tracer_.instance(instance).motion != nullptr || shape.deforms();
    const std::span<const float> times =
        moves ? std::span<const float>(kLookTimes) : std::span<const float>(kStillTimes);
    Estimate result;
    const PathState path = of_length(sampling_state(), 1.0);  // from wherever it is seen
    for (const float v : {0.0f, 0.5f, 1.0f})
        for (const float u : {0.0f, 0.5f, 1.0f}) {
            for (const float time : times) {
                const ElementPoint point = shape.element_point_at(element, Vec2f(u, v), time);
                result.bounds.extendBy(tracer_.local_to_world(instance, time).point(Vec3d(point.hit.position)));
            }
        }
    ConeOfProbes cone;
    for (const Vec2f& probe : kLightProbes) {
        const ElementPoint point = shape.element_point(element, probe);
        const Vec3d area = SurfaceLights::area(local_to_world, shape, point);
        const SurfacePoint surface = tracer_.surface_point(instance, point.hit);
        if (!moves) cone.add(tracer_, surface, normalized_or(area, Vec3d(0, 0, 1)), looks);
        const EmitterPoint seen{&surface, surface.normal, path};
        Color color;
        emission_({&seen, 1}, &color);
        result.area += area.length() / static_cast<double>(std::size(kLightProbes));
        if (is_finite(color)) result.radiance += std::max(0.0f, max_component(color)) / double(std::size(kLightProbes));
    }
    result.cone = cone.cone(tracer_.bounds(instance));
    return result;
}

std::vector<LightTreeItem> SurfaceLights::tree_items(const CancelToken& cancel) const {
    std::vector<Estimate> estimates(elements_.size());
    const bool looks = elements_.size() <= kMostThatLook;
    tbb::parallel_for(size_t{0}, elements_.size(), [&](size_t i) {
        cancel.throw_if_cancelled();
        estimates[i] = estimate(elements_[i], looks);
    });
    double radiance = 0;
    for (const Estimate& e : estimates) radiance += e.radiance / static_cast<double>(estimates.size());
    const double least = radiance > 0 ? radiance * kSmallestShare : 1.0;
    take_even_part_of_skies(estimates, cancel);
    std::vector<LightTreeItem> items;
    items.reserve(estimates.size());
    // Without an axis half a cosine, the mean over the directions of a side. The smallest double keeps weights
    // positive.
    for (uint32_t i = 0; i < count(); ++i) {
        const Estimate& e = estimates[i];
        const double cosine = e.cone.axis == Vec3f(0.0f) ? 0.5 : 1.0;
        items.push_back(
            {e.bounds, std::max(1e-300, cosine * e.area * std::max(e.radiance, least)), link(i).set(), e.cone});
    }
    return items;
}

/// Whether an object is all around the scene, as a painted sky is: seen in all directions from places in its box.
bool SurfaceLights::is_around_all(uint32_t instance, const CancelToken& cancel) const {
    const Box3d scene = tracer_.bounds(), own = tracer_.bounds(instance);
    if (!own.intersects(scene.min) || !own.intersects(scene.max)) return false;
    const auto neighbour = [](int number) {
        const int x = number % 3, y = number / 3 % 3, z = number / 9;
        return Vec3d(x - 1, y - 1, z - 1);
    };
    constexpr int kNeighbours = 27;
    for (int place = 0; place < kNeighbours; ++place) {
        Ray ray;
        ray.origin = scene.center() + neighbour(place) * scene.size() * kPlaceInScene;
        for (int way = 0; way < kNeighbours; ++way) {
            ray.direction = neighbour(way);
            cancel.throw_if_cancelled();
            if (ray.direction != Vec3d(0.0) && !tracer_.closest_on(instance, ray)) return false;
        }
    }
    return true;
}

/// Of such an object, if it shines all over: what all places have in common is found by scattered rays, as of the world
/// (WorldLight). What is brighter than that remains.
void SurfaceLights::take_even_part_of_skies(std::vector<Estimate>& estimates, const CancelToken& cancel) const {
    for (size_t first = 0, last; first < estimates.size(); first = last) {
        const uint32_t instance = elements_[first].instance;
        double area = 0, power = 0;
        for (last = first; last < estimates.size() && elements_[last].instance == instance; ++last) {
            area += estimates[last].area;
            power += estimates[last].area * estimates[last].radiance;
        }
        const bool shines_all_over = last - first == tracer_.instance(instance).shape->element_count();
        if (!shines_all_over || !(area > 0.0) || !is_around_all(instance, cancel)) continue;
        for (size_t i = first; i < last; ++i)
            estimates[i].radiance = std::max(estimates[i].radiance - power / area, 0.0);
    }
}

}  // namespace rayleaf
