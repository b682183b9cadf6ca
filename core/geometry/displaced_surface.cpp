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

/// So many points are displaced together: a line of a grid.
constexpr size_t kPointsAtOnce = 17;

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

std::optional<ContentHash> DisplacedSurface::hash_of(const Shape& base, const Displacement& displacement) {
    const std::optional<ContentHash> below = base.content_hash(), moves = displacement.content_hash();
    if (!below || !moves) return std::nullopt;
    ContentHasher hasher;
    hasher.add(static_cast<int>(ShapeKind::DisplacedSurface));
    for (const uint64_t word : {(*below)[0], (*below)[1], (*moves)[0], (*moves)[1]}) hasher.add(word);
    return hasher.value();
}

DisplacedSurface::DisplacedSurface(std::shared_ptr<const Shape> base, std::shared_ptr<const Displacement> displacement,
                                   const CancelToken& cancel)
    : Shape(ShapeKind::DisplacedSurface, base->name()), base_(std::move(base)), displacement_(std::move(displacement)) {
    object_bounds_ = base_->object_bounds();
    texture_space_ = base_->texture_space();
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
            for (int row = 0; row < along; ++row) {
                PlacedPoint points[kMostSamplesAlong];
                Vec3d moved[kMostSamplesAlong];
                for (int i = 0; i < along; ++i) {
                    const Vec2d at = (Vec2d(i, row) + Vec2d(kShift)) / along;
                    points[i].hit = hit_at(*base_, element, Vec2f(at));
                    points[i].surface = base_->surface(points[i].hit);
                }
                move_in_object({points, static_cast<size_t>(along)}, moved);
                for (int i = 0; i < along; ++i) {
                    const Vec3d below = base_->frame().to_object().point(points[i].surface.position);
                    here.extendBy(moved[i]);
                    longest = std::max(longest, (moved[i] - below).length());
                }
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

void DisplacedSurface::move_if_finite(std::span<const PlacedPoint> points, std::optional<Vec3d>* moved) const {
    for (size_t first = 0; first < points.size(); first += kPointsAtOnce) {
        const std::span<const PlacedPoint> some = points.subspan(first, std::min(kPointsAtOnce, points.size() - first));
        Vec3d offsets[kPointsAtOnce];
        displacement_->offsets(*base_, some, offsets);
        for (size_t i = 0; i < some.size(); ++i) {
            moved[first + i].reset();
            if (is_finite(offsets[i]) && is_finite(Vec3f(offsets[i])))
                moved[first + i] = base_->frame().to_object().point(some[i].surface.position) + offsets[i];
        }
    }
}

void DisplacedSurface::move_in_object(std::span<const PlacedPoint> points, Vec3d* moved) const {
    for (size_t first = 0; first < points.size(); first += kPointsAtOnce) {
        const std::span<const PlacedPoint> some = points.subspan(first, std::min(kPointsAtOnce, points.size() - first));
        std::optional<Vec3d> finite[kPointsAtOnce];
        move_if_finite(some, finite);
        for (size_t i = 0; i < some.size(); ++i) {
            if (!finite[i]) throw InputError(name(), "displacement", "not finite at some point", "finite numbers");
            moved[first + i] = *finite[i];
        }
    }
}

PlacedPoint DisplacedSurface::placed(uint32_t element, const Vec2f& parameters) const {
    PlacedPoint point;
    base_->line_points(element, parameters.x, {&parameters.y, 1}, &point);
    return point;
}

/// At most kPointsAtOnce.
void DisplacedSurface::move(std::span<const PlacedPoint> points, Moved* moved) const {
    std::optional<Vec3d> finite[kPointsAtOnce];
    move_if_finite(points, finite);
    for (size_t i = 0; i < points.size(); ++i) {
        moved[i].base = points[i].surface;
        moved[i].position = local(finite[i].value_or(base_->frame().to_object().point(points[i].surface.position)));
        moved[i].finite = finite[i].has_value();
    }
}

const Vec3d& DisplacedSurface::checked(const Vec3d& position) const {
    if (max_abs(position) > kFarthest)
        throw InputError(name(), "displacement", "far larger at some point than at all others", "less narrow peaks");
    return position;
}

Vec3d DisplacedSurface::position(uint32_t element, const Vec2f& parameters) const {
    const BorderPlace place = owner_place(*base_, element, parameters);
    const PlacedPoint point = placed(place.element, place.parameters);
    Vec3d moved;
    move_in_object({&point, 1}, &moved);
    return checked(local(moved));
}

void DisplacedSurface::line_positions(uint32_t element, float u, std::span<const float> v, Vec3d* positions) const {
    PlacedPoint points[kPointsAtOnce];
    for (size_t first = 0; first < v.size(); first += kPointsAtOnce) {
        const std::span<const float> some = v.subspan(first, std::min(kPointsAtOnce, v.size() - first));
        base_->line_points(element, u, some, points);
        move_in_object({points, some.size()}, positions + first);
        for (size_t i = 0; i < some.size(); ++i) positions[first + i] = checked(local(positions[first + i]));
    }
}

DisplacedSurface::Slopes DisplacedSurface::slopes(uint32_t element, const Vec2f& parameters) const {
    constexpr size_t kPoints = 5;  // here, then before and after along u and along v
    Vec2f at[kPoints];
    at[0] = parameters;
    for (const int axis : {0, 1}) {
        Vec2f &low = at[1 + 2 * axis], &high = at[2 + 2 * axis];
        low = high = parameters;
        low[axis] = std::max(parameters[axis] - kSlopeStep, 0.0f);
        high[axis] = std::min(parameters[axis] + kSlopeStep, 1.0f);
    }
    PlacedPoint points[kPoints];
    Moved moved[kPoints];
    for (size_t i = 0; i < kPoints; ++i) points[i] = placed(element, at[i]);
    move(points, moved);
    Slopes result;
    result.here = moved[0];
    for (const int axis : {0, 1}) {
        const Moved &before = moved[1 + 2 * axis], &after = moved[2 + 2 * axis];
        const double step = double{at[2 + 2 * axis][axis]} - double{at[1 + 2 * axis][axis]};
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
