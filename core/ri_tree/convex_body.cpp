#include "ri_tree/convex_body.h"

#include "geometry/patch_surface.h"
#include "splines/bernstein.h"
#include "trace/bicubic.h"

#include <algorithm>
#include <cmath>

namespace rayleaf {
namespace {

/// Seeds along each side of a patch.
constexpr int kSeeds = 6;
/// Every so many seeds, one is tested against all tangent planes.
constexpr int kTestedApart = 3;
/// Bodies of more patches are traced: the time of the convexity test grows with the square.
constexpr uint32_t kMostPatches = 256;
/// Cells along each side of a face of the table's cube.
constexpr int kTableSide = 24;
/// How far a point may lie outside a tangent plane of a convex body, and how far a surface may bend outwards relative
/// to its first derivatives: the rounding of control points.
constexpr float kLeastDent = 1e-5f;
constexpr double kLeastBend = 1e-4;
/// The control points of a pole lie within this, local units: less than the facets' distance from the surface.
constexpr double kPoleSize = 1e-6;
/// Thinner bodies, local units, are traced.
constexpr float kLeastThickness = 0x1p-6f;
/// Lines that meet the surface at less than this cosine are near its silhouette.
constexpr float kLeastTangentCosine = 0.02f;
/// How far apart body and line must be for a miss, local units: the depth of dents that a lattice may overlook.
constexpr float kApart = 1e-4f;
/// Limits of the two iterations.
constexpr int kMostPlanes = 8;
constexpr int kMostPlaceSteps = 6;
/// How near the line the point must be, local units: the resolution of single precision.
constexpr float kTolerance = 2e-6f;

/// The cell of a cube's surface that a direction runs through.
uint32_t table_cell(const Vec3f& direction) {
    const float x = std::abs(direction.x), y = std::abs(direction.y), z = std::abs(direction.z);
    const int axis = x >= y && x >= z ? 0 : y >= z ? 1 : 2;
    const float along = direction[axis];
    const float scale = 0.5f * kTableSide / std::max(std::abs(along), 1e-30f);
    const auto column = [&](float across) {
        return std::clamp(static_cast<int>(across * scale + 0.5f * kTableSide), 0, kTableSide - 1);
    };
    const int face = 2 * axis + (along < 0.0f ? 1 : 0);
    const int first = column(direction[axis == 2 ? 0 : axis + 1]);
    const int second = column(direction[axis == 0 ? 2 : axis - 1]);
    return static_cast<uint32_t>((face * kTableSide + second) * kTableSide + first);
}

/// The middle of a cell of the table; not unit.
Vec3f middle_of_cell(int face, int second, int first) {
    const int axis = face / 2;
    const auto across = [](int column) { return (2.0f * static_cast<float>(column) + 1.0f) / kTableSide - 1.0f; };
    Vec3f direction;
    direction[axis] = (face & 1) != 0 ? -1.0f : 1.0f;
    direction[axis == 2 ? 0 : axis + 1] = across(first);
    direction[axis == 0 ? 2 : axis - 1] = across(second);
    return direction;
}

bool ends_in_poles(const PatchSurface& surface, const SplinePatches& spline, int axis) {
    const std::array<uint32_t, 2> counts = {static_cast<uint32_t>(spline.spans_u.size()),
                                            static_cast<uint32_t>(spline.spans_v.size())};
    for (uint32_t i = 0; i < counts[1 - axis]; ++i) {
        for (const bool at_end : {false, true}) {
            const uint32_t other = at_end ? counts[axis] - 1 : 0;
            const PatchView patch = surface.patch(axis == 0 ? i * counts[0] + other : other * counts[0] + i);
            const int last = at_end ? (axis == 0 ? patch.degree_u : patch.degree_v) : 0;
            const int along = axis == 0 ? patch.degree_v : patch.degree_u;
            const auto point = [&](int j) { return project(axis == 0 ? patch.point(last, j) : patch.point(j, last)); };
            for (int j = 1; j <= along; ++j)
                if ((point(j) - point(0)).length() > kPoleSize) return false;
        }
    }
    return true;
}

bool runs_on(const std::vector<SplineSpan>& spans, size_t count) {
    return std::all_of(spans.begin(), spans.begin() + static_cast<std::ptrdiff_t>(count),
                       [](const SplineSpan& span) { return span.continuity_after >= 0; });
}

/// Which axes are closed; empty unless exactly one is, and the other one ends in poles.
std::optional<std::array<bool, 2>> closed_axes(const PatchSurface& surface) {
    if (surface.splines().size() != 1) return std::nullopt;
    const SplinePatches& spline = surface.splines().front();
    if (!spline.smooth || spline.degree_u > 3 || spline.degree_v > 3) return std::nullopt;
    const std::array<const std::vector<SplineSpan>*, 2> spans = {&spline.spans_u, &spline.spans_v};
    std::array<bool, 2> closed{};
    for (int axis = 0; axis < 2; ++axis) {
        if (!runs_on(*spans[axis], spans[axis]->size() - 1)) return std::nullopt;
        closed[axis] = spans[axis]->back().continuity_after >= 0;
    }
    if (closed[0] == closed[1] || !ends_in_poles(surface, spline, closed[0] ? 1 : 0)) return std::nullopt;
    return closed;
}

}  // namespace

std::unique_ptr<const ConvexBody> ConvexBody::of(const Shape& shape) {
    if (shape.kind() != ShapeKind::PatchSurface) return nullptr;
    if (shape.element_count() == 0 || shape.element_count() > kMostPatches) return nullptr;
    const auto& surface = static_cast<const PatchSurface&>(shape);
    const Vec3f size = surface.bounds().size();
    if (!(std::min({size.x, size.y, size.z}) >= kLeastThickness)) return nullptr;
    const std::optional<std::array<bool, 2>> closed = closed_axes(surface);
    if (!closed) return nullptr;
    std::unique_ptr<ConvexBody> body(new ConvexBody(surface));
    body->closed_ = *closed;
    if (!body->is_convex(surface)) return nullptr;
    body->fill_table();
    return body;
}

ConvexBody::ConvexBody(const PatchSurface& surface) {
    const SplinePatches& spline = surface.splines().front();
    spans_ = {static_cast<int>(spline.spans_u.size()), static_cast<int>(spline.spans_v.size())};
    rational_ = spline.rational;
    add_patches(surface);
    add_seeds();
}

void ConvexBody::add_patches(const PatchSurface& surface) {
    patches_.resize(surface.element_count());
    for (uint32_t i = 0; i < surface.element_count(); ++i) {
        BezierPatch patch = BezierPatch::copy_of(surface.patch(i));
        while (patch.degree_u < 3) patch = patch.elevated(PatchDirection::U);
        while (patch.degree_v < 3) patch = patch.elevated(PatchDirection::V);
        for (size_t k = 0; k < patch.points.size(); ++k)
            for (int c = 0; c < 4; ++c) patches_[i].points[k][c] = static_cast<float>(patch.points[k][c]);
    }
}

void ConvexBody::add_seeds() {
    const std::array<int, 2> size = lattice();
    seeds_.resize(static_cast<size_t>(size[0]) * static_cast<size_t>(size[1]));
    for (uint32_t i = 0; i < seeds_.size(); ++i) {
        seeds_[i].tangent = tangent_at(place_of(i));
        seeds_[i].normal = normalized_or(seeds_[i].tangent.outward(), Vec3f(0, 0, 1));
        center_ += Vec3d(seeds_[i].tangent.position) / static_cast<double>(seeds_.size());
    }
    // The surface lies inside the hull of its control points.
    for (const Patch& patch : patches_) {
        for (const auto& point : patch.points) {
            const Vec3d position = Vec3d(point[0], point[1], point[2]) / (rational_ ? point[3] : 1.0);
            radius_ = std::max(radius_, (position - center_).length());
        }
    }
}

std::array<int, 2> ConvexBody::lattice() const {
    return {spans_[0] * kSeeds, spans_[1] * kSeeds};
}

ConvexBody::Place ConvexBody::place_of(uint32_t seed) const {
    const int row = lattice()[0];
    const std::array<int, 2> index = {static_cast<int>(seed) % row, static_cast<int>(seed) / row};
    Place place;
    for (int axis = 0; axis < 2; ++axis) {
        place.span[axis] = index[axis] / kSeeds;
        place.at[axis] = (static_cast<float>(index[axis] % kSeeds) + 0.5f) / kSeeds;
    }
    return place;
}

std::optional<uint32_t> ConvexBody::neighbour(uint32_t seed, int step_u, int step_v) const {
    const std::array<int, 2> size = lattice();
    std::array<int, 2> index = {static_cast<int>(seed) % size[0] + step_u, static_cast<int>(seed) / size[0] + step_v};
    for (int axis = 0; axis < 2; ++axis) {
        if (closed_[axis]) index[axis] = (index[axis] + size[axis]) % size[axis];
        if (index[axis] < 0 || index[axis] >= size[axis]) return std::nullopt;
    }
    return static_cast<uint32_t>(index[1] * size[0] + index[0]);
}

/// Whether the lattice is convex, and wound outwards: the surface is bent inwards at each of its points, and lies
/// behind its tangent plane with its neighbours and with points of every patch.
bool ConvexBody::is_convex(const PatchSurface& surface) const {
    const std::array<int, 2> size = lattice();
    const auto outside = [&](const Seed& seed, uint32_t other) {
        return seed.normal.dot(seeds_[other].tangent.position - seed.tangent.position) > kLeastDent;
    };
    for (uint32_t i = 0; i < seeds_.size(); ++i) {
        const Seed& seed = seeds_[i];
        if (!(seed.normal.dot(seed.tangent.position - Vec3f(center_)) > 0.0f)) return false;
        for (int step = 0; step < 9; ++step) {
            const std::optional<uint32_t> beside = neighbour(i, step % 3 - 1, step / 3 - 1);
            if (beside && outside(seed, *beside)) return false;
        }
        for (int v = kTestedApart / 2; v < size[1]; v += kTestedApart)
            for (int u = kTestedApart / 2; u < size[0]; u += kTestedApart)
                if (outside(seed, static_cast<uint32_t>(v * size[0] + u))) return false;
        const Place place = place_of(i);
        const PatchPoint point = surface.patch(static_cast<uint32_t>(place.span[1] * spans_[0] + place.span[0]))
                                     .evaluate(place.at.x, place.at.y);
        const Vec3d normal = normalized_or(point.dv.cross(point.du), Vec3d(0, 0, 1));
        const double uu = point.du.length2(), vv = point.dv.length2();
        const double bend_u = normal.dot(point.duu) / uu, bend_v = normal.dot(point.dvv) / vv;
        const double twist = normal.dot(point.duv) / std::sqrt(uu * vv);
        if (!(bend_u <= kLeastBend && bend_v <= kLeastBend && bend_u * bend_v - twist * twist >= -kLeastBend))
            return false;
    }
    return true;
}

/// Sets the seed next to the middle of each cell, found by climbing from the seed of the cell before.
void ConvexBody::fill_table() {
    std::vector<Vec3f> directions;
    for (const Seed& seed : seeds_)
        directions.push_back(normalized_or(seed.tangent.position - Vec3f(center_), Vec3f(0, 0, 1)));
    table_.resize(size_t{6} * kTableSide * kTableSide);
    uint32_t best = 0;
    for (int face = 0; face < 6; ++face) {
        for (int second = 0; second < kTableSide; ++second) {
            for (int first = 0; first < kTableSide; ++first) {
                const Vec3f wanted = middle_of_cell(face, second, first);
                for (uint32_t from = best;; from = best) {
                    for (int step = 0; step < 9; ++step) {
                        const std::optional<uint32_t> beside = neighbour(from, step % 3 - 1, step / 3 - 1);
                        if (beside && directions[*beside].dot(wanted) > directions[best].dot(wanted)) best = *beside;
                    }
                    if (best == from) break;
                }
                table_[table_cell(wanted)] = best;
            }
        }
    }
}

const ConvexBody::Seed& ConvexBody::seed_towards(const Vec3f& from_center) const {
    return seeds_[table_[table_cell(from_center)]];
}

ConvexBody::Tangent ConvexBody::tangent_at(const Place& place) const {
    const Patch& patch = patches_[static_cast<size_t>(place.span[1]) * static_cast<size_t>(spans_[0]) +
                                  static_cast<size_t>(place.span[0])];
    const auto [value, du, dv] = bicubic::tangent(patch.points, place.at.x, place.at.y);
    Tangent tangent{{value[0], value[1], value[2]}, {du[0], du[1], du[2]}, {dv[0], dv[1], dv[2]}};
    if (rational_) {
        tangent.position /= value[3];
        tangent.du = (tangent.du - tangent.position * du[3]) / value[3];
        tangent.dv = (tangent.dv - tangent.position * dv[3]) / value[3];
    }
    return tangent;
}

/// Moves by a step of the parameters, into a neighbouring patch if need be; false at a pole.
bool ConvexBody::move(Place& place, const Vec2f& step) const {
    for (int axis = 0; axis < 2; ++axis) {
        // At most into the adjacent patch.
        float at = place.at[axis] + std::clamp(step[axis], -1.0f, 1.0f);
        const int side = at < 0.0f ? -1 : at > 1.0f ? 1 : 0;
        if (side != 0) {
            int next = place.span[axis] + side;
            if (closed_[axis]) next = (next + spans_[axis]) % spans_[axis];
            if (next < 0 || next >= spans_[axis]) return false;
            place.span[axis] = next;
            at = std::clamp(at - static_cast<float>(side), 0.0f, 1.0f);
        }
        place.at[axis] = at;
    }
    return true;
}

ConvexBody::Meeting ConvexBody::leave(const Vec3d& origin, const Vec3d& direction, Crossing& crossing) const {
    // Distances count from the point nearest to the body's middle, so that distant origins lose no precision.
    const Vec3d start = origin + direction * (center_ - origin).dot(direction);
    const double beside = (start - center_).length2();
    if (!(beside < radius_ * radius_)) return beside > radius_ * radius_ ? Meeting::Missed : Meeting::Uncertain;
    const Vec3f from(start), along(direction);
    const auto chord = static_cast<float>(std::sqrt(radius_ * radius_ - beside));
    Chord inside{-chord, chord};
    const Seed* seed = nullptr;
    const Meeting meeting = close_in(from, along, inside, seed);
    if (meeting != Meeting::Crossed) return meeting;
    Place place = place_of(static_cast<uint32_t>(seed - seeds_.data()));
    Tangent tangent = seed->tangent;
    for (int step = 0; step < kMostPlaceSteps; ++step) {
        const Vec3f normal = tangent.outward();
        const float square = normal.length2(), cosine = normal.dot(along);
        if (!(cosine > kLeastTangentCosine * std::sqrt(square))) return Meeting::Uncertain;
        const float t = normal.dot(tangent.position - from) / cosine;
        const Vec3f missing = from + along * t - tangent.position;
        if (step > 0 && missing.length2() <= kTolerance * kTolerance) {
            crossing.position = start + direction * double{t};
            crossing.normal = Vec3d(normal / std::sqrt(square));
            crossing.element = static_cast<uint32_t>(place.span[1] * spans_[0] + place.span[0]);
            crossing.at = place.at;
            return Meeting::Crossed;
        }
        const Vec2f by(tangent.dv.cross(missing).dot(normal) / square, missing.cross(tangent.du).dot(normal) / square);
        if (!move(place, by)) return Meeting::Uncertain;
        tangent = tangent_at(place);
    }
    return Meeting::Uncertain;
}

/// Clips the part of a line that can be inside by tangent planes, towards its end; `seed` is the last plane's.
ConvexBody::Meeting ConvexBody::close_in(const Vec3f& from, const Vec3f& along, Chord& inside,
                                         const Seed*& seed) const {
    bool ends = true;
    for (int i = 0; i < kMostPlanes; ++i) {
        const float t = ends ? inside.end : 0.5f * (inside.begin + inside.end);
        const Seed* next = &seed_towards(from + along * t - Vec3f(center_));
        if (next == seed) break;
        seed = next;
        const float cosine = seed->normal.dot(along), before = seed->normal.dot(seed->tangent.position - from);
        ends = cosine > kLeastTangentCosine;
        if (std::abs(cosine) > kLeastTangentCosine) {
            float& bound = ends ? inside.end : inside.begin;
            bound = ends ? std::min(bound, before / cosine) : std::max(bound, before / cosine);
        }
        // A miss must be farther from the body than the planes are uncertain.
        const float least = std::min(cosine * inside.begin, cosine * inside.end);
        if (inside.begin > inside.end + kApart || least - before > kApart) return Meeting::Missed;
    }
    return ends ? Meeting::Crossed : Meeting::Uncertain;
}

}  // namespace rayleaf
