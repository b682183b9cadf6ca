#include "tessellation/profile_cells.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace rayleaf {
namespace {

/// Number of places at which the bend of a Bezier part is sampled.
constexpr int kProfileLooks = 16;

/// The largest second derivative of a part.
double bend(const SweepProfile& profile, size_t part) {
    double largest = 0.0;
    for (int k = 0; k <= kProfileLooks; ++k)
        largest = std::max(largest, profile.evaluate(part, static_cast<double>(k) / kProfileLooks).second.length());
    return largest;
}

/// Cells for each part: at least one, the rest by the root of the bend, so that all chords have the same error.
std::vector<int> distribute(const std::vector<double>& weights, int count) {
    std::vector<int> cells(weights.size(), 1);
    const double total = std::accumulate(weights.begin(), weights.end(), 0.0);
    const int left = count - static_cast<int>(cells.size());
    double passed = 0.0;
    int given = 0;
    for (size_t i = 0; i < cells.size(); ++i) {
        passed += total > 0.0 ? weights[i] / total : 1.0 / static_cast<double>(cells.size());
        const int up_to = i + 1 == cells.size() ? left : static_cast<int>(std::lround(passed * left));
        cells[i] += up_to - given;
        given = up_to;
    }
    return cells;
}

double cross(const Vec2d& a, const Vec2d& b, const Vec2d& c) {
    return (b - a).cross(c - a);
}

double doubled_area(const std::vector<Vec2d>& corners) {
    double sum = 0.0;
    for (size_t i = 0; i + 1 < corners.size(); ++i) sum += corners[i].cross(corners[i + 1]);
    return sum + corners.back().cross(corners.front());
}

/// Whether every edge turns the same way about the point: then the whole outline is visible from it.
bool sees_outline(const Vec2d& point, const std::vector<Vec2d>& corners, double side) {
    for (size_t i = 0; i < corners.size(); ++i) {
        const Vec2d &a = corners[i], &b = corners[(i + 1) % corners.size()];
        if (a != b && !(cross(point, a, b) * side >= 0.0)) return false;
    }
    return true;
}

/// The middle of the outline's kernel, from which all of it is visible; empty if there is none.
std::optional<Vec2d> kernel_middle(const std::vector<Vec2d>& corners, double side) {
    double reach = 0.0;
    for (const Vec2d& corner : corners) reach = std::max({reach, std::abs(corner.x), std::abs(corner.y)});
    std::vector<Vec2d> kernel = {{-reach, -reach}, {reach, -reach}, {reach, reach}, {-reach, reach}}, next;
    for (size_t i = 0; i < corners.size() && !kernel.empty(); ++i) {
        const Vec2d &a = corners[i], &b = corners[(i + 1) % corners.size()];
        if (a == b) continue;
        next.clear();
        for (size_t k = 0; k < kernel.size(); ++k) {
            const Vec2d &p = kernel[k], &q = kernel[(k + 1) % kernel.size()];
            const double at_p = cross(a, b, p) * side, at_q = cross(a, b, q) * side;
            if (at_p >= 0.0) next.push_back(p);
            if ((at_p < 0.0) != (at_q < 0.0)) next.push_back(p + (q - p) * (at_p / (at_p - at_q)));
        }
        kernel.swap(next);
    }
    if (kernel.empty()) return std::nullopt;
    const Vec2d middle = std::accumulate(kernel.begin(), kernel.end(), Vec2d(0.0)) / static_cast<double>(kernel.size());
    return sees_outline(middle, corners, side) ? std::optional(middle) : std::nullopt;
}

bool contains(const Vec2d& a, const Vec2d& b, const Vec2d& c, const Vec2d& p, double side) {
    return cross(a, b, p) * side >= 0.0 && cross(b, c, p) * side >= 0.0 && cross(c, a, p) * side >= 0.0;
}

/// Cuts ears off the outline. If it crosses itself there may be none left: the rest becomes a fan about a corner.
std::vector<std::array<uint32_t, 3>> cut_ears(const std::vector<Vec2d>& corners, double side) {
    std::vector<uint32_t> ring;
    for (uint32_t i = 0; i < corners.size(); ++i)
        if (ring.empty() || corners[ring.back()] != corners[i]) ring.push_back(i);
    std::vector<std::array<uint32_t, 3>> triangles;
    size_t at = 0, failures = 0;
    while (ring.size() > 3 && failures < ring.size()) {
        const size_t n = ring.size(), before = (at + n - 1) % n, after = (at + 1) % n;
        const Vec2d &a = corners[ring[before]], &b = corners[ring[at]], &c = corners[ring[after]];
        bool ear = cross(a, b, c) * side >= 0.0;
        for (size_t k = 0; k < n && ear; ++k) {
            const Vec2d& p = corners[ring[k]];
            ear = p == a || p == b || p == c || !contains(a, b, c, p, side);
        }
        if (!ear) {
            at = after;
            ++failures;
            continue;
        }
        triangles.push_back({ring[before], ring[at], ring[after]});
        ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(at));
        at = (at + ring.size() - 1) % ring.size();
        failures = 0;
    }
    for (size_t k = 1; k + 1 < ring.size(); ++k) triangles.push_back({ring[0], ring[k], ring[k + 1]});
    return triangles;
}

