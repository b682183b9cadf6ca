#include "tessellation/filled_area.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

namespace rayleaf {
namespace {

using Triangles = std::vector<std::array<uint32_t, 3>>;

struct Box {
    double low_x = std::numeric_limits<double>::infinity(), low_y = low_x;
    double high_x = -low_x, high_y = -low_x;

    void extend(const AreaPoint& p) {
        low_x = std::min(low_x, p.x);
        low_y = std::min(low_y, p.y);
        high_x = std::max(high_x, p.x);
        high_y = std::max(high_y, p.y);
    }
    bool contains(const AreaPoint& p) const { return p.x >= low_x && p.x <= high_x && p.y >= low_y && p.y <= high_y; }
};

/// Twice the area of a triangle, positive if it is counter-clockwise.
double turn(const AreaPoint& a, const AreaPoint& b, const AreaPoint& c) {
    const double abx = b.x - a.x, aby = b.y - a.y, acx = c.x - a.x, acy = c.y - a.y;
    return abx * acy - aby * acx;
}

/// A corner of a polygon, in a linked ring. With a bridge, a point becomes a corner twice.
struct Corner {
    uint32_t point = 0, before = 0, after = 0;
    bool cut = false;
};

struct Polygon {
    uint32_t first = 0;  ///< a corner
    uint32_t size = 0;   ///< corners
    uint32_t leftmost = 0;
    double area = 0;
    Box box;
};

class Area {
  public:
    Area(std::span<const AreaPoint> points, std::span<const uint32_t> begins);
    Triangles triangles() &&;

  private:
    std::span<const AreaPoint> points_;
    std::vector<Corner> corners_;
    std::vector<Polygon> polygons_;
    Triangles triangles_;

