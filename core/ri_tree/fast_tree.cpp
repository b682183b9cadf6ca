#include "ri_tree/fast_tree.h"

#include "trace/float_environment.h"
#include "trace/local_ray.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace rayleaf {
namespace {

static_assert(1 << kStepDepths == kNodeChildren);

/// The share of the cache's bytes that samples may take.
constexpr uint64_t kSampleShare = 4;
/// An interpolated hit counts as beyond an origin inside the box if it is so by this many times its error at the cell's
/// centre, and by this share of the half extent at least.
constexpr double kBeyondErrors = 2.0;
constexpr double kLeastBeyond = 0x1p-10;
/// Up to so many rays of a cell are evaluated one by one; more, all sixteen lanes at once.
constexpr int kOneByOne = 2;
/// After so many rays a reader lets go of the store, so that blocks can be exchanged.
constexpr size_t kRaysPerReader = 256;

/// The centre, then pairs of opposite corners: what is likely to differ comes early.
constexpr std::array<int, kCellCorners + 1> kSampleOrder = {
    kCenterSample, 0, 15, 3, 12, 5, 10, 6, 9, 1, 14, 2, 13, 4, 11, 7, 8};

void prefetch(const CellLeaf& leaf) {
    constexpr size_t kCacheLine = 64;
    // What a mirror's leaf takes; of larger ones the processor fetches the rest itself.
    constexpr size_t kBytes = offsetof(CellLeaf, coefficients) + size_t{kCubicTerms} * 3 * sizeof(float);
    const auto* bytes = reinterpret_cast<const std::byte*>(&leaf);
    for (size_t at = 0; at < kBytes; at += kCacheLine) __builtin_prefetch(bytes + at);
}

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
    LineBatch batch;
    CellLeaf own_leaf;  ///< of a cell that there was no room for
    CellStore::Reader reader;
    std::array<uint64_t, kAnswerKinds> answers{};
    uint64_t samples_taken = 0;
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
      steps_(space_, settings_),
      functions_(batch_functions()),
      samples_(samples.kind, judge_.contents(), settings.cache_bytes / kSampleShare),
      store_(settings.cache_bytes - settings.cache_bytes / kSampleShare) {
    prepare_frame();
}

FastTree::~FastTree() = default;

void FastTree::prepare_frame() {
    const LocalFrame& local = tracer_.shape().frame();
    frame_.center = local.center;
    frame_.shrink = 1.0 / local.scale;
    if (space_.box().isEmpty()) return;
    frame_.box_min = space_.box().min;
    frame_.box_max = space_.box().max;
    frame_.box_center = space_.center();
    for (int axis = 0; axis < 3; ++axis) {
        const std::array<double, kLineAxes> half_sides = space_.root_half_sides(axis);
        for (int k = 0; k < kLineAxes; ++k) frame_.inverse_half_sides[axis][k] = 1.0 / half_sides[k];
    }
}

Ray FastTree::to_local(const Ray& object_ray) const {
    Ray local;
    local.origin = (object_ray.origin - frame_.center) * frame_.shrink;
    local.direction = normalized_or(object_ray.direction, Vec3d(0, 0, 1));
    return local;
}

void FastTree::move_to_object(OutputRay& ray) const {
    if (ray.sample_class.is_miss()) return;
    const LocalFrame& frame = tracer_.shape().frame();
    ray.length *= frame.scale;
    if (tracer_.settings().kind == OutputKind::Volume) return;
    ray.position = ray.position * frame.scale + frame.center;
    ray.exit_position = ray.exit_position * frame.scale + frame.center;
}

OutputRay FastTree::trace(const Ray& object_ray) const {
    if (!is_ray(object_ray)) return {};
    OutputRay result = tracer_.trace(to_local(object_ray));
    move_to_object(result);
    return result;
}

/// An answer without interpolation: missed, or traced if the caller wants that.
void FastTree::answer_plainly(const Search& search, const Ray& object_ray, AnsweredBy by, CachedAnswer& answer) const {
    const bool traces = is_traced(by) && search.others == Uninterpolated::Trace;
    answer.output = traces ? tracer_.trace(to_local(object_ray)) : OutputRay{};
    if (traces) move_to_object(answer.output);
    answer.by = by;
    answer.error = 0.0;
}

void FastTree::ask(std::span<const Ray> rays, std::span<const RaySpacing> spacings, std::span<CachedAnswer> answers,
                   Uninterpolated others) {
    const FloatEnvironment environment;
    for (size_t first = 0; first < rays.size(); first += kRaysPerReader) {
        const size_t end = std::min(first + kRaysPerReader, rays.size());
        Search search(store_, others);
        for (size_t i = first; i < end; i += kBatchRays) {
            const int count = static_cast<int>(std::min<size_t>(kBatchRays, end - i));
            ask_batch(search, &rays[i], spacings.empty() ? nullptr : &spacings[i], count, &answers[i]);
        }
    }
}

void FastTree::ask_batch(Search& search, const Ray* rays, const RaySpacing* spacings, int count,
                         CachedAnswer* answers) {
    LineBatch& batch = search.batch;
    functions_.prepare(rays, count, frame_, batch);
    RaySet pending = space_.box().isEmpty() ? RaySet{0} : batch.in_box;
    for (int i = 0; i < count; ++i) {
        if ((pending >> i & 1) != 0) continue;
        const bool is_one = (batch.rays >> i & 1) != 0;
        answers[i] = CachedAnswer{{}, is_one ? AnsweredBy::BoxMissed : AnsweredBy::NotARay, 0.0};
    }
    std::array<int, kBatchRays> worth;
    worth.fill(steps_.deepest());
    if (spacings) {
        int near = steps_.deepest(), last = -1;
        for (uint32_t rest = pending; rest != 0; rest &= rest - 1) {
            const int ray = std::countr_zero(rest);
            const RaySpacing& spacing = spacings[ray];
            const bool is_as_last = last >= 0 && batch.line_direction[ray] == batch.line_direction[last] &&
                                    spacing.distance == spacings[last].distance &&
                                    spacing.angle == spacings[last].angle;
            if (!is_as_last) {
                const auto distance = static_cast<float>(spacing.distance * frame_.shrink);
                const auto direction = static_cast<uint8_t>(batch.line_direction[ray]);
                near = steps_.deepest_worth(direction, {distance, spacing.angle}, near);
            }
            worth[ray] = near;
            last = ray;
        }
    }
    // A leaf on its way from memory while the next one is looked for.
    Found waiting;
    RaySet waiting_set = 0;
    while (pending != 0) {
        const int ray = std::countr_zero(pending);
        const Found found = find(search, ray, worth[ray]);
        RaySet set = static_cast<RaySet>(1 << ray);
        if (found.verdict != CellVerdict::Unknown && pending != set) {
            const RaySet in_cell = functions_.rays_in(batch, found.key.direction, steps_.place(found.key)) & pending;
            for (uint32_t rest = in_cell; rest != 0; rest &= rest - 1) {
                const int other = std::countr_zero(rest);
                if (worth[other] >= found.step) set = static_cast<RaySet>(set | 1 << other);
            }
        }
        pending = static_cast<RaySet>(pending & ~set);
        const bool is_held = found.leaf && found.leaf != &search.own_leaf;
        if (is_held && pending != 0) {
            prefetch(*found.leaf);
            if (waiting_set != 0) answer_cell(search, waiting, waiting_set, rays, answers);
            waiting = found;
            waiting_set = set;
        } else {
            answer_cell(search, found, set, rays, answers);
        }
    }
    if (waiting_set != 0) answer_cell(search, waiting, waiting_set, rays, answers);
    for (int i = 0; i < count; ++i) ++search.answers[static_cast<size_t>(answers[i].by)];
}

/// Answers the rays of a set, all in one cell.
void FastTree::answer_cell(Search& search, const Found& found, RaySet set, const Ray* rays, CachedAnswer* answers) {
    const AnsweredBy by = answered_by(found.verdict);
    if (by != AnsweredBy::Interpolated) {
        for (uint32_t rest = set; rest != 0; rest &= rest - 1) {
            const int ray = std::countr_zero(rest);
            answer_plainly(search, rays[ray], by, answers[ray]);
        }
        return;
    }
    const CellPlace place = steps_.place(found.key);
    if (std::popcount(set) <= kOneByOne) {
        float values[kLeafPadding];
        for (uint32_t rest = set; rest != 0; rest &= rest - 1) {
            const int ray = std::countr_zero(rest);
            functions_.evaluate_one(search.batch, ray, place, *found.leaf, values);
            interpolate(search, found, ray, rays[ray], values, 1, answers[ray]);
        }
        return;
    }
    alignas(64) float values[kMostLeafValues][kBatchRays];
    functions_.evaluate(search.batch, place, *found.leaf, values);
    for (uint32_t rest = set; rest != 0; rest &= rest - 1) {
        const int ray = std::countr_zero(rest);
        interpolate(search, found, ray, rays[ray], &values[0][ray], kBatchRays, answers[ray]);
    }
}

void FastTree::interpolate(const Search& search, const Found& found, int ray, const Ray& given, const float* values,
                           size_t stride, CachedAnswer& answer) const {
    const LineBatch& batch = search.batch;
    const bool starts_inside = (batch.inside >> ray & 1) != 0;
    const OutputKind kind = tracer_.settings().kind;
    // The length of a line says nothing about where on it the object lies.
    if (starts_inside && kind == OutputKind::Volume)
        return answer_plainly(search, given, AnsweredBy::TracedOrigin, answer);
    LineGeometry line;
    line.axis = found.key.direction / 2;
    line.intercept = {batch.intercept[0][ray], batch.intercept[1][ray]};
    line.slope = {batch.slope[0][ray], batch.slope[1][ray]};
    line.direction = {batch.direction[0][ray], batch.direction[1][ray], batch.direction[2][ray]};
    set_output(kind, *found.leaf, values, stride, line, frame_.box_center, answer.output);
    if (starts_inside) {
        const Vec3d origin = (given.origin - frame_.center) * frame_.shrink;
        const double margin = kBeyondErrors * double{found.leaf->position_error} + kLeastBeyond * space_.half_extent();
        if (!((answer.output.position - origin).dot(line.direction) > margin))
            return answer_plainly(search, given, AnsweredBy::TracedOrigin, answer);
    }
    move_to_object(answer.output);
    answer.by = AnsweredBy::Interpolated;
    answer.error = found.leaf->error;
}

/// Goes down to the final cell that holds a ray, and makes what is missing on the way; or to where it is not worth it.
FastTree::Found FastTree::find(Search& search, int ray, int deepest_worth) {
    const LineBatch& batch = search.batch;
    Found found;
    found.key.direction = static_cast<uint8_t>(batch.line_direction[ray]);
    const uint8_t direction = found.key.direction;
    LinePlaces places{};
    for (int k = 0; k < kLineAxes; ++k) places[k] = static_cast<uint32_t>(batch.place[k][ray]);
    CellBlock* block = search.reader.current();
    std::atomic<CellRef>* place = block ? &block->root(direction) : nullptr;
    for (; found.step <= deepest_worth; ++found.step) {
        CellRef ref = place ? place->load(std::memory_order_acquire) : 0;
        found.verdict = verdict_of(ref);
        if (found.verdict == CellVerdict::Unknown) {
            const CellKey key = steps_.key(direction, found.step, places);
            found.verdict = copy_older(search, key, found.step);
            if (found.verdict == CellVerdict::Unknown) found.verdict = make_cell(search, key, found.step);
            if (place) ref = store_cell(search, found.verdict, *place);
            if (ref == 0) place = nullptr;  // no room: from here on by itself
        }
        if (found.verdict != CellVerdict::Halved) {
            found.key = steps_.key(direction, found.step, places);
            if (found.verdict == CellVerdict::Interpolated) found.leaf = place ? &block->leaf(ref) : &search.own_leaf;
            return found;
        }
        if (place) place = &block->node(ref).children[steps_.child(direction, found.step, places)];
    }
    found.verdict = CellVerdict::Unknown;
    return found;
}

/// Samples a cell and judges it. Its leaf, if it has one, is the search's own. Two samples of different classes decide,
/// whichever they are: those that are held already are looked at first, and after the first such pair none is traced.
CellVerdict FastTree::make_cell(Search& search, const CellKey& key, int step) {
    const CellDepths depths = steps_.depths(step);
    CellSamples samples;
    std::optional<SampleClass> seen;
    const auto differs = [&](int i) {
        if (!seen) seen = samples[i].sample_class;
        return samples[i].sample_class != *seen;
    };
    std::array<SampleTable::Key, kCellCorners + 1> keys;
    for (int i = 0; i <= kCellCorners; ++i) {
        keys[i] = SampleTable::key_of(steps_.sample_point(key, i));
        samples_.prefetch(keys[i]);
    }
    for (const SampleTable::Key& each : keys) samples_.prefetch_sample(each);
    uint32_t missing = 0;
    for (int i = 0; i <= kCellCorners; ++i) {
        if (!samples_.find(keys[i], samples[i]))
            missing |= 1u << i;
        else if (differs(i))
            return CellJudge::judge_mixed(depths);
    }
    for (const int i : kSampleOrder) {
        if ((missing >> i & 1) == 0) continue;
        samples[i] = take_sample(tracer_, space_, keys[i].point, judge_.contents());
        ++search.samples_taken;
        samples_.put(keys[i], samples[i]);
        if (differs(i)) return CellJudge::judge_mixed(depths);
    }
    return judge_.judge(key, depths, samples, search.own_leaf);
}

/// What the block that was current before says of a cell, its leaf as the search's own; or Unknown.
CellVerdict FastTree::copy_older(Search& search, const CellKey& key, int step) const {
    CellBlock* older = search.reader.older();
    if (!older) return CellVerdict::Unknown;
    const LinePlaces places = steps_.first_places(key);
    CellRef ref = older->root(key.direction).load(std::memory_order_acquire);
    for (int i = 0; i < step; ++i) {
        if (verdict_of(ref) != CellVerdict::Halved) return CellVerdict::Unknown;
        ref = older->node(ref).children[steps_.child(key.direction, i, places)].load(std::memory_order_acquire);
    }
    if (verdict_of(ref) == CellVerdict::Interpolated) {
        const CellLeaf& leaf = older->leaf(ref);
        std::memcpy(static_cast<void*>(&search.own_leaf), &leaf, leaf.stored_bytes());
    }
    return verdict_of(ref);
}

/// Publishes a cell, its leaf being the search's own, at its place; 0 if there is no room.
CellRef FastTree::store_cell(Search& search, CellVerdict verdict, std::atomic<CellRef>& place) {
    CellBlock& block = *search.reader.current();
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
    functions_.prepare(&object_ray, 1, frame_, search.batch);
    if (space_.box().isEmpty() || search.batch.in_box == 0) return std::nullopt;
    return find(search, 0, steps_.deepest()).key;
}

FastSample FastTree::sample(const LatticePoint& point) const {
    return take_sample(tracer_, space_, point, judge_.contents());
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
