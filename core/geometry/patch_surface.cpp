#include "geometry/patch_surface.h"

#include "base/error.h"
#include "base/largest.h"
#include "splines/bernstein.h"
#include "splines/bounds.h"
#include "splines/limit_normal.h"

#include <algorithm>

namespace rayleaf {
namespace {

/// Control points of a border within this of each other are merged, local units: far above the rounding of the
/// conversion to Bezier form, far below any edge that an artist models.
constexpr double kCollapsedLength = 1e-11;

/// The points along one line of a net: a row or a column.
struct NetLine {
    Vec4d* first;
    size_t stride;

    Vec4d& operator[](size_t i) const { return first[i * stride]; }
};

/// Merges the control points of each collapsed span of a line. Spans come in order and share their ends, so a pole of
/// several spans becomes one point.
void merge_collapsed_spans(const NetLine& line, const SplineAxis& axis) {
    for (const SplineSpan& span : axis.spans) {
        const Vec3d center = project(line[span.first_point]);
        bool collapsed = true;
        for (int i = 1; i <= axis.degree && collapsed; ++i)
            collapsed = max_abs(project(line[span.first_point + i]) - center) < kCollapsedLength;
        if (!collapsed) continue;
        const Vec3d point = Vec3d(Vec3f(center));
        for (int i = 0; i <= axis.degree; ++i) {
            Vec4d& control = line[span.first_point + i];
            control = homogeneous(point, control.w);
        }
    }
}

/// Merges the collapsed spans of all lines of the net that are borders of patches.
void merge_collapsed_borders(BezierNet& net) {
    const size_t width = net.u.point_count;
    const auto lines = [](const SplineAxis& axis, const auto& merge) {
        for (const SplineSpan& span : axis.spans) {
            merge(size_t{span.first_point});
            merge(size_t{span.first_point} + axis.degree);
        }
    };
    lines(net.v, [&](size_t row) { merge_collapsed_spans({&net.points[row * width], 1}, net.u); });
    lines(net.u, [&](size_t column) { merge_collapsed_spans({&net.points[column], width}, net.v); });
}

/// Whether Blender draws a spline. Throws InputError for one that is not sound.
bool is_drawn(const std::string& name, size_t index, const NurbsSpline& spline) {
    const std::string prefix = "splines[" + std::to_string(index) + "].";
    const std::optional<SplineProblem> problem = find_problem(spline.surface);
    if (problem && problem->kind == SplineProblemKind::BadData)
        throw InputError(name, prefix + problem->argument, problem->got, problem->wanted);
    const int order = std::max(spline.surface.u.order, spline.surface.v.order);
    if (!problem && order > kLargestSurfaceDegree + 1)
        throw InputError(name, prefix + "order", std::to_string(order),
                         "2 to " + std::to_string(kLargestSurfaceDegree + 1));
    if (spline.material_slot < 0)
        throw InputError(name, prefix + "material_slot", std::to_string(spline.material_slot), "0 or more");
    return !problem;
}

/// The control points of one border of a patch.
struct BorderPoints {
    const Vec4d* first;
    size_t stride;
    int count;