ProfileCells make_cells(const SweepProfile& profile, const std::vector<double>& weights, int count) {
    ProfileCells result;
    result.count = count;
    const std::vector<int> cells = distribute(weights, count);
    for (size_t part = 0; part < cells.size(); ++part) {
        const double length = 1.0 / cells[part];
        for (int k = 0; k < cells[part]; ++k) {
            const ProfilePlace place{part, k * length};
            result.begins.push_back(place);
            result.lengths.push_back(length);
            result.corners.push_back(profile.evaluate(place.part, place.s).position);
        }
        const double root = weights[part] * length;
        result.error = std::max(result.error, root * root / 8.0);
    }
    result.corners.push_back(profile.closed ? result.corners.front()
                                            : profile.evaluate(profile.parts.size() - 1, 1.0).position);
    return result;
}

}  // namespace

ProfilePlace ProfileCells::place(double at) const {
    const auto cell = static_cast<size_t>(std::clamp(at, 0.0, count - 1.0));
    const double s = begins[cell].s + lengths[cell] * std::clamp(at - static_cast<double>(cell), 0.0, 1.0);
    return {begins[cell].part, std::min(s, 1.0)};
}

double ProfileCells::at(const ProfilePlace& place) const {
    const auto after = std::upper_bound(
        begins.begin(), begins.end(), place,
        [](const ProfilePlace& a, const ProfilePlace& b) { return a.part != b.part ? a.part < b.part : a.s < b.s; });
    const size_t cell = after == begins.begin() ? 0 : static_cast<size_t>(after - begins.begin()) - 1;
    return static_cast<double>(cell) + std::clamp((place.s - begins[cell].s) / lengths[cell], 0.0, 1.0);
}

uint32_t ProfileCells::cap_grids() const {
    if (center) return static_cast<uint32_t>(count / kGridCells);
    return (static_cast<uint32_t>(triangles.size()) + kTrianglesInGrid - 1) / kTrianglesInGrid;
}

std::vector<ProfileCells> profile_cells(const SweepProfile& profile) {
    std::vector<double> weights;
    for (size_t part = 0; part < profile.parts.size(); ++part) weights.push_back(std::sqrt(bend(profile, part)));
    const int parts = static_cast<int>(profile.parts.size());
    const int least = (parts + kGridCells - 1) / kGridCells * kGridCells;
    std::vector<ProfileCells> levels;
    for (int level = 0; level <= kMostProfileLevels; ++level) {
        levels.push_back(make_cells(profile, weights, least << level));
        if (levels.back().error == 0.0) break;
    }
    return levels;
}

void add_cap(ProfileCells& cells, const SweepProfile& profile) {
    std::vector<Vec2d> outline = cells.corners;
    if (profile.closed) outline.pop_back();
    const double side = doubled_area(outline) < 0.0 ? -1.0 : 1.0;
    Vec2d middle(0.0);
    for (const Vec2d& corner : outline) middle += corner / static_cast<double>(outline.size());
    // The outline of an open profile is closed by the chord between its ends; a fan about a point of it has no facet
    // there.
    if (!profile.closed) middle = (outline.front() + outline.back()) * 0.5;
    if (sees_outline(middle, outline, side))
        cells.center = middle;
    else if (profile.closed)
        cells.center = kernel_middle(outline, side);
    if (!cells.center) cells.triangles = cut_ears(outline, side);
}

}  // namespace rayleaf
