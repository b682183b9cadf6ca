#include "rivals/counting_scene.h"

#include "tessellation/grid.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace rayleaf {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr uint32_t kMostInLeaf = 2;
constexpr int kBins = 16;

float half_area(const Box3f& box) {
    if (box.isEmpty()) return 0.0f;
    const Vec3f size = box.size();
    return size.x * size.y + size.y * size.z + size.z * size.x;
}

/// The distance at which a ray enters a box; infinity if it misses.
float entry(const Box3f& box, const RivalRay& ray, const Vec3f& inverse, float t_max) {
    float begin = ray.t_min, end = t_max;
    for (int axis = 0; axis < 3; ++axis) {
        const float a = (box.min[axis] - ray.origin[axis]) * inverse[axis];
        const float b = (box.max[axis] - ray.origin[axis]) * inverse[axis];
        begin = std::max(begin, std::min(a, b));
        end = std::min(end, std::max(a, b));
    }
    return begin <= end ? begin : kInfinity;
}

}  // namespace

struct CountingScene::Build {
    CountingScene& scene;
    std::vector<Box3f> boxes;
    std::vector<Vec3f> middles;

    Box3f box_of(uint32_t first, uint32_t count) const {
        Box3f box;
        for (uint32_t i = first; i < first + count; ++i) box.extendBy(boxes[scene.order_[i]]);
        return box;
    }

    /// Splits a node by the surface area heuristic, in bins along the longest side of its middles.
    void split(uint32_t node, uint32_t first, uint32_t count) {
        scene.nodes_[node].box = box_of(first, count);
        Box3f range;
        for (uint32_t i = first; i < first + count; ++i) range.extendBy(middles[scene.order_[i]]);
        const auto axis = static_cast<int>(range.majorAxis());
        const float low = range.min[axis], size = range.max[axis] - low;
        if (count <= kMostInLeaf || !(size > 0.0f)) {
            scene.nodes_[node].first = first;
            scene.nodes_[node].count = count;
            return;
        }
        const auto bin_of = [&](uint32_t primitive) {
            return std::min(kBins - 1, static_cast<int>((middles[primitive][axis] - low) / size * kBins));
        };
        const int cut = best_cut(first, count, bin_of);
        const auto begin = scene.order_.begin() + first;
        const auto middle = std::partition(begin, begin + count, [&](uint32_t p) { return bin_of(p) < cut; });
        const auto left = static_cast<uint32_t>(middle - begin);
        const auto children = static_cast<uint32_t>(scene.nodes_.size());
        scene.nodes_[node].first = children;
        scene.nodes_.resize(children + 2);
        split(children, first, left);
        split(children + 1, first + left, count - left);
    }

    /// The first and the last bin are never empty, so every cut separates primitives.
    template <typename BinOf>
    int best_cut(uint32_t first, uint32_t count, const BinOf& bin_of) const {
        std::array<Box3f, kBins> bins;
        std::array<uint32_t, kBins> counts{};
        for (uint32_t i = first; i < first + count; ++i) {
            const int bin = bin_of(scene.order_[i]);
            bins[bin].extendBy(boxes[scene.order_[i]]);
            ++counts[bin];
        }
        int best = 1;
        float least = kInfinity;
        for (int cut = 1; cut < kBins; ++cut) {
            Box3f left, right;
            uint32_t left_count = 0, right_count = 0;
            for (int i = 0; i < kBins; ++i) {
                (i < cut ? left : right).extendBy(bins[i]);
                (i < cut ? left_count : right_count) += counts[i];
            }
            const float cost =
                half_area(left) * static_cast<float>(left_count) + half_area(right) * static_cast<float>(right_count);
            if (cost < least) {
                least = cost;
                best = cut;
            }
        }
        return best;
    }
};

CountingScene::CountingScene(const RivalScene& scene) : scene_(&scene) {
    Build build{*this, {}, {}};
    if (scene.method() == RivalMethod::Triangles) {
        add_triangles();
        for (const auto& triangle : triangles_) {
            Box3f& box = build.boxes.emplace_back();
            for (const Vec3f& corner : triangle) box.extendBy(corner);
        }
    } else {
        build.boxes = scene.part_boxes();
    }
    for (const Box3f& box : build.boxes) build.middles.push_back(box.center());
    order_.resize(build.boxes.size());
    std::iota(order_.begin(), order_.end(), 0u);
    if (order_.empty()) return;
    nodes_.resize(1);
    build.split(0, 0, static_cast<uint32_t>(order_.size()));
}

