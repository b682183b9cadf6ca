#include "shading/voronoi.h"

#include "shading/lattice_hash.h"
#include "shading/voronoi_cells.h"

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

// What belongs to a cell besides its point. The rules are Blender's.
Color color_of(const LatticePoint<1>& c) {
    return {unit_hash(c[0]), unit_hash(c[0], 1.0f), unit_hash(c[0], 2.0f)};
}
Color color_of(const LatticePoint<2>& c) {
    return {unit_hash(c[0], c[1]), unit_hash(c[0], c[1], 1.0f), unit_hash(c[0], c[1], 2.0f)};
}
Color color_of(const LatticePoint<4>& c) {
    return {unit_hash(c[0], c[1], c[2], c[3]), unit_hash(c[2], c[0], c[3], c[1]), unit_hash(c[3], c[2], c[1], c[0])};
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
    /// The cells at most `reach` away, and how far their points are from a place.
    void find(int reach, const LatticePoint<N>& from, CellDistance distances, VoronoiCells& cells,
              const LatticePoint<N>& middle = {}) const;
    static LatticePoint<N> offset_of(const VoronoiCells& cells, size_t i) {
        LatticePoint<N> offset;
        for (int axis = 0; axis < N; ++axis) offset[axis] = cells.offset(axis, i);
        return offset;
    }
    static LatticePoint<N> point_of(const VoronoiCells& cells, size_t i) {
        LatticePoint<N> point;
        for (int axis = 0; axis < N; ++axis) point[axis] = cells.point[axis][i];
        return point;
    }
    /// The cell, among those, whose point is nearest to the place that they were found from; the middle one counts if
    /// that is asked.
    static size_t nearest_of(const VoronoiCells& cells, bool middle_counts = true);
    Color color(const VoronoiCells& cells, size_t i) const {
        if constexpr (N == 3)
            return {cells.chance[0][i], cells.chance[1][i], cells.chance[2][i]};
        else
            return color_of<N>(plus<N>(cell_, offset_of(cells, i)), parameters_.hash);
    }
    VoronoiResult result(float distance, const VoronoiCells& cells, size_t i) const {
        return {distance, color(cells, i), place(point_of(cells, i))};
    }
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
void Cells<N>::find(int reach, const LatticePoint<N>& from, CellDistance distances, VoronoiCells& cells,
                    const LatticePoint<N>& middle) const {
    cells.dimensions = N;
    cells.reach = reach;
    std::copy(cell_.begin(), cell_.end(), cells.cell);
    std::copy(middle.begin(), middle.end(), cells.middle);
    std::copy(from.begin(), from.end(), cells.from);
    cells.randomness = randomness_;
    cells.hash = parameters_.hash;
    cells.metric = parameters_.metric;
    const bool one_by_one = distances == CellDistance::Metric && parameters_.metric == VoronoiMetric::Minkowski;
    cells.distances = one_by_one ? CellDistance::None : distances;
    cells.chances = distances == CellDistance::Metric;
    cells.find();
    for (size_t i = 0; one_by_one && i < cells.count; ++i) cells.distance[i] = distance(point_of(cells, i), from);
}

template <int N>
VoronoiResult Cells<N>::nearest() const {
    VoronoiCells cells;
    find(1, local_, CellDistance::Metric, cells);
    float least = kFarthestPoint;
    size_t found = cells.count / 2;
    for (size_t i = 0; i < cells.count; ++i)
        if (cells.distance[i] < least) least = cells.distance[found = i];
    return result(least, cells, found);
}

template <int N>
VoronoiResult Cells<N>::second_nearest() const {
    VoronoiCells cells;
    find(1, local_, CellDistance::Metric, cells);
    float first = kFarthestPoint, second = kFarthestPoint;
    size_t first_cell = cells.count / 2, second_cell = first_cell;
    for (size_t i = 0; i < cells.count; ++i) {
        const float d = cells.distance[i];
        if (d < first) {
            second = first;
            second_cell = first_cell;
            first = d;
            first_cell = i;
        } else if (d < second) {
            second = d;
            second_cell = i;
        }
    }
    return result(second, cells, second_cell);
}

/// The nearest by a minimum that blends: where two distances differ by less than the smoothness, so do their cells. The
/// order in which cells are blended counts a little.
template <int N>
VoronoiResult Cells<N>::smooth() const {
    const float smoothness = std::clamp(0.5f * parameters_.smoothness, 0.0f, 0.5f);
    if (!(smoothness > 0.0f)) return nearest();
    VoronoiCells cells;
    find(2, local_, CellDistance::Metric, cells);
    float least = kFarthestPoint;
    Color color_sum(0.0f);
    LatticePoint<N> point{};
    for (size_t i = 0; i < cells.count; ++i) {
        const float d = cells.distance[i];
        const float x = std::clamp(0.5f + 0.5f * (least - d) / smoothness, 0.0f, 1.0f);
        if (x == 0.0f) continue;
        const float share = x * x * (3.0f - 2.0f * x);
        float sunk = smoothness * share * (1.0f - share);
        const auto mixed = [&](float a, float b) { return a + (b - a) * share - sunk; };
        least = mixed(least, d);
        sunk /= 1.0f + 3.0f * smoothness;
        const Color other = color(cells, i);
        color_sum = {mixed(color_sum.x, other.x), mixed(color_sum.y, other.y), mixed(color_sum.z, other.z)};
        point = each<N>(point, point_of(cells, i), mixed);
    }
    return {least, color_sum, place(point)};
}

template <int N>
size_t Cells<N>::nearest_of(const VoronoiCells& cells, bool middle_counts) {
    float least = std::numeric_limits<float>::max();
    size_t found = cells.count / 2;
    for (size_t i = 0; i < cells.count; ++i) {
        if (!middle_counts && i == cells.count / 2) continue;
        if (cells.distance[i] < least) least = cells.distance[found = i];
    }
    return found;
}

/// To the nearest plane halfway between the nearest point and another.
template <int N>
float Cells<N>::distance_to_edge() const {
    constexpr float kSamePoint = 1e-4f;  // squared: the point itself
    VoronoiCells cells;
    find(1, local_, CellDistance::Squared, cells);
    if constexpr (N == 1) {
        const auto& x = cells.point[0];
        return std::min(std::abs(0.5f * (x[1] + x[0]) - local_[0]), std::abs(0.5f * (x[1] + x[2]) - local_[0]));
    }
    const LatticePoint<N> to_nearest = minus<N>(point_of(cells, nearest_of(cells)), local_);
    float least = kFarthestPoint;
    for (size_t i = 0; i < cells.count; ++i) {
        const LatticePoint<N> to_other = minus<N>(point_of(cells, i), local_), between = minus<N>(to_other, to_nearest);
        if (dot<N>(between, between) <= kSamePoint) continue;
        least = std::min(least, 0.5f * dot<N>(plus<N>(to_nearest, to_other), between) / length<N>(between));
    }
    return least;
}

/// Half the way from the nearest point to the point nearest to that.
template <int N>
float Cells<N>::sphere_radius() const {
    VoronoiCells cells;
    find(1, local_, CellDistance::Squared, cells);
    const size_t nearest = nearest_of(cells);
    const LatticePoint<N> middle = offset_of(cells, nearest), center = point_of(cells, nearest);
    find(1, center, CellDistance::Squared, cells, middle);
    return 0.5f * length<N>(minus<N>(point_of(cells, nearest_of(cells, false)), center));
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
    float scale = 1.0f, amplitude = 1.0f, rest = single ? 1.0f : 1.0f + detail;
    while (rest > 0.0f) {
        LatticePoint<N> scaled = p;
        for (float& x : scaled) x *= scale;
        octaves.add(octave<N>(scaled, parameters), scale, amplitude, std::min(rest, 1.0f));
        scale *= parameters.lacunarity;
        amplitude *= roughness;
        rest -= 1.0f;
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
