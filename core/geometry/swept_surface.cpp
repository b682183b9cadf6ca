#include "geometry/swept_surface.h"

#include "base/largest.h"
#include "splines/bernstein.h"
#include "splines/bounds.h"

#include <algorithm>

#include <oneapi/tbb/parallel_for.h>

namespace rayleaf {
namespace {

/// Where a surface has no normal (a ring of radius 0, a curve without speed), it is taken this far inside the
/// piece.
constexpr double kTangentInset = 1e-3;
/// Step of the difference that gives the change of a ring's derivative.
constexpr double kRingStep = 1e-4;
/// Corners per profile part of the outline that decides which points of a cap's square lie on the cap.
constexpr int kOutlineCorners = 32;

/// P_v x P_u; zero where it is degenerate.
Vec3d crossing(const Vec3d& round, const Vec3d& along) {
    const Vec3d normal = round.cross(along);
    return normal.dot(normal) > kDegenerateWall * along.dot(along) * round.dot(round) ? normal : Vec3d(0.0);
}
Vec3d crossing(const SweepRingPoint& ring, const ProfilePoint& profile) {
    return crossing(ring.ring.vector(profile.first), ring.change.at(profile.position));
}

bool inside(const std::vector<Vec2d>& outline, const Vec2d& point) {
    bool result = false;
    for (size_t i = 0, before = outline.size() - 1; i < outline.size(); before = i++) {
        const Vec2d &a = outline[i], &b = outline[before];
        if ((a.y > point.y) != (b.y > point.y) && point.x < (b.x - a.x) * (point.y - a.y) / (b.y - a.y) + a.x)
            result = !result;
    }
    return result;
}

SweepPath::TaperUse taper_use(const SweptCurveDescription& curve) {
    if (!curve.taper) return SweepPath::TaperUse::None;
    switch (curve.taper_radius) {
        case TaperRadius::Multiply:
            return SweepPath::TaperUse::Multiply;
        case TaperRadius::Add:
            return SweepPath::TaperUse::Add;
        default:
            return SweepPath::TaperUse::Override;
    }
}

}  // namespace

SweptSurface::SweptSurface(const SweptCurveDescription& curve) : Shape(ShapeKind::SweptSurface, curve.name) {
    if (const auto problem = find_problem(curve))
        throw InputError(curve.name, problem->argument, problem->got, problem->wanted);
    ContentHasher hasher;
    curve.add_to(hasher);
    described_ = hasher.value();
    profiles_ = sweep_profiles(curve);
    for (const SweepProfile& profile : profiles_) {
        extents_.push_back(profile.extent());
        std::vector<Vec2d>& outline = cap_outlines_.emplace_back();
        for (size_t part = 0; part < profile.parts.size(); ++part)
            for (int k = 0; k < kOutlineCorners; ++k)
                outline.push_back(profile.evaluate(part, static_cast<double>(k) / kOutlineCorners).position);
        if (!profile.closed) outline.push_back(profile.evaluate(profile.parts.size() - 1, 1.0).position);
    }
    caps_ = curve.fill_caps;
    for (const CurveSplines& splines : curve.splines)
        groups_.push_back({static_cast<uint32_t>(splines.material_slot), splines.smooth});
    if (!profiles_.empty() || !curve.fill_materials.empty()) build_path(curve);
}

std::optional<ContentHash> SweptSurface::hash_of_content() const {
    ContentHasher hasher;
    add_to(hasher);
    for (const uint64_t word : described_) hasher.add(word);
    return hasher.value();
}

void SweptSurface::build_path(const SweptCurveDescription& curve) {
    Box3d box;
    for (const CurveSplines& splines : curve.splines)
        for (const Vec4d& point : splines.points) box.extendBy(spatial_part(point));
    const Vec3d center = box.isEmpty() ? Vec3d(0.0) : (box.min + box.max) * 0.5;
    path_.space = curve.dimensions == CurveDimensions::Two ? SweepSpace::Planar : SweepSpace::Spatial;
    path_.taper_use = taper_use(curve);
    SweepOptions options;
    options.twist = curve.twist;
    options.closed_twist = curve.closed_twist;
    options.bevel_start = curve.bevel_start;
    options.bevel_end = curve.bevel_end;
    options.start_mapping = curve.start_mapping;
    options.end_mapping = curve.end_mapping;
    options.taper_fits_bevel = curve.taper_fits_bevel;
    if (curve.taper) {
        taper_ = std::make_unique<CurveTaper>(*curve.taper);
        path_.taper = taper_.get();
        options.taper_knots = taper_->knots();
    }
    for (size_t i = 0; i < curve.splines.size(); ++i)
        add_splines(path_, curve.splines[i], static_cast<uint32_t>(i), center, options);
    constexpr size_t kMostElements = 1u << 30;
    const size_t profiles = std::max(profiles_.size(), size_t{1});
    if ((path_.pieces.size() + 2 * path_.splines.size()) * profiles > kMostElements)
        throw InputError(name(), "splines", std::to_string(path_.pieces.size()) + " pieces",
                         "fewer than " + std::to_string(kMostElements / profiles));
    path_.controls.shrink_to_fit();
    path_.pieces.shrink_to_fit();
    path_.rings.shrink_to_fit();
    path_.segments.shrink_to_fit();
    const std::vector<FillBorder> borders = fill_borders(curve, profiles_);
    double extent = 0.0;
    for (const double each : extents_) extent = std::max(extent, each);
    for (const FillBorder& border : borders) extent = std::max(extent, border.place.length());
    fit_frame(center, extent);
    fills_ = swept_fills(curve, path_, borders);
}

/// Fits the local space to rings at sampled places, with a margin for those in between.
void SweptSurface::fit_frame(const Vec3d& center, double extent) {
    constexpr int kLooks = 4;
    constexpr size_t kPiecesAtOnce = 4096;
    std::vector<Box3d> boxes((path_.pieces.size() + kPiecesAtOnce - 1) / kPiecesAtOnce);
    tbb::parallel_for(size_t{0}, boxes.size(), [&](size_t part) {
        const size_t end = std::min(path_.pieces.size(), (part + 1) * kPiecesAtOnce);
        for (size_t i = part * kPiecesAtOnce; i < end; ++i) {
            for (int k = 0; k <= kLooks; ++k) {
                const SweepRing ring = path_.ring(path_.pieces[i], static_cast<double>(k) / kLooks);
                Vec3d reach;
                for (int axis = 0; axis < 3; ++axis)
                    reach[axis] = extent * std::hypot(ring.across[axis], ring.up[axis]);
                boxes[part].extendBy(ring.center - reach);
                boxes[part].extendBy(ring.center + reach);
            }
        }
    });
    Box3d box;
    for (const Box3d& part : boxes) box.extendBy(part);
    if (box.isEmpty()) return;
    if (!is_place(box.min) || !is_place(box.max))
        throw InputError(name(), "points, radii and bevel", "too large to be added", "sums up to 1e100");
    object_bounds_ = Box3d(box.min + center, box.max + center);
    constexpr double kMargin = 1.25;  // the surface bulges by less between samples a quarter of 50 degrees apart
    const double half = std::max(max_abs(box.min), max_abs(box.max)) * kMargin;
    frame_.center = center;
    frame_.scale = half > 0.0 ? std::exp2(std::ceil(std::log2(half))) : 1.0;
    divide_lengths(path_, frame_.scale);
    const double margin = (kMargin - 1.0) * half / frame_.scale;
    bounds_ = outward_float(Box3d(box.min / frame_.scale - Vec3d(margin), box.max / frame_.scale + Vec3d(margin)));
}

SweptElement SweptSurface::element(uint32_t index) const {
    SweptElement result;
    const auto pieces = static_cast<uint32_t>(path_.pieces.size()),
               splines = static_cast<uint32_t>(path_.splines.size());
    if (index < first_cap()) {
        result.profile = index / pieces;
        result.piece = index % pieces;
        return result;
    }
    if (index >= first_fill()) {
        result.part = SweptPart::Fill;
        result.fill = index - first_fill();
        return result;
    }
    const uint32_t cap = index - first_cap();
    result.part = SweptPart::Cap;
    result.end = cap % 2 == 0 ? CapEnd::Begin : CapEnd::End;
    result.spline = cap / 2 % splines;
    result.profile = cap / 2 / splines;
    return result;
}

const SweptSurface::Group& SweptSurface::group_of(const SweptElement& element) const {
    const bool is_cap = element.part == SweptPart::Cap;
    return groups_[(is_cap ? path_.splines[element.spline] : path_.spline_of(element.piece)).group];
}

uint32_t SweptSurface::material_slot(const LocalHit& hit) const {
    const SweptElement where = element(hit.primitive);
    return where.part == SweptPart::Fill ? fills_[where.fill].material_slot : group_of(where).material_slot;
}

SweepRing SweptSurface::end_ring(const SweepSpline& spline, CapEnd end) const {
    const uint32_t piece = spline.first_piece + (end == CapEnd::End ? spline.piece_count - 1 : 0);
    return path_.ring(path_.pieces[piece], end == CapEnd::End ? 1.0 : 0.0);
}

Vec2f SweptSurface::cap_parameters(uint32_t profile, const Vec2d& place) const {
    const double side = 2.0 * extents_[profile];
    return Vec2f(Vec2d(place.x / side + 0.5, place.y / side + 0.5));
}

Vec2d SweptSurface::cap_place(uint32_t profile, const Vec2f& parameters) const {
    const double side = 2.0 * extents_[profile];
    return {(static_cast<double>(parameters.x) - 0.5) * side, (static_cast<double>(parameters.y) - 0.5) * side};
}

Vec3d SweptSurface::cap_normal(const SweepRing& ring, CapEnd end) const {
    return ring.across.cross(ring.up) * (end == CapEnd::End ? 1.0 : -1.0);
}

LocalSurface SweptSurface::surface(const LocalHit& hit, SurfaceDetail detail) const {
    const SweptElement where = element(hit.primitive);
    switch (where.part) {
        case SweptPart::Cap:
            return cap_surface(hit, where);
        case SweptPart::Fill:
            return fills_[where.fill].surface(hit);
        default:
            return wall_surface(hit, where, detail);
    }
}

LocalSurface SweptSurface::cap_surface(const LocalHit& hit, const SweptElement& where) const {
    const SweepRing ring = end_ring(path_.splines[where.spline], where.end);
    const Vec2d place = cap_place(where.profile, Vec2f(hit.u, hit.v));
    LocalSurface result;
    result.position = ring.at(place);
    result.normal = normalized_or(hit.normal, Vec3f(0, 0, 1));
    result.uv = Vec2f(hit.u, hit.v);
    const double side = 2.0 * extents_[where.profile];
    result.dp_du = Vec3f(ring.across * side);
    result.dp_dv = Vec3f(ring.up * side);
    return result;
}

WallPlace SweptSurface::wall_place(const LocalHit& hit, const SweptElement& wall) const {
    WallPlace result;
    const SweepPiece& piece = path_.pieces[wall.piece];
    const SweepSpline& spline = path_.spline_of(wall.piece);
    const SweepProfile& profile = profiles_[wall.profile];
    const ProfilePlace place = profile_place(profile, hit.v);
    const SweepProfile::Shares shares = profile.shares(place.part);
    result.piece = &piece;
    result.u = hit.u;
    result.around = profile.evaluate(place.part, place.s);
    result.uv = Vec2f(static_cast<float>((path_.share(piece, result.u) - spline.share_begin) / spline.share_length),
                      static_cast<float>(shares.begin + shares.length * place.s));
    result.length_u = path_.share_length(piece) / spline.share_length;
    result.length_v = shares.length;
    result.smooth = groups_[spline.group].smooth;
    return result;
}

LocalSurface SweptSurface::wall_surface(const LocalHit& hit, const SweptElement& where, SurfaceDetail detail) const {
    const WallPlace place = wall_place(hit, where);
    const SweepPiece& piece = *place.piece;
    const ProfilePoint& around = place.around;
    const double u = place.u;
    const SweepRingPoint ring = path_.evaluate(piece, u);
    const Vec3d along = ring.change.at(around.position), round = ring.ring.vector(around.first);

    LocalSurface result;
    result.position = ring.ring.at(around.position);
    result.uv = place.uv;
    result.dp_du = place.length_u > 0.0 ? float_or_zero(along / place.length_u) : Vec3f(0.0f);
    result.dp_dv = float_or_zero(round / place.length_v);
    const Vec3f facet_normal = normalized_or(hit.normal, Vec3f(0, 0, 1));
    result.normal = facet_normal;
    if (!place.smooth) return result;

    Vec3d normal = crossing(round, along);
    if (max_abs(normal) == 0.0) {
        normal = crossing(path_.evaluate(piece, u < 0.5 ? u + kTangentInset : u - kTangentInset), around);
        if (max_abs(normal) == 0.0) return result;
        result.normal = Vec3f(normalized_or(normal, Vec3d(facet_normal)));
        if (result.normal.dot(facet_normal) < 0.0f) result.normal = -result.normal;
        return result;
    }
    // m = P_v x P_u; the unit normal changes by the part of m' across it over |m|.
    const double length_m = normal.length();
    const Vec3d n = normal / length_m;
    const double side = Vec3f(n).dot(facet_normal) < 0.0f ? -1.0 : 1.0;
    result.normal = Vec3f(n * side);
    if (detail == SurfaceDetail::Normal) return result;
    const double step = u < 0.5 ? kRingStep : -kRingStep;
    const SweepRingPoint next = path_.evaluate(piece, u + step);
    const Vec3d along_along = (next.change.center - ring.change.center + next.change.vector(around.position) -
                               ring.change.vector(around.position)) /
                              step;
    const Vec3d along_round = ring.change.vector(around.first), round_round = ring.ring.vector(around.second);
    const auto change = [&](const Vec3d& dm) { return (dm - n * n.dot(dm)) * (side / length_m); };
    if (place.length_u > 0.0)
        result.dn_du = float_or_zero(change(along_round.cross(along) + round.cross(along_along)) / place.length_u);
    result.dn_dv = float_or_zero(change(round_round.cross(along) + round.cross(along_round)) / place.length_v);
    return result;
}

ElementPoint SweptSurface::element_point(uint32_t index, const Vec2f& parameters) const {
    const SweptElement where = element(index);
    ElementPoint result;
    result.hit.primitive = index;
    result.hit.u = parameters.x;
    result.hit.v = parameters.y;
    Vec3d normal;
    if (where.part == SweptPart::Fill) {
        const SweptFill& fill = fills_[where.fill];
        result.hit.position = fill.at(parameters);
        normal = fill.normal();
        result.area_factor = fill.covers(result.hit.position) ? fill.rectangle_area() : 0.0f;
    } else if (where.part == SweptPart::Cap) {
        const SweepRing ring = end_ring(path_.splines[where.spline], where.end);
        const Vec2d place = cap_place(where.profile, parameters);
        result.hit.position = ring.at(place);
        normal = cap_normal(ring, where.end);
        const double side = 2.0 * extents_[where.profile];
        const bool there = path_.splines[where.spline].capped && inside(cap_outlines_[where.profile], place);
        result.area_factor = there ? static_cast<float>(normal.length() * side * side) : 0.0f;
    } else {
        const SweepPiece& piece = path_.pieces[where.piece];
        const SweepProfile& profile = profiles_[where.profile];
        const ProfilePlace place = profile_place(profile, parameters.y);
        const ProfilePoint around = profile.evaluate(place.part, place.s);
        const SweepRingPoint ring = path_.evaluate(piece, parameters.x);
        result.hit.position = ring.ring.at(around.position);
        normal = crossing(ring, around) * static_cast<double>(profile.parts.size());
        result.area_factor = static_cast<float>(normal.length());
    }
    result.normal = Vec3f(normalized_or(normal, Vec3d(0, 0, 1)));
    result.hit.normal = result.normal;
    return result;
}

size_t SweptSurface::bytes() const {
    size_t total = sizeof(*this) + path_.bytes() + groups_.capacity() * sizeof(Group);
    for (const SweepProfile& profile : profiles_) {
        total += profile.parts.capacity() * sizeof(ProfilePart);
        for (const ProfilePart& part : profile.parts) total += part.curve.points.capacity() * sizeof(Vec4d);
    }
    for (const std::vector<Vec2d>& outline : cap_outlines_) total += outline.capacity() * sizeof(Vec2d);
    for (const SweptFill& fill : fills_) total += fill.bytes();
    return total;
}

}  // namespace rayleaf
