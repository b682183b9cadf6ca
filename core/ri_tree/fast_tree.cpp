#include "ri_tree/fast_tree.h"

#include "trace/float_environment.h"
#include "trace/local_ray.h"

#include <algorithm>
#include <bit>

namespace rayleaf {
namespace {

/// Halvings between two tests.
constexpr int kStepDepths = 4;
static_assert(1 << kStepDepths == kNodeChildren);
/// The share of the cache's bytes that samples may take.
constexpr uint64_t kSampleShare = 4;
/// So many of a frame's rays must cross a cell for its samples to pay.
constexpr float kWorthRays = 4.0f;
/// An interpolated hit counts as beyond an origin inside the box if it is so by this many times its error at the cell's
/// centre, and by this share of the half extent at least.
constexpr double kBeyondErrors = 2.0;
constexpr double kLeastBeyond = 0x1p-10;
/// Up to so many rays of a cell are evaluated one by one; more, all sixteen lanes at once.
constexpr int kOneByOne = 2;
/// After so many rays a reader lets go of the store, so that blocks can be exchanged.
constexpr size_t kRaysPerReader = 256;

AnsweredBy answered_by(CellVerdict verdict) {
    switch (verdict) {
        case CellVerdict::Interpolated:
            return AnsweredBy::Interpolated;
        case CellVerdict::Missed:
            return AnsweredBy::CellMissed;
        case CellVerdict::ManyClasses:
            return AnsweredBy::TracedManyClasses;
        case CellVerdict::Angle:
            return AnsweredBy::TracedAngle;
        case CellVerdict::LargeCell:
            return AnsweredBy::TracedLargeCell;
        case CellVerdict::Error:
            return AnsweredBy::TracedError;
        case CellVerdict::Unknown:
        case CellVerdict::Halved:
            break;
    }
    return AnsweredBy::TracedNotWorthIt;
}

}  // namespace

/// What a thread needs while it answers.
struct FastTree::Search {
    CellStore::Reader reader;
    LineBatch batch;
    std::array<uint64_t, kAnswerKinds> answers{};
    uint64_t samples_taken = 0;
    CellLeaf own_leaf;  ///< of a cell that there was no room for

    Uninterpolated others;

