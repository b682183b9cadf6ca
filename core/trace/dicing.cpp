#include "trace/dicing.h"

#include <algorithm>

namespace rayleaf {
namespace {

/// A patch is never taken to be nearer to the eye than this share of its own size: an eye inside the patch's box says
/// little about its distance from the surface.
constexpr double kNearestPatchShare = 0.05;

/// So many instances of one shape are looked at; beyond that the nearest by their origins.
constexpr size_t kMostInstancesLookedAt = 64;

/// The view from the local space of one instance.
struct LocalView {
    Vec3d eye{0, 0, 0};
    double world_per_local = 1;  ///< the largest stretch: a local error looks at most this large
    double local_per_world = 1;  ///< the largest inverse stretch
};

LocalView view_from(const TracedInstance& instance, const DicingView& view) {
    const Affine3d map = instance.object_to_world * instance.shape->frame().to_object();
    const Affine3d inverse = map.inverse();
    LocalView local;
    local.eye = inverse.vector(view.eye - map.translation);
    local.world_per_local = std::max({map.x.length(), map.y.length(), map.z.length()});
    const double shortest = std::min({map.x.length(), map.y.length(), map.z.length()});
    local.local_per_world = 1.0 / shortest;
    return local;
}

double distance(const Box3d& box, const Vec3d& point) {
    Vec3d outside;
    for (int axis = 0; axis < 3; ++axis)
        outside[axis] = std::max({box.min[axis] - point[axis], 0.0, point[axis] - box.max[axis]});
    return outside.length();
}

double tolerance_for(const LocalView& local, const DicingView& view, const Box3d& box) {
    const double floor = kNearestPatchShare * (box.max - box.min).length();
    // Distance in world units along the shortest stretch is what the eye is at least away.
    const double away = std::max(distance(box, local.eye), floor) / local.local_per_world;
    const double pixel = view.pixel_width > 0.0 ? view.pixel_width : view.pixel_angle * away;
    return view.pixels * pixel / local.world_per_local;
}

ContentHash hash_of(const std::vector<LocalView>& views, const DicingView& view) {
    ContentHasher hasher;
    for (const double number : {view.pixel_angle, view.pixel_width, view.pixels}) hasher.add(number);
    for (const LocalView& local : views)
        for (const double number :
             {local.eye.x, local.eye.y, local.eye.z, local.world_per_local, local.local_per_world})
            hasher.add(number);
    return hasher.value();
}

}  // namespace

std::vector<ShapeTolerance> facet_tolerances(const std::vector<TracedInstance>& instances, size_t shape_count,
                                             const std::vector<size_t>& shape_of, const DicingView& view) {
    std::vector<std::vector<LocalView>> views(shape_count);
    const auto nearer = [](const LocalView& a, const LocalView& b) { return a.eye.length() < b.eye.length(); };
    for (size_t i = 0; i < instances.size(); ++i) {
        if (instances[i].shape->kind() == ShapeKind::TriangleMesh) continue;
        std::vector<LocalView>& of_shape = views[shape_of[i]];
        of_shape.push_back(view_from(instances[i], view));
        std::push_heap(of_shape.begin(), of_shape.end(), nearer);
        if (of_shape.size() <= kMostInstancesLookedAt) continue;
        std::pop_heap(of_shape.begin(), of_shape.end(), nearer);
        of_shape.pop_back();
    }
    std::vector<ShapeTolerance> tolerances;
    tolerances.reserve(shape_count);
    for (std::vector<LocalView>& of_shape : views) {
        const ContentHash key = hash_of(of_shape, view);
        tolerances.push_back({[local = std::move(of_shape), view](const Box3d& box) {
                                  double smallest = kCoarsestTolerance;
                                  for (const LocalView& each : local)
                                      smallest = std::min(smallest, tolerance_for(each, view, box));
                                  return std::max(smallest, kFinestTolerance);
                              },
                              key});
    }
    return tolerances;
}

}  // namespace rayleaf
