#include "shading/voronoi.h"

#include "shading/lattice_hash.h"

#include <limits>

namespace rayleaf {
namespace {

/// Farther than any point of the cubes around.
constexpr float kFarthestPoint = 8.0f;

template <int N, typename Function>
LatticePoint<N> each(const LatticePoint<N>& a, const LatticePoint<N>& b, Function function) {
    LatticePoint<N> result{};
    for (int i = 0; i < N; ++i) result[i] = function(a[i], b[i]);
    return result;
}
template <int N>
LatticePoint<N> plus(const LatticePoint<N>& a, const LatticePoint<N>& b) {
    return each<N>(a, b, [](float x, float y) { return x + y; });
}
template <int N>
LatticePoint<N> minus(const LatticePoint<N>& a, const LatticePoint<N>& b) {
    return each<N>(a, b, [](float x, float y) { return x - y; });
}
template <int N>
float dot(const LatticePoint<N>& a, const LatticePoint<N>& b) {
    float sum = 0.0f;
    for (int i = 0; i < N; ++i) sum += a[i] * b[i];
    return sum;
}
template <int N>
float length(const LatticePoint<N>& v) {
    return std::sqrt(dot<N>(v, v));
}

// Where in its cube the point of a cell lies, each coordinate 0..1. The rules are Blender's.
LatticePoint<1> chance(const LatticePoint<1>& c) {
    return {unit_hash(c[0])};
}
LatticePoint<2> chance(const LatticePoint<2>& c) {
    return {unit_hash(c[0], c[1]), unit_hash(c[0], c[1], 1.0f)};
}
LatticePoint<3> chance(const LatticePoint<3>& c) {
    return {unit_hash(c[0], c[1], c[2]), unit_hash(c[0], c[1], c[2], 1.0f), unit_hash(c[0], c[1], c[2], 2.0f)};
}
LatticePoint<4> chance(const LatticePoint<4>& c) {
    return {unit_hash(c[0], c[1], c[2], c[3]), unit_hash(c[3], c[0], c[1], c[2]), unit_hash(c[2], c[3], c[0], c[1]),
            unit_hash(c[1], c[2], c[3], c[0])};
}

Color color_of(const LatticePoint<1>& c) {
    return {unit_hash(c[0]), unit_hash(c[0], 1.0f), unit_hash(c[0], 2.0f)};
}
Color color_of(const LatticePoint<2>& c) {
    return {unit_hash(c[0], c[1]), unit_hash(c[0], c[1], 1.0f), unit_hash(c[0], c[1], 2.0f)};
}
Color color_of(const LatticePoint<3>& c) {
    const LatticePoint<3> p = chance(c);
    return {p[0], p[1], p[2]};
}
Color color_of(const LatticePoint<4>& c) {
    return {unit_hash(c[0], c[1], c[2], c[3]), unit_hash(c[2], c[0], c[3], c[1]), unit_hash(c[3], c[2], c[1], c[0])};
}

template <int N>
LatticePoint<N> chance(const LatticePoint<N>& c, VoronoiHash hash) {
    if constexpr (N > 1)
        if (hash == VoronoiHash::Pcg) return pcg_hash(c);
    return chance(c);
}

template <int N>
Color color_of(const LatticePoint<N>& c, VoronoiHash hash) {
    if constexpr (N > 1) {
        if (hash == VoronoiHash::Pcg) {
            std::array<float, std::max(N, 3)> padded{};
            std::copy(c.begin(), c.end(), padded.begin());
            const auto numbers = pcg_hash(padded);
            return {numbers[0], numbers[1], numbers[2]};
        }
    }
    return color_of(c);
}

/// The texture around one place: its cell, and the place within it.
template <int N>
class Cells {
  public:
    Cells(const LatticePoint<N>& p, const VoronoiParameters& parameters)
        : parameters_(parameters), randomness_(std::clamp(parameters.randomness, 0.0f, 1.0f)) {
        for (int i = 0; i < N; ++i) {
            const float x = std::isfinite(p[i]) ? p[i] : 0.0f;
            cell_[i] = std::floor(x);
            local_[i] = x - cell_[i];
        }
    }

    VoronoiResult nearest() const;
    VoronoiResult second_nearest() const;
    VoronoiResult smooth() const;
    float distance_to_edge() const;
    float sphere_radius() const;
    /// By the metric.
    float distance(const LatticePoint<N>& a, const LatticePoint<N>& b) const;

