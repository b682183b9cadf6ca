#include "ri_tree/sample_tracer.h"

#include "base/error.h"
#include "ri_tree/glass_walk.h"
#include "trace/inside_length.h"

#include <limits>

namespace rayleaf {
namespace {

/// How far from its facet a ray inside glass starts, local units: the error of a float ray (trace/tracer.cpp), and the
/// rounding of the hit, 64 operations of 2^-53 of the coordinates that it was computed from.
constexpr double kFloatRayError = 0x1p-21;
constexpr double kRounding = 64 * 0x1p-53;

SampleSettings checked(const std::string& name, const SampleSettings& settings) {
    const auto require_positive = [&](const char* argument, double value) {
        if (!(value > 0.0 && std::isfinite(value)))
            throw InputError(name, argument, number_text(value), "a finite number above 0");
    };
    require_positive("ior", settings.ior);
    require_positive("facet_tolerance", settings.facet_tolerance);
    if (settings.most_interior_hits < 1 || settings.most_interior_hits > kMostInteriorHits)
        throw InputError(name, "most_interior_hits", std::to_string(settings.most_interior_hits), "1 to 64");
    return settings;
}

/// A scene of the shape alone, placed so that world space is its local space.
std::vector<TracedInstance> in_local_space(const std::shared_ptr<const Shape>& shape) {
    const LocalFrame& frame = shape->frame();
    const double shrink = 1.0 / frame.scale;
    return {{shape, {{shrink, 0, 0}, {0, shrink, 0}, {0, 0, shrink}, -frame.center / frame.scale}, kVisibleAll}};
}

/// A view that dices equally finely everywhere.
DicingView even_view(double facet_tolerance) {
    DicingView view;
    view.pixels = 1.0;
    view.pixel_width = facet_tolerance;
    return view;
}

TextureSeams seams_of(OutputKind kind) {
    return kind == OutputKind::Simple ? TextureSeams::Parted : TextureSeams::Joined;
}

}  // namespace

SampleTracer::SampleTracer(std::shared_ptr<const Shape> shape, const SampleSettings& settings,
                           const CancelToken& cancel)
    : shape_(std::move(shape)),
      settings_(checked(shape_->name(), settings)),
      classes_(*shape_, seams_of(settings.kind), cancel),
      tracer_(in_local_space(shape_), even_view(settings.facet_tolerance), cancel) {}

uint32_t SampleTracer::first_hit_class(const Ray& ray) const {
    const Maybe<Hit> hit = tracer_.closest_hit(ray, kVisibleAll);
    return hit ? classes_.of(*shape_, hit->local) : kMissedClass;
}

uint64_t SampleTracer::bytes() const {
    const TraceStatistics held = tracer_.statistics();
    return held.bvh_bytes + held.record_bytes + held.geometry.bytes + classes_.bytes();
}

/// What a path needs of a hit. World space is local space, so nothing has to be transformed.
struct SampleTracer::Point {
    LocalSurface surface;
    uint32_t surface_class = kMissedClass;
    Vec3d facet_position{0, 0, 0}, facet_normal{0, 0, 1};  ///< unit, on the side of the winding
    Vec3d normal{0, 0, 1};                                 ///< unit, for shading
    Vec3d tangent_normal{0, 0, 1};                         ///< of the surface that `surface.position` moves on
    double start_offset = 0;

