#include "geometry/displaced_surface.h"

#include "base/error.h"
#include "geometry/parameter_slopes.h"
#include "geometry/patch_surface.h"
#include "geometry/subdivision_surface.h"
#include "splines/bounds.h"

#include <algorithm>
#include <mutex>

#include <oneapi/tbb/parallel_for.h>

namespace rayleaf {
namespace {

/// Slopes are differences over this share of an element: well above rounding in single precision, which programs
/// compute with, and below the quads that displaced elements are diced to.
constexpr float kSlopeStep = 0x1p-10f;

/// The reach of a displacement is estimated from about so many samples, at most this many along an element's side.
constexpr double kSamples = 40'000;
constexpr int kMostSamplesAlong = 8;
/// A fraction of the golden ratio: samples do not coincide with the lattices of textures.
constexpr double kShift = 0.381966;
/// Margin for what samples have missed, as a share of the largest displacement.
constexpr double kMargin = 0.5;
/// The largest local coordinate: single precision is designed for 1, and beyond this the samples were misleading.
constexpr double kFarthest = 4.0;

LocalHit hit_at(const Shape& base, uint32_t element, const Vec2f& parameters) {
    return base.element_point(element, parameters).hit;
}

BorderPlace owner_place(const Shape& base, uint32_t element, const Vec2f& parameters) {
    const BorderPlace place{element, parameters};
    if (base.kind() == ShapeKind::PatchSurface) return static_cast<const PatchSurface&>(base).owner_place(place);
    return static_cast<const SubdivisionSurface&>(base).owner_place(place);
}

}  // namespace

DisplacedSurface::DisplacedSurface(std::shared_ptr<const Shape> base, std::shared_ptr<const Displacement> displacement,
                                   const CancelToken& cancel)
    : Shape(ShapeKind::DisplacedSurface, base->name()), base_(std::move(base)), displacement_(std::move(displacement)) {
    object_bounds_ = base_->object_bounds();
    Box3d box = object_bounds_;
    const uint32_t count = base_->element_count();
    if (count > 0) {
        const int along = std::clamp(static_cast<int>(std::sqrt(kSamples / count)), 1, kMostSamplesAlong);
        double farthest = 0.0;
        std::mutex mutex;
        tbb::parallel_for(uint32_t{0}, count, [&](uint32_t element) {
            cancel.throw_if_cancelled();
            Box3d here;
            double longest = 0.0;
            for (int i = 0; i < along * along; ++i) {
                const int row = i / along;
                const Vec2d at = (Vec2d(i % along, row) + Vec2d(kShift)) / along;
                const LocalHit hit = hit_at(*base_, element, Vec2f(at));
                const LocalSurface surface = base_->surface(hit);
                const Vec3d point = moved_in_object(hit, surface);
                here.extendBy(point);
                longest = std::max(longest, (point - base_->frame().to_object().point(surface.position)).length());
            }
            const std::scoped_lock lock(mutex);  // box and maximum do not depend on the order
            box.extendBy(here);
            farthest = std::max(farthest, longest);
        });
        box.min -= Vec3d(farthest * kMargin);
        box.max += Vec3d(farthest * kMargin);
    }
    frame_ = LocalFrame::fitting(box);
    if (!box.isEmpty())
        bounds_ = outward_float({(box.min - frame_.center) / frame_.scale, (box.max - frame_.center) / frame_.scale});
}

std::optional<Vec3d> DisplacedSurface::moved_if_finite(const LocalHit& hit, const LocalSurface& surface) const {
    const Vec3d offset = displacement_->offset(*base_, hit, surface);
    if (!is_finite(offset) || !is_finite(Vec3f(offset))) return std::nullopt;
    return base_->frame().to_object().point(surface.position) + offset;
}

Vec3d DisplacedSurface::moved_in_object(const LocalHit& hit, const LocalSurface& surface) const {
    const std::optional<Vec3d> point = moved_if_finite(hit, surface);
    if (!point) throw InputError(name(), "displacement", "not finite at some point", "finite numbers");
    return *point;
}

DisplacedSurface::Moved DisplacedSurface::moved(uint32_t element, const Vec2f& parameters) const {
    PlacedPoint placed;
    base_->line_points(element, parameters.x, {&parameters.y, 1}, &placed);
    Moved result;
    result.base = placed.surface;
    const std::optional<Vec3d> point = moved_if_finite(placed.hit, result.base);
    result.position = local(point.value_or(base_->frame().to_object().point(result.base.position)));
    result.finite = point.has_value();
    return result;
}

const Vec3d& DisplacedSurface::checked(const Vec3d& position) const {
    if (max_abs(position) > kFarthest)
        throw InputError(name(), "displacement", "far larger at some point than at all others", "less narrow peaks");
    return position;
}

Vec3d DisplacedSurface::position(uint32_t element, const Vec2f& parameters) const {
    const BorderPlace place = owner_place(*base_, element, parameters);
    const Moved point = moved(place.element, place.parameters);
    if (!point.finite) throw InputError(name(), "displacement", "not finite at some point", "finite numbers");
    return checked(point.position);
}

void DisplacedSurface::line_positions(uint32_t element, float u, std::span<const float> v, Vec3d* positions) const {
    constexpr size_t kAtOnce = 17;  // a line of a grid
    PlacedPoint points[kAtOnce];
    for (size_t first = 0; first < v.size(); first += kAtOnce) {
        const std::span<const float> some = v.subspan(first, std::min(kAtOnce, v.size() - first));
        base_->line_points(element, u, some, points);
        for (size_t i = 0; i < some.size(); ++i)
            positions[first + i] = checked(local(moved_in_object(points[i].hit, points[i].surface)));
    }
}

DisplacedSurface::Slopes DisplacedSurface::slopes(uint32_t element, const Vec2f& parameters) const {
    Slopes result;
    result.here = moved(element, parameters);
    for (const int axis : {0, 1}) {
        Vec2f low = parameters, high = parameters;
        low[axis] = std::max(parameters[axis] - kSlopeStep, 0.0f);
        high[axis] = std::min(parameters[axis] + kSlopeStep, 1.0f);
        const double step = double{high[axis]} - double{low[axis]};
        const Moved before = moved(element, low), after = moved(element, high);
        if (result.here.finite && before.finite && after.finite)
            (axis == 0 ? result.du : result.dv) = (after.position - before.position) / step;
        (axis == 0 ? result.uv_du : result.uv_dv) = Vec2d(after.base.uv - before.base.uv) / step;
    }
    return result;
}

/// Derivatives of the normal are zero: second differences in single precision are meaningless.
LocalSurface DisplacedSurface::surface(const LocalHit& hit) const {
    const Slopes slope = slopes(hit.primitive, {hit.u, hit.v});
    LocalSurface result;
    result.position = slope.here.finite ? slope.here.position : hit.position;
    result.uv = slope.here.base.uv;
    const Vec3d facet_normal = normalized_or(Vec3d(hit.normal), Vec3d(0, 0, 1));
    const Vec3d normal = normalized_or(slope.dv.cross(slope.du), facet_normal);
    result.normal = Vec3f(normal.dot(facet_normal) < 0.0 ? -normal : normal);
    const auto [by_u, by_v] = parameter_slopes(slope.uv_du, slope.uv_dv).value_or(ParameterSlopes{});
    result.dp_du = float_or_zero(slope.du * by_u.x + slope.dv * by_u.y);
    result.dp_dv = float_or_zero(slope.du * by_v.x + slope.dv * by_v.y);
    return result;
}

ElementPoint DisplacedSurface::element_point(uint32_t element, const Vec2f& parameters) const {
    const Slopes slope = slopes(element, parameters);
    ElementPoint result;
    result.hit.primitive = element;
    result.hit.u = parameters.x;
    result.hit.v = parameters.y;
    result.hit.position = slope.here.position;
    const Vec3d area = slope.dv.cross(slope.du);
    result.normal = Vec3f(normalized_or(area, Vec3d(slope.here.base.normal)));
    result.hit.normal = result.normal;
    result.area_factor = static_cast<float>(area.length());
    return result;
}

}  // namespace rayleaf