  private:
    /// Calls a function with the offset of each cell at most `reach` away, the first coordinate fastest.
    template <typename Function>
    static void around(int reach, Function function) {
        LatticePoint<N> offset;
        offset.fill(static_cast<float>(-reach));
        for (;;) {
            function(offset);
            int i = 0;
            for (; i < N && offset[i] == static_cast<float>(reach); ++i) offset[i] = static_cast<float>(-reach);
            if (i == N) return;
            offset[i] += 1.0f;
        }
    }
    /// The point of a neighbouring cell, from this cell's corner.
    LatticePoint<N> point_in(const LatticePoint<N>& offset) const {
        LatticePoint<N> p = chance<N>(plus<N>(cell_, offset), parameters_.hash);
        for (int i = 0; i < N; ++i) p[i] = offset[i] + p[i] * randomness_;
        return p;
    }
    /// How far the point of a neighbouring cell is at least, by the metric: it lies in a cube of `randomness_`.
    float least_distance(const LatticePoint<N>& offset) const {
        constexpr float kRounding = 1e-5f;
        if (parameters_.metric == VoronoiMetric::Minkowski) return 0.0f;  // its exponent may be anything
        LatticePoint<N> gap;
        for (int i = 0; i < N; ++i)
            gap[i] = std::max({offset[i] - local_[i], local_[i] - offset[i] - randomness_, 0.0f});
        return distance(gap, LatticePoint<N>{}) * (1.0f - kRounding) - kRounding;
    }
    /// The cell whose point is nearest by Euclid's distance.
    LatticePoint<N> nearest_cell(const LatticePoint<N>& from, const LatticePoint<N>* but) const;
    VoronoiResult result(float distance, const LatticePoint<N>& offset) const;
    Vec4f place(const LatticePoint<N>& p) const;