    const AreaPoint& at(uint32_t corner) const { return points_[corners_[corner].point]; }
    void add_polygon(uint32_t begin, uint32_t end);
    bool contains(const Polygon& polygon, const AreaPoint& point) const;
    std::vector<std::vector<uint32_t>> holes_of_outlines() const;
    void join(const Polygon& outline, std::vector<uint32_t> holes);
    std::optional<uint32_t> seen_to_the_left(const Polygon& outline, const AreaPoint& from) const;
    bool opens_towards(uint32_t corner, const AreaPoint& to) const;
    void bridge(uint32_t from, uint32_t to);
    void cut_ears(const Polygon& polygon);
};

Area::Area(std::span<const AreaPoint> points, std::span<const uint32_t> begins) : points_(points) {
    corners_.reserve(points.size());
    for (size_t k = 0; k + 1 < begins.size(); ++k) add_polygon(begins[k], begins[k + 1]);
}

/// Adds a polygon. Corners that coincide with the one before are left out.
void Area::add_polygon(uint32_t begin, uint32_t end) {
    Polygon polygon;
    polygon.first = static_cast<uint32_t>(corners_.size());
    for (uint32_t i = begin; i < end; ++i)
        if (corners_.size() == polygon.first || points_[i] != points_[corners_.back().point])
            corners_.push_back({i, 0, 0, false});
    while (corners_.size() > polygon.first + 1 && at(polygon.first) == points_[corners_.back().point])
        corners_.pop_back();
    polygon.size = static_cast<uint32_t>(corners_.size()) - polygon.first;
    if (polygon.size < 3) {
        corners_.resize(polygon.first);
        return;
    }
    polygon.leftmost = polygon.first;
    const AreaPoint& origin = at(polygon.first);
    for (uint32_t k = 0; k < polygon.size; ++k) {
        const uint32_t corner = polygon.first + k;
        corners_[corner].before = polygon.first + (k + polygon.size - 1) % polygon.size;
        corners_[corner].after = polygon.first + (k + 1) % polygon.size;
        polygon.area += turn(origin, at(corner), at(corners_[corner].after));
        polygon.box.extend(at(corner));
        const AreaPoint &here = at(corner), &best = at(polygon.leftmost);
        if (here.x != best.x ? here.x < best.x : here.y < best.y) polygon.leftmost = corner;
    }
    polygons_.push_back(polygon);
}

bool Area::contains(const Polygon& polygon, const AreaPoint& point) const {
    if (!polygon.box.contains(point)) return false;
    bool inside = false;
    for (uint32_t corner = polygon.first; corner < polygon.first + polygon.size; ++corner) {
        const AreaPoint &a = at(corner), &b = at(corners_[corner].after);
        if ((a.y > point.y) == (b.y > point.y)) continue;
        if ((turn(a, b, point) > 0.0) == (b.y > a.y)) inside = !inside;
    }
    return inside;
}

/// By polygon: the holes directly inside an outline. A hole without an outline counts as an outline itself.
std::vector<std::vector<uint32_t>> Area::holes_of_outlines() const {
    std::vector<uint32_t> order(polygons_.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
        const double x = polygons_[a].box.low_x, y = polygons_[b].box.low_x;
        return x != y ? x < y : a < b;
    });
    std::vector<std::vector<uint32_t>> holes(polygons_.size());
    std::vector<uint32_t> open;  // outlines that begin farther left and may reach here
    for (const uint32_t number : order) {
        const Polygon& polygon = polygons_[number];
        if (polygon.area >= 0.0) {
            open.push_back(number);
            continue;
        }
        std::erase_if(open, [&](uint32_t outline) { return polygons_[outline].box.high_x < polygon.box.low_x; });
        std::optional<uint32_t> around;
        for (const uint32_t outline : open)
            if ((!around || polygons_[outline].area < polygons_[*around].area) &&
                contains(polygons_[outline], at(polygon.leftmost)))
                around = outline;
        if (around) holes[*around].push_back(number);
    }
    return holes;
}

/// Whether the direction to a point lies inside the angle at a corner.
bool Area::opens_towards(uint32_t corner, const AreaPoint& to) const {
    const AreaPoint &a = at(corners_[corner].before), &b = at(corner), &c = at(corners_[corner].after);
    if (turn(a, b, c) >= 0.0) return turn(a, b, to) >= 0.0 && turn(b, c, to) >= 0.0;
    return turn(a, b, to) >= 0.0 || turn(b, c, to) >= 0.0;
}

/// The corner of an outline, with the holes joined to it, that a hole's leftmost point is bridged to.
std::optional<uint32_t> Area::seen_to_the_left(const Polygon& outline, const AreaPoint& from) const {
    double nearest = -std::numeric_limits<double>::infinity();
    std::optional<uint32_t> found;
    uint32_t corner = outline.first;
    do {  // finds the first edge that a ray to the left meets: it runs downwards there
        const AreaPoint &a = at(corner), &b = at(corners_[corner].after);
        if (a.y >= from.y && b.y <= from.y && a.y != b.y) {
            const double x = a.x + (from.y - a.y) * (b.x - a.x) / (b.y - a.y);
            if (x <= from.x && x > nearest) {
                nearest = x;
                found = a.x < b.x ? corner : corners_[corner].after;
                if (x == from.x && a.y == from.y) return corner;
                if (x == from.x && b.y == from.y) return corners_[corner].after;
            }
        }
        corner = corners_[corner].after;
    } while (corner != outline.first);
    if (!found) return std::nullopt;
    // Corners in the triangle between the ray and that edge's end hide the end; of those, the one nearest to the ray's
    // direction is visible.
    const AreaPoint end = at(*found);
    const double side = end.y >= from.y ? 1.0 : -1.0;
    double flattest = std::abs(end.y - from.y) / std::max(1.0, from.x - end.x);
    uint32_t best = *found;
    corner = outline.first;
    do {
        const AreaPoint& p = at(corner);
        const double up = side * (p.y - from.y), left = from.x - p.x;
        if (p.x >= end.x && left > 0.0 && up >= 0.0 && p != end) {
            const double edge = side > 0.0 ? (end.y - from.y) : (from.y - end.y);
            const double limit = edge > 0.0 ? nearest + (end.x - nearest) * (up / edge) : nearest;
            const double slope = up / left;
            const bool flatter = slope < flattest || (slope == flattest && p.x > at(best).x);
            if (up <= edge && p.x >= limit && flatter && opens_towards(corner, from)) {
                flattest = slope;
                best = corner;
            }
        }
        corner = corners_[corner].after;
    } while (corner != outline.first);
    // Of several corners at one point, take the one whose angle contains the bridge.
    if (!opens_towards(best, from)) {
        corner = outline.first;
        do {
            if (at(corner) == at(best) && opens_towards(corner, from)) return corner;
            corner = corners_[corner].after;
        } while (corner != outline.first);
    }
    return best;
}

/// Joins two rings to one: ... from, to, ..., to again, from again, ...
void Area::bridge(uint32_t from, uint32_t to) {
    const auto from_again = static_cast<uint32_t>(corners_.size()), to_again = from_again + 1;
    corners_.push_back(corners_[from]);
    corners_.push_back(corners_[to]);
    corners_[corners_[from].after].before = from_again;
    corners_[corners_[to].before].after = to_again;
    corners_[from].after = to;
    corners_[to].before = from;
    corners_[to_again].after = from_again;
    corners_[from_again].before = to_again;
}

void Area::join(const Polygon& outline, std::vector<uint32_t> holes) {
    std::sort(holes.begin(), holes.end(), [&](uint32_t a, uint32_t b) {
        const AreaPoint &p = at(polygons_[a].leftmost), &q = at(polygons_[b].leftmost);
        return p.x != q.x ? p.x < q.x : p.y < q.y;
    });
    for (const uint32_t number : holes) {
        const Polygon& hole = polygons_[number];
        const std::optional<uint32_t> from = seen_to_the_left(outline, at(hole.leftmost));
        if (!from) {
            cut_ears(hole);
            continue;
        }
        bridge(*from, hole.leftmost);
    }
}

/// Corners that may lie in ears, in a grid of squares.
class ReflexCorners {
  public:
    ReflexCorners(const Box& box, size_t count) : box_(box) {
        across_ = static_cast<size_t>(std::sqrt(static_cast<double>(count))) + 1;
        const double longest = std::max({box.high_x - box.low_x, box.high_y - box.low_y, 1.0}) * (1.0 + 1e-9);
        scale_ = static_cast<double>(across_) / longest;
        squares_.resize(across_ * across_);
    }
    void add(uint32_t corner, const AreaPoint& point) {
        squares_[row(point.y) * across_ + column(point.x)].push_back(corner);
    }
    template <class Test>
    bool any(const Box& box, const Test& test) const {
        for (size_t y = row(box.low_y); y <= row(box.high_y); ++y)
            for (size_t x = column(box.low_x); x <= column(box.high_x); ++x)
                for (const uint32_t corner : squares_[y * across_ + x])
                    if (test(corner)) return true;
        return false;
    }