    Vec3d ray_origin(const Vec3d& direction) const {
        return facet_position + facet_normal * (direction.dot(facet_normal) < 0.0 ? -start_offset : start_offset);
    }
    GlassCrossing crossing() const { return {surface.position, normal, facet_normal, surface_class}; }
};

SampleTracer::Point SampleTracer::point_at(const Ray& ray, const Hit& hit) const {
    Point point;
    point.surface = shape_->surface(hit.local);
    point.surface_class = classes_.of(*shape_, hit.local);
    point.facet_position = hit.local.position;
    point.facet_normal = normalized_or(Vec3d(hit.local.normal), Vec3d(0, 0, 1));
    point.normal = normalized_or(Vec3d(point.surface.normal), point.facet_normal);
    point.tangent_normal = shape_->kind() == ShapeKind::TriangleMesh ? point.facet_normal : point.normal;
    const double size = max_abs(ray.origin) + hit.t + max_abs(point.facet_position) + 1.0;
    point.start_offset = kFloatRayError + kRounding * 3.0 * size;
    return point;
}

OutputRay SampleTracer::trace(const Ray& ray) const {
    UnknownChanges changes;
    return trace_path(ray, changes);
}

OutputRay SampleTracer::trace(const Ray& ray, const RayChanges& ray_changes, OutputChanges& changes) const {
    changes = {};
    PathChanges path(ray.origin, ray_changes, changes);
    return trace_path(ray, path);
}

template <typename Changes>
OutputRay SampleTracer::trace_path(const Ray& ray, Changes& changes) const {
    OutputRay out;
    const Maybe<Hit> hit = tracer_.closest_hit(ray, kVisibleAll);
    if (!hit) return out;
    if (settings_.kind == OutputKind::Volume) {
        out.sample_class.first_hit = classes_.of(*shape_, hit->local);
        measure_length(ray, *hit, out, changes);
        return out;
    }
    const Point point = point_at(ray, *hit);
    changes.arrive(point.surface.position, ray.direction, point.surface, point.tangent_normal);
    changes.first_hit();
    out.sample_class.first_hit = point.surface_class;
    out.position = out.exit_position = point.surface.position;
    out.normal = point.normal;
    switch (settings_.kind) {
        case OutputKind::Simple:
            out.uv = Vec2d(point.surface.uv);
            out.exit_direction = out.normal;
            break;
        case OutputKind::Mirror:
            out.exit_direction = mirrored(ray.direction, out.normal);
            break;
        case OutputKind::Glass:
            follow_glass(ray, point, out, changes);
            break;
        case OutputKind::Volume:
            break;
    }
    return out;
}

template <typename Changes>
void SampleTracer::follow_glass(const Ray& ray, const Point& first, OutputRay& out, Changes& changes) const {
    Point point = first;
    const auto next = [&](const Vec3d& direction) -> std::optional<GlassCrossing> {
        Ray inner;
        inner.origin = point.ray_origin(direction);
        inner.direction = direction;
        const Maybe<Hit> hit = tracer_.closest_hit(inner, kVisibleAll);
        if (!hit) return std::nullopt;
        point = point_at(inner, *hit);
        changes.arrive(point.surface.position, direction, point.surface, point.tangent_normal);
        return point.crossing();
    };
    walk_glass(settings_, first.crossing(), ray.direction, next, out, changes);
}

template <typename Changes>
void SampleTracer::measure_length(const Ray& ray, const Hit& first, OutputRay& out, Changes& changes) const {
    SampleClass& path = out.sample_class;
    path.ending = PathEnding::Left;
    double entered = 0.0;
    int inside = 0;  // nested bodies of one shape count once
    Ray rest = ray;
    Maybe<Hit> hit = first;
    for (;;) {
        const Vec3d facet_normal(hit->local.normal);
        path.exit = classes_.of(*shape_, hit->local);
        if (facet_normal.dot(ray.direction) <= 0.0) {
            if (inside++ == 0) {
                entered = hit->t;
                changes.add_crossing(ray.direction, hit->t, facet_normal, -1.0);
            }
        } else if (inside > 0) {
            if (--inside == 0) {
                out.length += hit->t - entered;
                changes.add_crossing(ray.direction, hit->t, facet_normal, 1.0);
            }
        } else if (path.interior_hits == 0) {
            out.length += hit->t - ray.t_min;  // started inside
            changes.add_crossing(ray.direction, hit->t, facet_normal, 1.0);
        }
        rest.t_min = hit->t + kCrossingStep;
        hit = tracer_.closest_hit(rest, kVisibleAll);
        if (!hit) return;
        if (path.interior_hits == kMostInteriorHits) {
            path.ending = PathEnding::CutOff;
            return;
        }
        ++path.interior_hits;
    }
}

}  // namespace rayleaf