void CountingScene::add_triangles() {
    for (const BicubicPatch& patch : scene_->patches()) {
        for (uint32_t k = 0; k < kGridTriangles; ++k) {
            const int i = static_cast<int>(k / 2) % kGridCells, j = static_cast<int>(k / 2) / kGridCells;
            const Vec3f a = grid_vertex(patch, i, j), c = grid_vertex(patch, i + 1, j + 1);
            if (k % 2 == 0)
                triangles_.push_back({a, c, grid_vertex(patch, i + 1, j)});
            else
                triangles_.push_back({a, grid_vertex(patch, i, j + 1), c});
        }
    }
}

bool CountingScene::test(uint32_t primitive, const RivalRay& ray, const RayPlanes& planes, float& t_max, RivalHit& hit,
                         uint64_t& flops) const {
    if (triangles_.empty()) {
        constexpr uint32_t parts = kNewtonBoxes * kNewtonBoxes;
        const uint32_t patch = primitive / parts;
        const NewtonHit found = newton_hit(scene_->patches()[patch], static_cast<int>(primitive % parts), ray, planes);
        flops += static_cast<uint64_t>(std::min(found.steps, kMostNewtonSteps)) * kNewtonFlops;
        if (!found.found || found.t >= t_max) return false;
        t_max = found.t;
        hit = scene_->on_patch(patch, found.point, found.t);
        return true;
    }
    flops += kTriangleFlops;
    const auto& [a, b, c] = triangles_[primitive];
    const Vec3f ab = b - a, ac = c - a, across = ray.direction.cross(ac), from = ray.origin - a;
    const float determinant = ab.dot(across);
    if (determinant == 0.0f) return false;
    const float inverse = 1.0f / determinant, u = from.dot(across) * inverse;
    const Vec3f other = from.cross(ab);
    const float v = ray.direction.dot(other) * inverse, t = ac.dot(other) * inverse;
    if (!(u >= 0.0f && v >= 0.0f && u + v <= 1.0f && t > ray.t_min && t < t_max)) return false;
    t_max = t;
    hit = scene_->on_triangle(ray, {t, u, v, primitive, ab.cross(ac)});
    return true;
}

bool CountingScene::closest(const RivalRay& ray, RivalHit& hit, uint64_t& flops) const {
    if (nodes_.empty()) return false;
    const bool newton = triangles_.empty();
    const Vec3f inverse(1.0f / ray.direction.x, 1.0f / ray.direction.y, 1.0f / ray.direction.z);
    const RayPlanes planes(ray);
    flops += kRaySetupFlops + kBoxFlops + (newton ? kPlanesFlops : 0);
    struct Open {
        uint32_t node;
        float begin;
    };
    std::vector<Open> open;
    float t_max = kInfinity;
    bool found = false;
    const float begin = entry(nodes_[0].box, ray, inverse, t_max);
    if (begin < kInfinity) open.push_back({0, begin});
    while (!open.empty()) {
        const Open current = open.back();
        open.pop_back();
        if (current.begin >= t_max) continue;
        const Node& node = nodes_[current.node];
        for (uint32_t i = node.first; i < node.first + node.count; ++i)
            found = test(order_[i], ray, planes, t_max, hit, flops) || found;
        if (node.count > 0) continue;
        flops += 2 * kBoxFlops;
        const Open left{node.first, entry(nodes_[node.first].box, ray, inverse, t_max)};
        const Open right{node.first + 1, entry(nodes_[node.first + 1].box, ray, inverse, t_max)};
        const bool left_is_nearer = left.begin <= right.begin;
        for (const Open& each : {left_is_nearer ? right : left, left_is_nearer ? left : right}) {
            if (each.begin < kInfinity) open.push_back(each);
        }
    }
    if (found) flops += newton ? kNewtonNormalFlops : kNormalFlops;
    return found;
}

}  // namespace rayleaf