    Search(CellStore& store, Uninterpolated uninterpolated) : reader(store), others(uninterpolated) {}
    ~Search() {
        CellCounts& counts = reader.counts();
        for (size_t i = 0; i < answers.size(); ++i)
            if (answers[i] > 0) counts.answers[i].fetch_add(answers[i], std::memory_order_relaxed);
        if (samples_taken > 0) counts.samples_taken.fetch_add(samples_taken, std::memory_order_relaxed);
    }
};

/// A final cell, or one that a ray does not pay for.
struct FastTree::Found {
    CellKey key;
    int step = 0;
    CellVerdict verdict = CellVerdict::Unknown;
    const CellLeaf* leaf = nullptr;
};

FastTree::FastTree(std::shared_ptr<const Shape> shape, const SampleSettings& samples, const RayCacheSettings& settings)
    : tracer_(std::move(shape), samples),
      settings_(checked(tracer_.shape().name(), settings)),
      space_(tracer_.shape().bounds()),
      judge_(tracer_, space_, settings_),
      functions_(batch_functions()),
      samples_(samples.kind, judge_.contents(), settings.cache_bytes / kSampleShare),
      store_(settings.cache_bytes - settings.cache_bytes / kSampleShare) {
    prepare_steps();
}

FastTree::~FastTree() = default;

void FastTree::prepare_steps() {
    const LocalFrame& local = tracer_.shape().frame();
    frame_.center = local.center;
    frame_.shrink = 1.0 / local.scale;
    if (space_.box().isEmpty()) return;
    frame_.box_min = space_.box().min;
    frame_.box_max = space_.box().max;
    frame_.box_center = space_.center();
    deepest_ = settings_.depth_limit / kStepDepths;
    for (int axis = 0; axis < 3; ++axis) {
        const auto direction = static_cast<uint8_t>(2 * axis);
        const std::array<double, kLineAxes> half_sides = space_.root_half_sides(axis);
        for (int k = 0; k < kLineAxes; ++k) frame_.inverse_half_sides[axis][k] = 1.0 / half_sides[k];
        for (size_t i = 0; i < steps_[axis].size(); ++i) {
            Step& step = steps_[axis][i];
            const int depth = static_cast<int>(i) * kStepDepths;
            step.levels = space_.levels(direction, depth);
            // Middles of cells are lattice points too.
            const auto finest = std::max_element(step.levels.begin(), step.levels.end());
            if (*finest >= kPlaceBits) deepest_ = std::min(deepest_, static_cast<int>(i) - 1);
            for (int k = 0; k < kLineAxes; ++k)
                step.inverse_sides[k] = static_cast<float>(std::ldexp(0.5 / half_sides[k], step.levels[k]));
            for (int j = 0; j < kStepDepths && depth + j < kGreatestCellDepth; ++j) {
                step.axis[j] = static_cast<uint8_t>(space_.split_axis(direction, depth + j));
                const int level = space_.levels(direction, depth + j)[step.axis[j]];
                step.bit[j] = static_cast<uint8_t>(std::max(kPlaceBits - 1 - level, 0));
            }
        }
    }
    deepest_mixed_ = std::min(deepest_, settings_.mixed_depth_limit / kStepDepths);
}

/// The smallest cells that enough neighbours of a ray cross, as a step; -1: none.
///
/// Along each of the two axes beside the dominant one, neighbours lie `distance` and `angle` apart, on a slanted line
/// in the plane of intercept and slope: on average it runs 1 / (distance / side + angle / other side) rays inside a
/// cell.
int FastTree::deepest_worth(int axis, const RaySpacing& spacing) const {
    const auto distance = static_cast<float>(spacing.distance * frame_.shrink);
    int step = 0;
    for (; step <= deepest_; ++step) {
        const std::array<float, kLineAxes>& inverse = steps_[axis][step].inverse_sides;
        const float b = distance * inverse[0] + spacing.angle * inverse[2];
        const float c = distance * inverse[1] + spacing.angle * inverse[3];
        if (b * c * kWorthRays > 1.0f) break;
    }
    return step - 1;
}

Ray FastTree::to_local(const Ray& object_ray) const {
    Ray local;
    local.origin = (object_ray.origin - frame_.center) * frame_.shrink;
    local.direction = normalized_or(object_ray.direction, Vec3d(0, 0, 1));
    return local;
}

OutputRay FastTree::to_object(OutputRay local) const {
    if (local.sample_class.is_miss()) return local;
    const LocalFrame& frame = tracer_.shape().frame();
    local.length *= frame.scale;
    if (tracer_.settings().kind == OutputKind::Volume) return local;
    local.position = local.position * frame.scale + frame.center;
    local.exit_position = local.exit_position * frame.scale + frame.center;
    return local;
}

OutputRay FastTree::trace(const Ray& object_ray) const {
    if (!is_ray(object_ray)) return {};
    return to_object(tracer_.trace(to_local(object_ray)));
}

CachedAnswer FastTree::traced(const Search& search, const Ray& object_ray, AnsweredBy reason) const {
    if (search.others == Uninterpolated::Leave) return {{}, reason, 0.0};
    return {to_object(tracer_.trace(to_local(object_ray))), reason, 0.0};
}

void FastTree::ask(std::span<const Ray> rays, std::span<const RaySpacing> spacings, std::span<CachedAnswer> answers,
                   Uninterpolated others) {
    const FloatEnvironment environment;
    for (size_t first = 0; first < rays.size(); first += kRaysPerReader) {
        const size_t end = std::min(first + kRaysPerReader, rays.size());
        Search search(store_, others);
        for (size_t i = first; i < end; i += kBatchRays) {
            const int count = static_cast<int>(std::min<size_t>(kBatchRays, end - i));
            const RaySpacing* batch_spacings = spacings.empty() ? nullptr : &spacings[i];
            if (count == kBatchRays) {
                ask_batch(search, &rays[i], batch_spacings, count, &answers[i]);
            } else {
                std::array<Ray, kBatchRays> padded;
                std::copy_n(&rays[i], count, padded.begin());
                ask_batch(search, padded.data(), batch_spacings, count, &answers[i]);
            }
        }
    }
}

void FastTree::ask_batch(Search& search, const Ray* rays, const RaySpacing* spacings, int count,
                         CachedAnswer* answers) {
    LineBatch& batch = search.batch;
    functions_.prepare(rays, count, frame_, batch);
    for (int i = 0; i < count; ++i) {
        const bool is_one = (batch.rays >> i & 1) != 0;
        answers[i] = CachedAnswer{{}, is_one ? AnsweredBy::BoxMissed : AnsweredBy::NotARay, 0.0};
    }
    std::array<int, kBatchRays> worth;
    worth.fill(deepest_);
    RaySet pending = space_.box().isEmpty() ? RaySet{0} : batch.in_box;
    if (spacings)
        for (uint32_t rest = pending; rest != 0; rest &= rest - 1) {
            const int ray = std::countr_zero(rest);
            worth[ray] = deepest_worth(batch.line_direction[ray] / 2, spacings[ray]);
        }
    while (pending != 0) {
        const int ray = std::countr_zero(pending);
        const Found found = find(search, ray, worth[ray]);
        RaySet set = static_cast<RaySet>(1 << ray);
        if (found.verdict != CellVerdict::Unknown) {
            const RaySet in_cell = functions_.rays_in(batch, found.key.direction, place_of(found.key)) & pending;
            for (uint32_t rest = in_cell; rest != 0; rest &= rest - 1) {
                const int other = std::countr_zero(rest);
                if (worth[other] >= found.step) set = static_cast<RaySet>(set | 1 << other);
            }
        }
        answer_cell(search, found, set, rays, answers);
        pending = static_cast<RaySet>(pending & ~set);
    }
    for (int i = 0; i < count; ++i) ++search.answers[static_cast<size_t>(answers[i].by)];
}

/// Answers the rays of a set, all in one cell.
void FastTree::answer_cell(Search& search, const Found& found, RaySet set, const Ray* rays, CachedAnswer* answers) {
    const AnsweredBy by = answered_by(found.verdict);
    if (by == AnsweredBy::Interpolated) {
        const CellPlace place = place_of(found.key);
        alignas(64) float values[kMostLeafValues][kBatchRays];
        float own_values[kLeafPadding];
        const bool one_by_one = std::popcount(set) <= kOneByOne;
        if (!one_by_one) functions_.evaluate(search.batch, place, *found.leaf, values);
        for (uint32_t rest = set; rest != 0; rest &= rest - 1) {
            const int ray = std::countr_zero(rest);
            if (one_by_one) functions_.evaluate_one(search.batch, ray, place, *found.leaf, own_values);
            answers[ray] = one_by_one ? interpolated(search, found, ray, rays[ray], own_values, 1)
                                      : interpolated(search, found, ray, rays[ray], &values[0][ray], kBatchRays);
        }
        return;
    }
    for (uint32_t rest = set; rest != 0; rest &= rest - 1) {
        const int ray = std::countr_zero(rest);
        answers[ray] = is_traced(by) ? traced(search, rays[ray], by) : CachedAnswer{{}, by, 0.0};
    }
}

CachedAnswer FastTree::interpolated(const Search& search, const Found& found, int ray, const Ray& given,
                                    const float* values, size_t stride) const {
    const LineBatch& batch = search.batch;
    const bool starts_inside = (batch.inside >> ray & 1) != 0;
    const OutputKind kind = tracer_.settings().kind;
    // The length of a line says nothing about where on it the object lies.
    if (starts_inside && kind == OutputKind::Volume) return traced(search, given, AnsweredBy::TracedOrigin);
    LineGeometry line;
    line.axis = found.key.direction / 2;
    line.intercept = {batch.intercept[0][ray], batch.intercept[1][ray]};
    line.slope = {batch.slope[0][ray], batch.slope[1][ray]};
    line.direction = {batch.direction[0][ray], batch.direction[1][ray], batch.direction[2][ray]};
    OutputRay output = output_of(kind, *found.leaf, values, stride, line, frame_.box_center);
    if (starts_inside) {
        const Vec3d origin = (given.origin - frame_.center) * frame_.shrink;
        const double margin = kBeyondErrors * double{found.leaf->position_error} + kLeastBeyond * space_.half_extent();
        if (!((output.position - origin).dot(line.direction) > margin))
            return traced(search, given, AnsweredBy::TracedOrigin);
    }
    return {to_object(output), AnsweredBy::Interpolated, double{found.leaf->error}};
}

CellKey FastTree::key_at(const LineBatch& batch, int ray, int step) const {
    CellKey key;
    key.direction = static_cast<uint8_t>(batch.line_direction[ray]);
    key.depth = static_cast<uint8_t>(step * kStepDepths);
    const std::array<uint8_t, kLineAxes>& levels = steps_[key.direction / 2][step].levels;
    for (int k = 0; k < kLineAxes; ++k)
        key.index[k] = static_cast<uint32_t>(batch.place[k][ray]) >> (kPlaceBits - levels[k]);
    return key;
}

CellPlace FastTree::place_of(const CellKey& key) const {
    const std::array<uint8_t, kLineAxes>& levels = steps_[key.direction / 2][key.depth / kStepDepths].levels;
    CellPlace place;
    for (int k = 0; k < kLineAxes; ++k) {
        place.bits[k] = kPlaceBits - levels[k];
        place.first[k] = static_cast<int32_t>(key.index[k] << place.bits[k]);
    }
    return place;
}

/// Goes down to the final cell that holds a ray, and makes what is missing on the way; or to where it is not worth it.
FastTree::Found FastTree::find(Search& search, int ray, int deepest_worth) {
    const LineBatch& batch = search.batch;
    Found found;
    found.key.direction = static_cast<uint8_t>(batch.line_direction[ray]);
    const auto& steps = steps_[found.key.direction / 2];
    CellBlock* block = search.reader.current();
    std::atomic<CellRef>* place = block ? &block->root(found.key.direction) : nullptr;
    for (; found.step <= deepest_worth; ++found.step) {
        CellRef ref = place ? place->load(std::memory_order_acquire) : 0;
        if (place && verdict_of(ref) == CellVerdict::Unknown) {
            ref = add_cell(search, key_at(batch, ray, found.step), found.step, *place);
            if (ref == 0) place = nullptr;  // no room: from here on by itself
        }
        found.verdict = place ? verdict_of(ref) : make_cell(search, key_at(batch, ray, found.step), found.step);
        if (found.verdict != CellVerdict::Halved) {
            found.key = key_at(batch, ray, found.step);
            if (found.verdict == CellVerdict::Interpolated) found.leaf = place ? &block->leaf(ref) : &search.own_leaf;
            return found;
        }
        if (!place) continue;
        const Step& step = steps[found.step];
        uint32_t child = 0;
        for (int j = 0; j < kStepDepths; ++j)
            child |= (static_cast<uint32_t>(batch.place[step.axis[j]][ray]) >> step.bit[j] & 1u) << j;
        place = &block->node(ref).children[child];
    }
    found.verdict = CellVerdict::Unknown;
    return found;
}

/// Samples a cell and judges it. Its leaf, if it has one, is the search's own.
CellVerdict FastTree::make_cell(Search& search, const CellKey& key, int step) {
    const std::array<uint8_t, kLineAxes>& levels = steps_[key.direction / 2][step].levels;
    CellSamples samples;
    LatticePoint point;
    point.direction = key.direction;
    for (int i = 0; i <= kCellCorners; ++i) {
        for (int k = 0; k < kLineAxes; ++k) {
            const uint32_t half_steps = i == kCenterSample ? 1 : 2 * (static_cast<uint32_t>(i) >> k & 1);
            point.place[k] = (2 * key.index[k] + half_steps) << (kPlaceBits - 1 - levels[k]);
        }
        if (samples_.find(point, samples[i])) continue;
        samples[i] = take_sample(tracer_, space_, point, judge_.contents());
        ++search.samples_taken;
        samples_.put(point, samples[i]);
    }
    return judge_.judge(key, {step >= deepest_, step >= deepest_mixed_}, samples, search.own_leaf);
}

/// Makes a cell and publishes it at its place; 0 if there is no room.
CellRef FastTree::add_cell(Search& search, const CellKey& key, int step, std::atomic<CellRef>& place) {
    CellBlock& block = *search.reader.current();
    const CellVerdict verdict = make_cell(search, key, step);
    std::optional<CellRef> made = static_cast<CellRef>(verdict);
    if (verdict == CellVerdict::Halved) made = block.add_node();
    if (verdict == CellVerdict::Interpolated) made = block.add_leaf(search.own_leaf);
    if (!made) {
        search.reader.found_no_room();
        return 0;
    }
    CellRef before = 0;
    // Another thread may have made the same meanwhile; then its cell counts, and the space is lost until the exchange.
    if (place.compare_exchange_strong(before, *made, std::memory_order_acq_rel)) return *made;
    return before;
}

std::optional<CellKey> FastTree::final_cell(const Ray& object_ray) {
    Search search(store_, Uninterpolated::Leave);
    std::array<Ray, kBatchRays> rays;
    rays[0] = object_ray;
    functions_.prepare(rays.data(), 1, frame_, search.batch);
    if (space_.box().isEmpty() || search.batch.in_box == 0) return std::nullopt;
    return find(search, 0, deepest_).key;
}

RayCacheStatistics FastTree::statistics() const {
    RayCacheStatistics result;
    for (size_t i = 0; i < kAnswerKinds; ++i) result.answers[i] = store_.answers(i);
    result.samples_taken = store_.samples_taken();
    result.samples = samples_.count();
    result.nodes = store_.nodes() + store_.leaves();
    result.leaves = store_.leaves();
    result.bytes = store_.bytes() + samples_.bytes();
    result.most_bytes = std::max(store_.most_bytes() + samples_.bytes(), result.bytes);
    result.prunes = store_.exchanges();
    return result;
}

}  // namespace rayleaf