    const VoronoiParameters& parameters_;
    float randomness_;
    LatticePoint<N> cell_{}, local_{};
};

template <int N>
float Cells<N>::distance(const LatticePoint<N>& a, const LatticePoint<N>& b) const {
    const LatticePoint<N> apart = each<N>(a, b, [](float x, float y) { return std::abs(x - y); });
    if (N == 1) return apart[0];
    float sum = 0.0f, largest = 0.0f;
    switch (parameters_.metric) {
        case VoronoiMetric::Euclidean:
            return length<N>(apart);
        case VoronoiMetric::Manhattan:
            for (const float x : apart) sum += x;
            return sum;
        case VoronoiMetric::Chebychev:
            for (const float x : apart) largest = std::max(largest, x);
            return largest;
        case VoronoiMetric::Minkowski:
            for (const float x : apart) sum += std::pow(x, parameters_.exponent);
            return std::pow(sum, 1.0f / parameters_.exponent);
    }
    return 0.0f;
}

template <int N>
Vec4f Cells<N>::place(const LatticePoint<N>& p) const {
    const LatticePoint<N> at = plus<N>(p, cell_);
    if constexpr (N == 1) return Vec4f(0.0f, 0.0f, 0.0f, at[0]);
    Vec4f result(0.0f, 0.0f, 0.0f, 0.0f);
    for (int i = 0; i < N; ++i) result[i] = at[i];
    return result;
}

template <int N>
VoronoiResult Cells<N>::result(float distance, const LatticePoint<N>& offset) const {
    return {distance, color_of<N>(plus<N>(cell_, offset), parameters_.hash), place(point_in(offset))};
}

template <int N>
VoronoiResult Cells<N>::nearest() const {
    float least = kFarthestPoint;
    LatticePoint<N> found{};
    // Most cells are farther than the point of the own one; of those as far as each other the first counts.
    const float own = distance(point_in(found), local_);
    around(1, [&](const LatticePoint<N>& offset) {
        if (least_distance(offset) > std::min(least, own)) return;
        const float d = distance(point_in(offset), local_);
        if (!(d < least)) return;
        least = d;
        found = offset;
    });
    return result(least, found);
}

template <int N>
VoronoiResult Cells<N>::second_nearest() const {
    float first = kFarthestPoint, second = kFarthestPoint;
    LatticePoint<N> first_cell{}, second_cell{};
    around(1, [&](const LatticePoint<N>& offset) {
        if (least_distance(offset) > second) return;
        const float d = distance(point_in(offset), local_);
        if (d < first) {
            second = first;
            second_cell = first_cell;
            first = d;
            first_cell = offset;
        } else if (d < second) {
            second = d;
            second_cell = offset;
        }
    });
    return result(second, second_cell);
}

/// The nearest by a minimum that blends: where two distances differ by less than the smoothness, so do their cells. The
/// order in which cells are blended counts a little.
template <int N>
VoronoiResult Cells<N>::smooth() const {
    const float smoothness = std::clamp(0.5f * parameters_.smoothness, 0.0f, 0.5f);
    if (!(smoothness > 0.0f)) return nearest();
    float least = kFarthestPoint;
    Color color(0.0f);
    LatticePoint<N> point{};
    around(2, [&](const LatticePoint<N>& offset) {
        const LatticePoint<N> candidate = point_in(offset);
        const float d = distance(candidate, local_);
        const float x = std::clamp(0.5f + 0.5f * (least - d) / smoothness, 0.0f, 1.0f);
        const float share = x * x * (3.0f - 2.0f * x);
        float sunk = smoothness * share * (1.0f - share);
        const auto mixed = [&](float a, float b) { return a + (b - a) * share - sunk; };
        least = mixed(least, d);
        sunk /= 1.0f + 3.0f * smoothness;
        const Color other = color_of<N>(plus<N>(cell_, offset), parameters_.hash);
        color = {mixed(color.x, other.x), mixed(color.y, other.y), mixed(color.z, other.z)};
        point = each<N>(point, candidate, mixed);
    });
    return {least, color, place(point)};
}

template <int N>
LatticePoint<N> Cells<N>::nearest_cell(const LatticePoint<N>& from, const LatticePoint<N>* but) const {
    float least = std::numeric_limits<float>::max();
    LatticePoint<N> found{};
    around(1, [&](const LatticePoint<N>& step) {
        const LatticePoint<N> offset = but != nullptr ? plus<N>(*but, step) : step;
        if (but != nullptr && offset == *but) return;
        const LatticePoint<N> away = minus<N>(point_in(offset), from);
        const float d = dot<N>(away, away);
        if (!(d < least)) return;
        least = d;
        found = offset;
    });
    return found;
}

template <>
float Cells<1>::distance_to_edge() const {
    const float middle = point_in({0.0f})[0], left = point_in({-1.0f})[0], right = point_in({1.0f})[0];
    return std::min(std::abs(0.5f * (middle + left) - local_[0]), std::abs(0.5f * (middle + right) - local_[0]));
}

/// To the nearest plane halfway between the nearest point and another.
template <int N>
float Cells<N>::distance_to_edge() const {
    constexpr float kSamePoint = 1e-4f;  // squared: the point itself
    const LatticePoint<N> to_nearest = minus<N>(point_in(nearest_cell(local_, nullptr)), local_);
    float least = kFarthestPoint;
    around(1, [&](const LatticePoint<N>& offset) {
        const LatticePoint<N> to_other = minus<N>(point_in(offset), local_), between = minus<N>(to_other, to_nearest);
        if (dot<N>(between, between) <= kSamePoint) return;
        least = std::min(least, 0.5f * dot<N>(plus<N>(to_nearest, to_other), between) / length<N>(between));
    });
    return least;
}

/// Half the way from the nearest point to the point nearest to that.
template <int N>
float Cells<N>::sphere_radius() const {
    const LatticePoint<N> cell = nearest_cell(local_, nullptr), center = point_in(cell);
    return 0.5f * length<N>(minus<N>(point_in(nearest_cell(center, &cell)), center));
}

template <int N>
VoronoiResult octave(const LatticePoint<N>& p, const VoronoiParameters& parameters) {
    const Cells<N> cells(p, parameters);
    switch (parameters.feature) {
        case VoronoiFeature::F1:
            return cells.nearest();
        case VoronoiFeature::F2:
            return cells.second_nearest();
        case VoronoiFeature::SMOOTH_F1:
            return cells.smooth();
        case VoronoiFeature::DISTANCE_TO_EDGE:
            return {cells.distance_to_edge(), Color(0.0f), Vec4f(0.0f, 0.0f, 0.0f, 0.0f)};
        case VoronoiFeature::N_SPHERE_RADIUS:
            return {cells.sphere_radius(), Color(0.0f), Vec4f(0.0f, 0.0f, 0.0f, 0.0f)};
    }
    return {};
}

/// Half the diagonal of the region in which a cell's point may lie, along each axis.
float reach(const VoronoiParameters& parameters) {
    return 0.5f + 0.5f * std::clamp(parameters.randomness, 0.0f, 1.0f);
}

/// The largest distance that counts as 1 after normalization.
template <int N>
float largest_distance(const VoronoiParameters& parameters) {
    const float along = reach(parameters);
    if (parameters.feature == VoronoiFeature::DISTANCE_TO_EDGE) return along;
    LatticePoint<N> corner;
    corner.fill(along);
    const float distance = Cells<N>({}, parameters).distance({}, corner);
    return parameters.feature == VoronoiFeature::F2 ? 2.0f * distance : distance;
}

/// Octaves laid over each other. Distances and colours add up; places are blended; of distances to the edge the least
/// counts, blended in by the octave's amplitude.
class VoronoiOctaves {
  public:
    VoronoiOctaves(VoronoiFeature feature, float largest_distance)
        : to_edge_(feature == VoronoiFeature::DISTANCE_TO_EDGE),
          largest_distance_(largest_distance),
          most_(to_edge_ ? largest_distance : 0.0f) {
        if (to_edge_) sum_.distance = kFarthestPoint;
    }

