#include "rivals/reference_tree.h"

#include "trace/float_environment.h"
#include "trace/local_ray.h"

#include <algorithm>
#include <limits>

namespace rayleaf {
namespace {

/// An interpolated hit is taken to lie beyond an origin inside the box if it does so by this many times the error at
/// the cell's centre, and by at least this share of the half extent.
constexpr double kBeyondErrors = 2.0;
constexpr double kLeastBeyond = 0x1p-10;

CachedAnswer to_trace(AnsweredBy reason) {
    return {{}, reason, 0.0};
}

}  // namespace

/// What the corners of a final cell have in common.
struct ReferenceTree::Leaf {
    /// Corners of one class.
    struct Side {
        SampleClass sample_class;
        CornerSet corners = 0;
        double least_cosine = 1.0;  ///< between the output directions of any two
    };
    std::array<Side, 2> sides;
    int classes = 0;            ///< 1, 2, or 3 for more
    double error = 0;           ///< one class: distance at the centre, local units
    double position_error = 0;  ///< one class: of the first hit there, local units
};

struct ReferenceTree::Node {
    std::array<SampleId, kCellCorners> corners{};
    std::array<std::unique_ptr<Node>, 2> children;
    std::unique_ptr<const Leaf> leaf;  ///< of a final cell
    bool halved = false;               ///< known to be not final; its children may have been pruned
    uint64_t stamp = 0;                ///< when it was last used; never older than its children
};

ReferenceTree::ReferenceTree(std::shared_ptr<const Shape> shape, const SampleSettings& samples,
                             const RayCacheSettings& settings)
    : tracer_(std::move(shape), samples),
      settings_(checked(tracer_.shape().name(), settings)),
      space_(tracer_.shape().bounds()),
      samples_(samples.kind) {}

ReferenceTree::~ReferenceTree() = default;

void ReferenceTree::ask(const RayQuestions& questions, std::span<CachedAnswer> answers, std::span<HitChanges> changes) {
    const FloatEnvironment environment;
    std::fill(changes.begin(), changes.end(), HitChanges{});
    for (size_t i = 0; i < questions.rays.size(); ++i) {
        const Ray& ray = questions.rays[i];
        answers[i] = is_ray(ray) ? answer(to_local(ray), questions.others) : CachedAnswer{};
        ++statistics_.answers[static_cast<size_t>(answers[i].by)];
        answers[i].output = to_object(answers[i].output);
        prune();
    }
}

OutputRay ReferenceTree::trace(const Ray& object_ray) const {
    return is_ray(object_ray) ? to_object(tracer_.trace(to_local(object_ray))) : OutputRay{};
}

std::optional<CellKey> ReferenceTree::final_cell(const Ray& object_ray) {
    if (!is_ray(object_ray)) return std::nullopt;
    const Ray local = to_local(object_ray);
    if (space_.box().isEmpty() || !inside_box(space_.box(), local.origin, local.direction)) return std::nullopt;
    const CellKey key = descend(space_.line(local.origin, local.direction)).key;
    prune();
    return key;
}

RayCacheStatistics ReferenceTree::statistics() const {
    RayCacheStatistics result = statistics_;
    result.samples = samples_.count();
    result.bytes = held_bytes();
    result.tracer_bytes = tracer_.bytes();
    return result;
}

Ray ReferenceTree::to_local(const Ray& object_ray) const {
    const LocalFrame& frame = tracer_.shape().frame();
    Ray local;
    local.origin = (object_ray.origin - frame.center) / frame.scale;
    local.direction = normalized_or(object_ray.direction, Vec3d(0, 0, 1));
    return local;
}

OutputRay ReferenceTree::to_object(OutputRay local) const {
    if (local.sample_class.is_miss()) return local;
    const LocalFrame& frame = tracer_.shape().frame();
    local.length *= frame.scale;
    if (tracer_.settings().kind == OutputKind::Volume) return local;
    local.position = local.position * frame.scale + frame.center;
    local.exit_position = local.exit_position * frame.scale + frame.center;
    return local;
}

CachedAnswer ReferenceTree::answer(const Ray& local, Uninterpolated others) {
    CachedAnswer result = interpolated(local);
    if (is_traced(result.by) && others == Uninterpolated::Trace) result.output = tracer_.trace(local);
    return result;
}

/// The output is not set if the ray is to be traced.
CachedAnswer ReferenceTree::interpolated(const Ray& local) {
    if (space_.box().isEmpty()) return {{}, AnsweredBy::BoxMissed, 0.0};
    const std::optional<RayInterval> interval = inside_box(space_.box(), local.origin, local.direction);
    if (!interval || interval->end < 0.0) return {{}, AnsweredBy::BoxMissed, 0.0};
    const Line line = space_.line(local.origin, local.direction);
    const Found found = descend(line);
    const bool starts_inside = interval->begin < 0.0;
    switch (found.node->leaf->classes) {
        case 1:
            return answer_in(found, line, local, starts_inside);
        case 2:
            return starts_inside ? to_trace(AnsweredBy::TracedOrigin) : answer_on_side(found, line, local);
        default:
            return to_trace(AnsweredBy::TracedManyClasses);
    }
}

/// A cell of one class.
CachedAnswer ReferenceTree::answer_in(const Found& found, const Line& line, const Ray& local,
                                      bool starts_inside) const {
    const Leaf& leaf = *found.node->leaf;
    const Leaf::Side& side = leaf.sides[0];
    if (side.sample_class.is_miss()) {
        if (!space_.is_narrow(found.key)) return to_trace(AnsweredBy::TracedLargeCell);
        return {{}, AnsweredBy::CellMissed, 0.0};
    }
    if (side.least_cosine < std::cos(std::min<double>(settings_.angle_threshold, kPi)))
        return to_trace(AnsweredBy::TracedAngle);
    // The length of a line says nothing about where the object lies on it.
    if (starts_inside && tracer_.settings().kind == OutputKind::Volume) return to_trace(AnsweredBy::TracedOrigin);
    const CornerWeights weights = quadrilinear_weights(space_.position_in(found.key, line));
    CachedAnswer result{interpolate(*found.node, side.sample_class, weights, local.direction), AnsweredBy::Interpolated,
                        leaf.error / space_.half_extent(), leaf.position_error / space_.half_extent()};
    if (starts_inside) {
        const double beyond = (result.output.position - local.origin).dot(local.direction);
        const double margin = kBeyondErrors * leaf.position_error + kLeastBeyond * space_.half_extent();
        if (!(beyond > margin)) return to_trace(AnsweredBy::TracedOrigin);
    }
    return result;
}

/// A cell of two classes, asked by a ray from outside the box.
CachedAnswer ReferenceTree::answer_on_side(const Found& found, const Line& line, const Ray& local) const {
    const Leaf& leaf = *found.node->leaf;
    if (leaf.sides[0].sample_class.first_hit == leaf.sides[1].sample_class.first_hit)
        return to_trace(AnsweredBy::TracedManyClasses);
    const uint32_t first_hit = tracer_.first_hit_class(local);
    if (first_hit == kMissedClass) return {{}, AnsweredBy::TwoClassMissed, 0.0};
    const auto is_hit = [&](const Leaf::Side& side) { return side.sample_class.first_hit == first_hit; };
    const auto side = std::find_if(leaf.sides.begin(), leaf.sides.end(), is_hit);
    if (side == leaf.sides.end()) return to_trace(AnsweredBy::TracedManyClasses);
    const auto weights = affine_weights(side->corners, space_.position_in(found.key, line));
    if (!weights) return to_trace(AnsweredBy::TracedFewCorners);
    if (side->least_cosine < std::cos(std::min<double>(settings_.angle_threshold, kPi)))
        return to_trace(AnsweredBy::TracedAngle);
    return {interpolate(*found.node, side->sample_class, *weights, local.direction), AnsweredBy::TwoClassInterpolated,
            0.0};
}

ReferenceTree::Found ReferenceTree::descend(const Line& line) {
    ++clock_;
    CellKey key;
    key.direction = line.direction;
    std::unique_ptr<Node>* place = &roots_[line.direction];
    if (!*place) *place = make_root(line.direction);
    for (;;) {
        Node& node = **place;
        node.stamp = clock_;
        if (!node.halved && !node.leaf) {
            node.leaf = judge(node, key);
            node.halved = !node.leaf;
            if (node.leaf) ++statistics_.leaves;
        }
        if (node.leaf) return {&node, key};
        const bool upper = space_.in_upper_half(key, line);
        place = &node.children[upper ? 1 : 0];
        if (!*place) *place = make_child(node, key, upper);
        key = space_.child(key, upper);
    }
}

SampleId ReferenceTree::take_sample(const Ray& ray) {
    ++statistics_.samples_taken;
    return samples_.add(tracer_.trace(ray));
}

std::unique_ptr<ReferenceTree::Node> ReferenceTree::make_root(uint8_t direction) {
    auto node = std::make_unique<Node>();
    ++statistics_.nodes;
    CellKey key;
    key.direction = direction;
    for (int corner = 0; corner < kCellCorners; ++corner)
        node->corners[corner] = take_sample(space_.corner_ray(key, corner));
    return node;
}

/// Eight corners are the parent's, eight lie on the cut and are the other half's too.
std::unique_ptr<ReferenceTree::Node> ReferenceTree::make_child(const Node& parent, const CellKey& parent_key,
                                                               bool upper) {
    auto node = std::make_unique<Node>();
    ++statistics_.nodes;
    const int axis = space_.split_axis(parent_key.direction, parent_key.depth);
    const CellKey key = space_.child(parent_key, upper);
    const Node* other_half = parent.children[upper ? 0 : 1].get();
    for (int corner = 0; corner < kCellCorners; ++corner) {
        const bool on_cut = (((corner >> axis) & 1) != 0) != upper;
        if (!on_cut || other_half) {
            const SampleId id = on_cut ? other_half->corners[corner ^ (1 << axis)] : parent.corners[corner];
            samples_.hold(id);
            node->corners[corner] = id;
        } else {
            node->corners[corner] = take_sample(space_.corner_ray(key, corner));
        }
    }
    return node;
}

std::unique_ptr<ReferenceTree::Leaf> ReferenceTree::sort_corners(const Node& node) const {
    auto leaf = std::make_unique<Leaf>();
    for (int corner = 0; corner < kCellCorners; ++corner) {
        const SampleClass& sample_class = samples_.sample_class(node.corners[corner]);
        int side = 0;
        while (side < leaf->classes && !(leaf->sides[side].sample_class == sample_class)) ++side;
        if (sample_class.is_faceted() || side == 2) {
            leaf->classes = 3;
            return leaf;
        }
        leaf->sides[side].sample_class = sample_class;
        leaf->sides[side].corners |= static_cast<CornerSet>(1 << corner);
        leaf->classes = std::max(leaf->classes, side + 1);
    }
    return leaf;
}

std::unique_ptr<const ReferenceTree::Leaf> ReferenceTree::judge(const Node& node, const CellKey& key) {
    const bool deepest = key.depth >= settings_.depth_limit;
    std::unique_ptr<Leaf> leaf = sort_corners(node);
    if (leaf->classes > 1) {
        if (!deepest) return nullptr;
        if (leaf->classes == 2) measure_angles(node, key, *leaf);
        return leaf;
    }
    const SampleClass& sample_class = leaf->sides[0].sample_class;
    if (sample_class.is_miss() && deepest) return leaf;

    const Ray ray = space_.center_ray(key);
    ++statistics_.samples_taken;
    const OutputRay truth = tracer_.trace(ray);
    bool close = truth.sample_class == sample_class;
    if (sample_class.is_miss()) {
        if (!close || !space_.is_narrow(key)) return nullptr;
        return leaf;
    }
    if (close) {
        CornerWeights weights;
        weights.fill(1.0 / kCellCorners);
        const OutputRay estimate = interpolate(node, sample_class, weights, ray.direction);
        leaf->error = distance(tracer_.settings().kind, truth, estimate, 2.0 * space_.half_extent());
        leaf->position_error = (truth.position - estimate.position).length();
        close = leaf->error <= settings_.distance_threshold * space_.half_extent();
    } else {
        // The corners agree, yet not with the centre: not even an error is known.
        leaf->classes = 3;
    }
    if (!close && !deepest) return nullptr;
    if (leaf->classes == 1) measure_angles(node, key, *leaf);
    return leaf;
}

void ReferenceTree::measure_angles(const Node& node, const CellKey& key, Leaf& leaf) const {
    if (tracer_.settings().kind == OutputKind::Volume) return;
    for (Leaf::Side& side : leaf.sides) {
        if (side.sample_class.is_miss()) continue;
        std::array<Vec3d, kCellCorners> directions;
        size_t count = 0;
        for (int corner = 0; corner < kCellCorners; ++corner) {
            if (((side.corners >> corner) & 1) == 0) continue;
            CornerWeights weights{};
            weights[corner] = 1.0;
            const Vec3d incoming = space_.corner_ray(key, corner).direction;
            directions[count++] = interpolate(node, side.sample_class, weights, incoming).exit_direction;
        }
        for (size_t i = 0; i < count; ++i)
            for (size_t j = 0; j < i; ++j)
                side.least_cosine = std::min(side.least_cosine, directions[i].dot(directions[j]));
    }
}

OutputRay ReferenceTree::interpolate(const Node& node, const SampleClass& sample_class, const CornerWeights& weights,
                                     const Vec3d& direction) const {
    const OutputKind kind = tracer_.settings().kind;
    std::array<double, kMostAttributes> sums{};
    const auto count = static_cast<size_t>(attribute_count(kind));
    for (int corner = 0; corner < kCellCorners; ++corner) {
        if (weights[corner] == 0.0) continue;
        const std::span<const float> attributes = samples_.attributes(node.corners[corner]);
        for (size_t i = 0; i < count; ++i) sums[i] += weights[corner] * attributes[i];
    }
    return from_attributes(kind, sample_class, {sums.data(), count}, direction);
}

uint64_t ReferenceTree::held_bytes() const {
    return statistics_.nodes * sizeof(Node) + statistics_.leaves * sizeof(Leaf) + samples_.bytes();
}

void ReferenceTree::prune() {
    statistics_.most_bytes = std::max(statistics_.most_bytes, held_bytes());
    if (held_bytes() <= settings_.cache_bytes) return;
    ++statistics_.prunes;
    const double kept_bytes = (1.0 - settings_.pruned_share) * static_cast<double>(settings_.cache_bytes);
    // Corners are shared, so memory does not shrink in proportion to nodes: repeat until it is small enough.
    while (statistics_.nodes > 0 && static_cast<double>(held_bytes()) > kept_bytes) {
        std::vector<uint64_t> stamps;
        stamps.reserve(statistics_.nodes);
        const auto collect = [&](const auto& self, const Node* node) -> void {
            if (!node) return;
            stamps.push_back(node->stamp);
            for (const std::unique_ptr<Node>& child : node->children) self(self, child.get());
        };
        for (const std::unique_ptr<Node>& root : roots_) collect(collect, root.get());
        const double share = kept_bytes / static_cast<double>(held_bytes());
        const auto kept = static_cast<size_t>(share * static_cast<double>(stamps.size()));
        const auto newest_removed = stamps.begin() + static_cast<std::ptrdiff_t>(kept);
        std::nth_element(stamps.begin(), newest_removed, stamps.end(), std::greater<>());
        for (std::unique_ptr<Node>& root : roots_) remove_older(root, *newest_removed);
    }
    if (statistics_.nodes == 0) samples_.clear();
}

/// Removes nodes last used at `stamp` or before. Their descendants are no newer.
void ReferenceTree::remove_older(std::unique_ptr<Node>& node, uint64_t stamp) {
    if (!node) return;
    for (std::unique_ptr<Node>& child : node->children) remove_older(child, stamp);
    if (node->stamp > stamp) return;
    for (const SampleId id : node->corners) samples_.let_go(id);
    if (node->leaf) --statistics_.leaves;
    --statistics_.nodes;
    node.reset();
}

}  // namespace rayleaf
