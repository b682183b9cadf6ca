#include "ri_tree/sample_tracer.h"

#include "base/error.h"

#include <limits>

namespace rayleaf {
namespace {

/// How far behind a crossing a line goes on, local units: above the rounding of two facets that share an edge, below
/// any thickness that counts.
constexpr double kCrossingStep = 0x1p-20;

SampleSettings checked(const std::string& name, const SampleSettings& settings) {
    const auto require_positive = [&](const char* argument, double value) {
        if (!(value > 0.0 && std::isfinite(value)))
            throw InputError(name, argument, std::to_string(value), "a finite number above 0");
    };
    require_positive("ior", settings.ior);
    require_positive("facet_tolerance", settings.facet_tolerance);
    return settings;
}

/// The shape alone, placed so that world space is its local space.
std::vector<TracedInstance> in_local_space(const std::shared_ptr<const Shape>& shape) {
    const LocalFrame& frame = shape->frame();
    const double shrink = 1.0 / frame.scale;
    return {{shape, {{shrink, 0, 0}, {0, shrink, 0}, {0, 0, shrink}, -frame.center / frame.scale}, kVisibleAll}};
}

/// The same fineness wherever one looks from.
DicingView even_view(double facet_tolerance) {
    DicingView view;
    view.pixels = 1.0;
    view.pixel_width = facet_tolerance;
    return view;
}

TextureSeams seams_of(OutputKind kind) {
    return kind == OutputKind::Simple ? TextureSeams::Parted : TextureSeams::Joined;
}

/// Snell's law; `normal` faces the incoming side, `eta` is the incoming side's index over the other's. Empty: all is
/// reflected.
std::optional<Vec3d> refracted_direction(const Vec3d& direction, const Vec3d& normal, double eta) {
    const double cosine = -direction.dot(normal);
    const double beyond = 1.0 - eta * eta * (1.0 - cosine * cosine);
    if (beyond < 0.0) return std::nullopt;
    return normalized_or(direction * eta + normal * (eta * cosine - std::sqrt(beyond)), direction);
}

}  // namespace

SampleTracer::SampleTracer(std::shared_ptr<const Shape> shape, const SampleSettings& settings)
    : shape_(std::move(shape)),
      settings_(checked(shape_->name(), settings)),
      classes_(*shape_, seams_of(settings.kind)),
      tracer_(in_local_space(shape_), even_view(settings.facet_tolerance)) {}

uint32_t SampleTracer::first_hit_class(const Ray& ray) const {
    const std::optional<Hit> hit = tracer_.closest_hit(ray, kVisibleAll);
    return hit ? classes_.of(*shape_, hit->local) : kMissedClass;
}

OutputRay SampleTracer::trace(const Ray& ray) const {
    OutputRay out;
    const std::optional<Hit> hit = tracer_.closest_hit(ray, kVisibleAll);
    if (!hit) return out;
    out.sample_class.first_hit = classes_.of(*shape_, hit->local);
    if (settings_.kind == OutputKind::Volume) {
        measure_length(ray, *hit, out);
        return out;
    }
    const SurfacePoint point = tracer_.surface_point(ray, *hit);
    out.position = out.exit_position = point.position;
    out.normal = normalized_or(Vec3d(point.normal), Vec3d(0, 0, 1));
    switch (settings_.kind) {
        case OutputKind::Simple:
            out.uv = Vec2d(point.uv);
            out.exit_direction = out.normal;
            break;
        case OutputKind::Mirror:
            out.exit_direction = mirrored(ray.direction, out.normal);
            break;
        case OutputKind::Glass:
            follow_glass(ray, point, out);
            break;
        case OutputKind::Volume:
            break;
    }
    return out;
}

void SampleTracer::follow_glass(const Ray& ray, const SurfacePoint& first, OutputRay& out) const {
    SampleClass& path = out.sample_class;
    SurfacePoint point = first;
    Vec3d direction = ray.direction;
    for (;;) {
        const Vec3d facet_normal(point.facet_normal);
        const bool from_inside = direction.dot(facet_normal) > 0.0;
        Vec3d normal = normalized_or(Vec3d(point.normal), facet_normal);
        if (normal.dot(direction) > 0.0) normal = -normal;
        const double eta = from_inside ? settings_.ior : 1.0 / settings_.ior;
        const std::optional<Vec3d> through = refracted_direction(direction, normal, eta);
        direction = through ? *through : mirrored(direction, normal);
        if (!through) ++path.total_reflections;
        out.exit_position = point.position;
        out.exit_direction = direction;
        path.exit = class_at(point);
        // Where the ray goes by the facet is where it is: a shading normal may differ from it.
        if (direction.dot(facet_normal) >= 0.0) {
            path.ending = PathEnding::Left;
            return;
        }
        if (path.interior_hits == kMostInteriorHits) {
            path.ending = PathEnding::CutOff;
            return;
        }
        Ray inner;
        inner.origin = point.ray_origin(Vec3f(direction));
        inner.direction = direction;
        const std::optional<Hit> hit = tracer_.closest_hit(inner, kVisibleAll);
        if (!hit) {
            path.ending = PathEnding::Escaped;
            return;
        }
        point = tracer_.surface_point(inner, *hit);
        ++path.interior_hits;
    }
}

void SampleTracer::measure_length(const Ray& ray, const Hit& first, OutputRay& out) const {
    SampleClass& path = out.sample_class;
    path.ending = PathEnding::Left;
    double entered = 0.0;
    int inside = 0;  // nested bodies of one shape count once
    Ray rest = ray;
    std::optional<Hit> hit = first;
    for (;;) {
        path.exit = classes_.of(*shape_, hit->local);
        const bool leaves = Vec3d(hit->local.normal).dot(ray.direction) > 0.0;
        if (!leaves) {
            if (inside++ == 0) entered = hit->t;
        } else if (inside > 0) {
            if (--inside == 0) out.length += hit->t - entered;
        } else if (path.interior_hits == 0) {
            out.length += hit->t - ray.t_min;  // started inside
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