    /// The next octave, found at `scale` times the coordinate; `share` of it, 0..1.
    void add(const VoronoiResult& octave, float scale, float amplitude, float share) {
        const auto blend = [](auto a, auto b, float t) { return a * (1.0f - t) + b * t; };
        if (to_edge_) {
            if (scale == 0.0f) return;  // as wide as the world
            const float nearer = std::min(sum_.distance, octave.distance / scale);
            sum_.distance = blend(sum_.distance, nearer, amplitude * share);
            most_ = blend(most_, largest_distance_ / scale, amplitude * share);
            return;
        }
        sum_.distance += octave.distance * (amplitude * share);
        sum_.color += octave.color * (amplitude * share);
        for (int i = 0; i < 4 && scale != 0.0f; ++i)
            sum_.place[i] = blend(sum_.place[i], octave.place[i] / scale, amplitude * share);
        most_ += amplitude * share;
    }
    VoronoiResult sum() const { return sum_; }
    VoronoiResult normalized() const {
        if (to_edge_) return {sum_.distance / most_, sum_.color, sum_.place};
        return {sum_.distance / (most_ * largest_distance_), sum_.color / most_, sum_.place};
    }

  private:
    bool to_edge_;
    float largest_distance_;
    float most_;  ///< what the sum would be if each octave were at its largest
    VoronoiResult sum_;
};

template <int N>
VoronoiResult texture(const LatticePoint<N>& p, const VoronoiParameters& parameters) {
    if (parameters.feature == VoronoiFeature::N_SPHERE_RADIUS) return octave<N>(p, parameters);
    constexpr float kMostOctaves = 15.0f;
    const float detail = parameters.detail > 0.0f ? std::min(parameters.detail, kMostOctaves) : 0.0f;
    const float roughness = std::clamp(parameters.roughness, 0.0f, 1.0f);
    const bool single = detail == 0.0f || !(roughness > 0.0f);
    if (single && !parameters.normalize) return octave<N>(p, parameters);
    VoronoiOctaves octaves(parameters.feature, parameters.normalize ? largest_distance<N>(parameters) : 1.0f);
    float scale = 1.0f, amplitude = 1.0f;
    for (float rest = single ? 1.0f : 1.0f + detail; rest > 0.0f; rest -= 1.0f) {
        LatticePoint<N> scaled = p;
        for (float& x : scaled) x *= scale;
        octaves.add(octave<N>(scaled, parameters), scale, amplitude, std::min(rest, 1.0f));
        scale *= parameters.lacunarity;
        amplitude *= roughness;
    }
    return parameters.normalize ? octaves.normalized() : octaves.sum();
}

}  // namespace

VoronoiResult voronoi_texture(int dimensions, const Vec4f& point, const VoronoiParameters& parameters) {
    switch (dimensions) {
        case 1:
            return texture<1>({point.w}, parameters);
        case 2:
            return texture<2>({point.x, point.y}, parameters);
        case 3:
            return texture<3>({point.x, point.y, point.z}, parameters);
        default:
            return texture<4>({point.x, point.y, point.z, point.w}, parameters);
    }
}

}  // namespace rayleaf