  private:
    Box box_;
    size_t across_;
    double scale_;
    std::vector<std::vector<uint32_t>> squares_;

    size_t column(double x) const { return static_cast<size_t>((x - box_.low_x) * scale_); }
    size_t row(double y) const { return static_cast<size_t>((y - box_.low_y) * scale_); }
};

void Area::cut_ears(const Polygon& polygon) {
    const double side = polygon.area < 0.0 ? -1.0 : 1.0;
    const auto turns = [&](uint32_t corner) {
        return side * turn(at(corners_[corner].before), at(corner), at(corners_[corner].after));
    };
    Box box = polygon.box;
    uint32_t left = 0, corner = polygon.first;
    std::vector<uint32_t> reflex;
    do {
        box.extend(at(corner));
        if (turns(corner) <= 0.0) reflex.push_back(corner);
        ++left;
        corner = corners_[corner].after;
    } while (corner != polygon.first);
    ReflexCorners hidden(box, reflex.size());
    for (const uint32_t each : reflex) hidden.add(each, at(each));

    const auto is_ear = [&](uint32_t here) {
        const AreaPoint &a = at(corners_[here].before), &b = at(here), &c = at(corners_[here].after);
        const double area = turns(here);
        if (area <= 0.0) return area == 0.0;
        Box around;
        for (const AreaPoint* p : {&a, &b, &c}) around.extend(*p);
        return !hidden.any(around, [&](uint32_t other) {
            const AreaPoint& p = at(other);
            if (corners_[other].cut || p == a || p == b || p == c || !around.contains(p)) return false;
            return side * turn(a, b, p) >= 0.0 && side * turn(b, c, p) >= 0.0 && side * turn(c, a, p) >= 0.0;
        });
    };
    uint32_t failures = 0;
    while (left > 3) {
        // If no ear is left the polygon crosses itself, and any corner will do.
        if (failures < left && !is_ear(corner)) {
            corner = corners_[corner].after;
            ++failures;
            continue;
        }
        const uint32_t before = corners_[corner].before, after = corners_[corner].after;
        triangles_.push_back({corners_[before].point, corners_[corner].point, corners_[after].point});
        corners_[corner].cut = true;
        corners_[before].after = after;
        corners_[after].before = before;
        corner = before;
        --left;
        failures = 0;
    }
    triangles_.push_back(
        {corners_[corners_[corner].before].point, corners_[corner].point, corners_[corners_[corner].after].point});
}

Triangles Area::triangles() && {
    const std::vector<std::vector<uint32_t>> holes = holes_of_outlines();
    std::vector<bool> joined(polygons_.size());
    for (const std::vector<uint32_t>& own : holes)
        for (const uint32_t hole : own) joined[hole] = true;
    for (uint32_t number = 0; number < polygons_.size(); ++number) {
        if (joined[number]) continue;
        join(polygons_[number], holes[number]);
        cut_ears(polygons_[number]);
    }
    return std::move(triangles_);
}

}  // namespace

std::vector<std::array<uint32_t, 3>> triangles_of_area(std::span<const AreaPoint> points,
                                                       std::span<const uint32_t> begins) {
    return Area(points, begins).triangles();
}

}  // namespace rayleaf
