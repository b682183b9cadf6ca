#include "trace/dicing.h"

#include "base/box_distance.h"

#include <algorithm>
#include <numbers>

namespace rayleaf {
namespace {

/// A patch is never taken to be nearer to the eye than this share of its own size: an eye inside the patch's box says
/// little about its distance from the surface.
constexpr double kNearestPatchShare = 0.05;

/// So many instances of one shape are looked at; beyond that the nearest by their origins.
constexpr size_t kMostInstancesLookedAt = 64;

/// From this distance on, in local units, a shape is diced alike everywhere: its far side is at most twice as far.
constexpr double kFarDistance = 2.0;

/// Of an eye that is nearer, the place counts by steps of this share of its distance, which is taken to be at least
/// this.
constexpr double kEyeStep = 0.125, kLeastEyeDistance = 0x1p-6;

/// The view from the local space of one instance.
struct LocalView {
    Vec3d eye{0, 0, 0};
    double world_per_local = 1;  ///< the largest stretch: a local error looks at most this large
    double local_per_world = 1;  ///< the largest inverse stretch
};

/// The half power of two below: facets are never coarser than asked for, and small moves of the camera or an object
/// change nothing.
double tolerance_class(double tolerance) {
    return std::exp2(0.5 * std::floor(2.0 * std::log2(tolerance)));
}

/// Of one that moves those by which its motion is known, but for places in which it is flat.
std::vector<Affine3d> places_of(const TracedInstance& instance) {
    std::vector<Affine3d> places{instance.object_to_world};
    if (!instance.motion) return places;
    for (size_t step = 0; step < instance.motion->steps(); ++step) {
        const Affine3d place = instance.motion->at(instance.motion->time_of(step));
        const Affine3d inverse = place.inverse();
        if (is_finite(inverse.x) && is_finite(inverse.y) && is_finite(inverse.z)) places.push_back(place);
    }
    return places;
}

LocalView view_from(const TracedInstance& instance, const Affine3d& place, const DicingView& view) {
    const Affine3d map = place * instance.shape->frame().to_object();
    const Affine3d inverse = map.inverse();
    LocalView local;
    local.eye = inverse.vector(view.eye - map.translation);
    local.world_per_local = std::max({map.x.length(), map.y.length(), map.z.length()});
    const double shortest = std::min({map.x.length(), map.y.length(), map.z.length()});
    local.local_per_world = 1.0 / shortest;
    return local;
}

/// Local units at a distance of so many.
double tolerance_at(const LocalView& local, const DicingView& view, double away) {
    const double pixel = view.pixel_width > 0.0 ? view.pixel_width : view.pixel_angle * away / local.local_per_world;
    return view.pixels * pixel / local.world_per_local;
}

/// A near instance: its parts are diced by their own distance from the eye.
struct NearView {
    Vec3d eye;      ///< rounded to the grid of places by which tolerances go
    double astray;  ///< how far that may be from where it is
    double at_one;  ///< tolerance at a distance of one local unit
};

bool is_diced(const Shape& shape) {
    return shape.kind() != ShapeKind::TriangleMesh && shape.kind() != ShapeKind::Strands;
}

/// What the views of a shape ask for.
struct ViewClasses {
    double far;  ///< the smallest tolerance of instances that are diced alike everywhere
    std::vector<NearView> near{};

    void add(const LocalView& local, const DicingView& view, const Box3d& box) {
        const double away = distance(box, local.eye);
        if (view.pixel_width > 0.0 || away >= kFarDistance) {
            far = std::min(far, tolerance_class(tolerance_at(local, view, away)));
            return;
        }
        if (tolerance_at(local, view, away) >= view.coarsest) return;
        const double step = kEyeStep * std::exp2(std::floor(std::log2(std::max(away, kLeastEyeDistance))));
        const double astray = 0.5 * std::numbers::sqrt3 * step;
        NearView seen{local.eye, astray, tolerance_class(tolerance_at(local, view, 1.0))};
        for (int axis = 0; axis < 3; ++axis) seen.eye[axis] = std::round(local.eye[axis] / step) * step;
        near.push_back(seen);
    }

    double tolerance(const Box3d& box) const {
        const double floor = kNearestPatchShare * (box.max - box.min).length();
        double smallest = far;
        for (const NearView& seen : near)
            smallest = std::min(smallest, seen.at_one * std::max(distance(box, seen.eye) - seen.astray, floor));
        return std::max(smallest, kFinestTolerance);
    }

    ContentHash hash() const {
        ContentHasher hasher;
        hasher.add(far);
        for (const NearView& seen : near)
            for (const double number : {seen.eye.x, seen.eye.y, seen.eye.z, seen.at_one}) hasher.add(number);
        return hasher.value();
    }
};

}  // namespace

std::vector<ShapeTolerance> facet_tolerances(const ChunkedVector<TracedInstance>& instances,
                                             std::span<const uint32_t> shape_of, std::span<const uint8_t> wanted,
                                             const DicingView& view) {
    const size_t shape_count = wanted.size();
    std::vector<std::vector<LocalView>> views(shape_count);
    std::vector<const Shape*> shapes(shape_count);
    const auto nearer = [](const LocalView& a, const LocalView& b) { return a.eye.length2() < b.eye.length2(); };
    for (size_t i = 0; i < instances.size(); ++i) {
        if (wanted[shape_of[i]] == 0 || !is_diced(*instances[i].shape)) continue;
        shapes[shape_of[i]] = instances[i].shape.get();
        std::vector<LocalView>& of_shape = views[shape_of[i]];
        for (const Affine3d& place : places_of(instances[i])) {
            of_shape.push_back(view_from(instances[i], place, view));
            std::push_heap(of_shape.begin(), of_shape.end(), nearer);
            if (of_shape.size() <= kMostInstancesLookedAt) continue;
            std::pop_heap(of_shape.begin(), of_shape.end(), nearer);
            of_shape.pop_back();
        }
    }
    std::vector<ShapeTolerance> tolerances(shape_count);
    for (size_t shape = 0; shape < shape_count; ++shape) {
        if (!shapes[shape]) continue;
        ViewClasses classes{view.coarsest};
        for (const LocalView& local : views[shape])
            classes.add(local, view, Box3d(Vec3d(shapes[shape]->bounds().min), Vec3d(shapes[shape]->bounds().max)));
        const ContentHash key = classes.hash();
        tolerances[shape] = {[classes = std::move(classes)](const Box3d& box) { return classes.tolerance(box); }, key};
    }
    return tolerances;
}

}  // namespace rayleaf