    BorderPoints(const PatchView& patch, bool along_v, bool at_end)
        : first(along_v ? patch.points + (at_end ? patch.degree_u : 0) : patch.row(at_end ? patch.degree_v : 0)),
          stride(along_v ? patch.stride : 1),
          count(along_v ? patch.rows() : patch.columns()) {}
    const Vec4d& operator[](int i) const { return first[static_cast<size_t>(i) * stride]; }
    bool is_point() const {
        for (int i = 1; i < count; ++i)
            if (project((*this)[i]) != project((*this)[0])) return false;
        return true;
    }
    bool operator==(const BorderPoints& other) const {
        for (int i = 0; i < count; ++i)
            if ((*this)[i] != other[i]) return false;
        return true;
    }
};

/// The span across the border nearest to `parameter`; empty where the spline ends there or has an edge.
std::optional<size_t> span_beside(const std::vector<SplineSpan>& spans, size_t span, float parameter) {
    const size_t before = (span + spans.size() - 1) % spans.size(), after = (span + 1) % spans.size();
    const bool towards_begin = parameter < 0.5f;
    if (spans[towards_begin ? before : span].continuity_after < 1) return std::nullopt;
    return towards_begin ? before : after;
}

Box3d points_box(std::span<const NurbsSpline> splines) {
    Box3d box;
    for (const NurbsSpline& spline : splines)
        for (const Vec4d& point : spline.surface.points)
            if (is_place(spatial_part(point))) box.extendBy(spatial_part(point));
    return box;
}

/// Of a surface that deforms, what its frame must hold; empty of others.
Box3d extent_of(const PatchSurface::Splines& splines, const std::vector<PatchSurface::Splines>& moved) {
    Box3d extent;
    if (!moved.empty()) extent = points_box(splines);
    for (const PatchSurface::Splines& step : moved) extent.extendBy(points_box(step));
    return extent;
}

/// Whether the control points of two times are the same ones, with the same weights: only then do points of the surface
/// go along lines, as its facets do.
bool are_same_points(const NurbsSpline& a, const NurbsSpline& b) {
    return std::ranges::equal(a.surface.points, b.surface.points, std::equal_to(), &Vec4d::w, &Vec4d::w);
}

}  // namespace

PatchSurface::PatchSurface(std::string name, const Splines& splines, const std::vector<Splines>& moved)
    : PatchSurface(std::move(name), splines, extent_of(splines, moved)) {
    if (!moved.empty()) add_moments(splines, moved);
}

void PatchSurface::add_moments(const Splines& splines, const std::vector<Splines>& moved) {
    if (moved.size() < 2) throw InputError(name(), "moved_splines", std::to_string(moved.size()), "two or more times");
    const Box3d extent = extent_of(splines, moved);
    std::vector<std::unique_ptr<const Shape>> shapes;
    for (const Splines& step : moved) {
        auto shape = std::unique_ptr<PatchSurface>(new PatchSurface(name(), step, extent));
        if (!std::ranges::equal(step, splines, are_same_points) || !shape->has_elements_of(*this))
            throw InputError(name(), "moved_splines",
                             "other patches or weights at step " + std::to_string(shapes.size()),
                             "the same at all times");
        shapes.push_back(std::move(shape));
    }
    steps_ = shapes.size();
    moments_ = Moments(std::move(shapes));
    bounds_.extendBy(moments_.bounds());
}

bool PatchSurface::has_elements_of(const PatchSurface& other) const {
    return std::ranges::equal(splines_, other.splines_, [](const SplinePatches& a, const SplinePatches& b) {
        return a.degree_u == b.degree_u && a.degree_v == b.degree_v && a.spans_u.size() == b.spans_u.size() &&
               a.spans_v.size() == b.spans_v.size();
    });
}

PatchSurface::PatchSurface(std::string name, const Splines& splines, const Box3d& extent)
    : Shape(ShapeKind::PatchSurface, std::move(name)) {
    std::vector<const NurbsSpline*> drawn;
    for (size_t i = 0; i < splines.size(); ++i) {
        if (!is_drawn(this->name(), i, splines[i])) continue;
        drawn.push_back(&splines[i]);
        for (const Vec4d& point : splines[i].surface.points) object_bounds_.extendBy(spatial_part(point));
    }
    Box3d whole = object_bounds_;
    whole.extendBy(extent);
    frame_ = LocalFrame::fitting(whole);
    for (const NurbsSpline* spline : drawn) add_spline(*spline);

    Box3d box;
    for (uint32_t i = 0; i < patch_count_; ++i) box.extendBy(hull_bounds(patch(i)));
    if (!box.isEmpty()) bounds_ = outward_float(box);
}

void PatchSurface::add_spline(const NurbsSpline& spline) {
    NurbsSurface local = spline.surface;
    for (Vec4d& point : local.points) {
        const Vec3d position = (spatial_part(point) - frame_.center) / frame_.scale;
        point = Vec4d(position.x, position.y, position.z, point.w);
    }
    BezierNet net = to_bezier(local);
    merge_collapsed_borders(net);

    SplinePatches patches;
    patches.degree_u = net.u.degree;
    patches.degree_v = net.v.degree;
    patches.rational = net.rational;
    patches.smooth = spline.smooth;
    patches.material_slot = static_cast<uint32_t>(spline.material_slot);
    patches.first_patch = patch_count_;
    patches.first_point = points_.size();
    patches.stride = net.u.point_count;
    if (points_.empty())
        points_ = std::move(net.points);
    else
        points_.insert(points_.end(), net.points.begin(), net.points.end());
    patches.spans_u = std::move(net.u.spans);
    patches.spans_v = std::move(net.v.spans);
    patch_count_ += patches.patch_count();
    splines_.push_back(std::move(patches));
}

const SplinePatches& PatchSurface::spline_of(uint32_t patch) const {
    if (splines_.size() == 1) return splines_.front();
    const auto after = std::upper_bound(splines_.begin(), splines_.end(), patch,
                                        [](uint32_t p, const SplinePatches& spline) { return p < spline.first_patch; });
    return *(after - 1);
}

BorderPlace PatchSurface::owner_place(const BorderPlace& place) const {
    const auto on_border = [](float at) { return at == 0.0f || at == 1.0f; };
    if (!on_border(place.parameters.x) && !on_border(place.parameters.y)) return place;
    const SplinePatches& spline = spline_of(place.element);
    const auto counts =
        std::array{static_cast<uint32_t>(spline.spans_u.size()), static_cast<uint32_t>(spline.spans_v.size())};
    const uint32_t number = place.element - spline.first_patch;
    std::array<uint32_t, 2> span = {number % counts[0], number / counts[0]};
    const auto index = [&](const std::array<uint32_t, 2>& of) {
        return spline.first_patch + of[1] * counts[0] + of[0];
    };
    Vec2f at = place.parameters;
    // The later patch owns a border. Where the spline closes, the first patch owns the border of the last.
    for (const int axis : {0, 1}) {
        if (at[axis] != 1.0f) continue;
        std::array<uint32_t, 2> next = span;
        next[axis] = (span[axis] + 1) % counts[axis];
        const BorderPoints here(patch(index(span)), axis == 0, true), there(patch(index(next)), axis == 0, false);
        if (!(here == there)) continue;
        span = next;
        at[axis] = 0.0f;
    }
    // All patches that meet at a pole use its first place.
    for (const int axis : {0, 1}) {
        if (!on_border(at[axis])) continue;
        const auto is_pole = [&](const std::array<uint32_t, 2>& of) {
            return BorderPoints(patch(index(of)), axis == 0, at[axis] == 1.0f).is_point();
        };
        const int along = 1 - axis;
        if (!is_pole(span)) continue;
        at[along] = 0.0f;
        for (std::array<uint32_t, 2> before = span; before[along] > 0; span = before) {
            --before[along];
            if (!is_pole(before)) break;
        }
    }
    return {index(span), at};
}

PatchSurface::PatchAt::PatchAt(const PatchSurface& surface, uint32_t patch, const SplinePatches& spline, float time)
    : mixed_(surface.deforms() ? spline.points_per_patch() : 0), view_(surface.patch(patch, spline)) {
    if (!surface.deforms()) return;
    surface.mix_points(patch, spline, time, mixed_.data());
    view_.points = mixed_.data();
    view_.stride = static_cast<size_t>(view_.columns());
}

void PatchSurface::mix_points(uint32_t patch, const SplinePatches& spline, float time, Vec4d* points) const {
    const StepShare step = step_share(time, steps());
    const PatchView from = form(step.first).patch(patch, spline), to = form(step.first + 1).patch(patch, spline);
    const auto columns = static_cast<size_t>(from.columns());
    for (int j = 0; j < from.rows(); ++j, points += columns)
        rayleaf::mix_points(from.row(j), to.row(j), step.share, columns, points);
}

Box3d PatchSurface::patch_box(uint32_t patch) const {
    Box3d box;
    for (size_t step = 0; step < steps(); ++step) box.extendBy(hull_bounds(form(step).patch(patch)));
    return box;
}

LocalSurface PatchSurface::surface(const LocalHit& hit) const {
    const SplinePatches& spline = spline_of(hit.primitive);
    const PatchAt now(*this, hit.primitive, spline, hit.time);
    return surface(hit, spline, now.view(), now.view().evaluate(hit.u, hit.v), std::nullopt);
}

/// The surface at a hit with a known point, and perhaps a known normal that depends on neither facet nor neighbour.
LocalSurface PatchSurface::surface(const LocalHit& hit, const SplinePatches& spline, const PatchView& view,
                                   const PatchPoint& point, const std::optional<LimitNormal>& known) const {
    const SplineSpan &span_u = spline.span_u(hit.primitive), &span_v = spline.span_v(hit.primitive);
    const double length_u = span_u.end - span_u.begin, length_v = span_v.end - span_v.begin;

    LocalSurface result;
    result.position = point.position;
    result.uv =
        Vec2f(static_cast<float>(span_u.begin + hit.u * length_u), static_cast<float>(span_v.begin + hit.v * length_v));
    result.dp_du = Vec3f(point.du / length_u);
    result.dp_dv = Vec3f(point.dv / length_v);
    const Vec3f facet_normal = normalized_or(hit.normal, Vec3f(0, 0, 1));
    if (!spline.smooth) {
        result.normal = facet_normal;
        return result;
    }
    const LimitNormal limit =
        known ? *known
              : limit_normal(view, hit.u, hit.v, point,
                             {[this, &hit] { return neighbour_normal(hit); }, -Vec3d(facet_normal)});
    if (limit.stage != NormalStage::Regular)
        limit_normals_[static_cast<size_t>(limit.stage)].fetch_add(1, std::memory_order_relaxed);
    // Where a coarse facet and the exact surface face opposite sides (next to a pole), the facet that was hit decides.
    const double side = Vec3f(limit.normal).dot(facet_normal) > 0.0f ? 1.0 : -1.0;
    result.normal = Vec3f(limit.normal * side);
    result.dn_du = Vec3f(limit.dn_du * (side / length_u));
    result.dn_dv = Vec3f(limit.dn_dv * (side / length_v));
    return result;
}

std::optional<Vec3d> PatchSurface::neighbour_normal(const LocalHit& hit) const {
    const SplinePatches& spline = spline_of(hit.primitive);
    const size_t index = hit.primitive - spline.first_patch, row = spline.spans_u.size();
    const std::optional<size_t> beside_u = span_beside(spline.spans_u, index % row, hit.u);
    const std::optional<size_t> beside_v = span_beside(spline.spans_v, index / row, hit.v);
    const auto normal_of = [&](size_t span_u, size_t span_v, double u, double v) -> std::optional<Vec3d> {
        const auto number = static_cast<uint32_t>(spline.first_patch + span_v * row + span_u);
        const LimitNormal limit = limit_normal(PatchAt(*this, number, spline, hit.time).view(), u, v);
        if (limit.stage >= NormalStage::Neighbour) return std::nullopt;
        return limit.normal;
    };
    const double border_u = hit.u < 0.5f ? 1.0 : 0.0, border_v = hit.v < 0.5f ? 1.0 : 0.0;
    const bool u_first = std::abs(hit.u - 0.5f) >= std::abs(hit.v - 0.5f);
    for (const bool along_u : {u_first, !u_first}) {
        std::optional<Vec3d> normal;
        if (along_u && beside_u) normal = normal_of(*beside_u, index / row, border_u, hit.v);
        if (!along_u && beside_v) normal = normal_of(index % row, *beside_v, hit.u, border_v);
        if (normal) return normal;
    }
    return std::nullopt;
}

NormalCounters PatchSurface::limit_normals() const {
    NormalCounters counters;
    for (size_t i = 0; i < kNormalStageCount; ++i)
        counters.counts[i] = limit_normals_[i].load(std::memory_order_relaxed);
    return counters;
}

ElementPoint PatchSurface::element_point_at(uint32_t element, const Vec2f& parameters, float time) const {
    const PatchAt now(*this, element, spline_of(element), time);
    ElementPoint result = element_point(now.view(), element, parameters);
    result.hit.time = time;
    return result;
}

ElementPoint PatchSurface::element_point(const PatchView& view, uint32_t element, const Vec2f& parameters) {
    const PatchPoint point = view.evaluate(parameters.x, parameters.y);
    ElementPoint result;
    result.normal = -Vec3f(limit_normal(view, parameters.x, parameters.y, point).normal);
    result.hit = placed_hit(element, parameters, point.position, result.normal);
    result.area_factor = static_cast<float>(point.du.cross(point.dv).length());
    return result;
}

void PatchSurface::line_points(uint32_t element, float u, std::span<const float> v, PlacedPoint* points) const {
    const PatchView view = patch(element);
    const SplinePatches& spline = spline_of(element);
    const PatchColumn column(view, u);
    for (size_t i = 0; i < v.size(); ++i) {
        const PatchPoint point = column.evaluate(v[i]);
        const LimitNormal normal = limit_normal(view, u, v[i], point);
        points[i].hit = placed_hit(element, {u, v[i]}, point.position, -Vec3f(normal.normal));
        const bool depends = normal.stage >= NormalStage::Neighbour;
        points[i].surface = surface(points[i].hit, spline, view, point, depends ? std::nullopt : std::optional(normal));
    }
}

std::optional<ContentHash> PatchSurface::hash_of_content() const {
    ContentHasher hasher;
    add_to(hasher);
    for (const SplinePatches& spline : splines_) {
        hasher.add(spline.degree_u);
        hasher.add(spline.degree_v);
        hasher.add((spline.rational ? 1 : 0) + (spline.smooth ? 2 : 0));
        hasher.add(spline.material_slot);
        for (const auto* spans : {&spline.spans_u, &spline.spans_v}) {
            hasher.add(static_cast<uint64_t>(spans->size()));
            for (const SplineSpan& span : *spans) {
                hasher.add(span.begin);
                hasher.add(span.end);
                hasher.add(span.first_point);
                hasher.add(span.continuity_after);
            }
        }
    }
    hasher.add(points_);
    moments_.add_to(hasher);
    return hasher.value();
}

size_t PatchSurface::bytes() const {
    size_t total = sizeof(*this) + points_.capacity() * sizeof(Vec4d) + splines_.capacity() * sizeof(SplinePatches);
    for (const SplinePatches& spline : splines_)
        total += (spline.spans_u.capacity() + spline.spans_v.capacity()) * sizeof(SplineSpan);
    total += moments_.bytes();
    return total;
}

}  // namespace rayleaf
