#include "ri_tree/fast_tree.h"

#include "ri_tree/convex_path.h"
#include "ri_tree/fast_tree_search.h"
#include "ri_tree/leaf_changes.h"
#include "trace/float_environment.h"
#include "trace/local_ray.h"

#include <algorithm>
#include <bit>

namespace rayleaf {
namespace {

/// The share of the cache's bytes that samples may take.
constexpr uint64_t kSampleShare = 4;
/// An interpolated hit is taken to lie beyond an origin inside the box if it does so by this many times the error at
/// the cell's centre, and by at least this share of the half extent.
constexpr double kBeyondErrors = 2.0;
constexpr double kLeastBeyond = 0x1p-10;
/// Up to this many rays of a cell are evaluated one by one; for more, all sixteen lanes at once.
constexpr int kOneByOne = 2;
/// Rays are scattered if at most one of this many is in the first cell.
constexpr int kScatteredShare = 4;
/// After this many rays a reader releases the store, so that blocks can be exchanged.
constexpr size_t kRaysPerReader = 256;

/// Settings that allow no interpolation, or less error than that of following, leave all rays to tracing.
bool may_follow(OutputKind kind, const RayCacheSettings& settings) {
    const double least =
        std::min({settings.distance_threshold, settings.direction_threshold, settings.angle_threshold});
    return kind == OutputKind::Glass && settings.depth_limit > 0 && least >= kFollowedError;
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

FastTree::FastTree(std::shared_ptr<const Shape> shape, const SampleSettings& samples, const RayCacheSettings& settings,
                   const CancelToken& cancel)
    : FastTree(std::make_shared<const SampleTracer>(std::move(shape), samples, cancel), nullptr, settings) {
    if (may_follow(samples.kind, settings_)) body_ = ConvexBody::of(tracer_->shape());
}

FastTree::FastTree(std::shared_ptr<const SampleTracer> tracer, std::shared_ptr<const ConvexBody> body,
                   const RayCacheSettings& settings)
    : tracer_(std::move(tracer)),
      body_(std::move(body)),
      settings_(checked(tracer_->shape().name(), settings)),
      space_(tracer_->shape().bounds()),
      judge_(*tracer_, space_, settings_),
      steps_(space_, settings_),
      functions_(batch_functions()),
      samples_(tracer_->settings().kind, judge_.contents(), settings.cache_bytes / kSampleShare),
      store_(settings.cache_bytes - settings.cache_bytes / kSampleShare) {
    prepare_frame();
}

std::unique_ptr<FastTree> FastTree::emptied() const {
    return std::unique_ptr<FastTree>(new FastTree(tracer_, body_, settings_));
}

FastTree::~FastTree() = default;

void FastTree::prepare_frame() {
    const LocalFrame& local = tracer_->shape().frame();
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
    const LocalFrame& frame = tracer_->shape().frame();
    ray.length *= frame.scale;
    if (tracer_->settings().kind == OutputKind::Volume) return;
    ray.position = ray.position * frame.scale + frame.center;
    ray.exit_position = ray.exit_position * frame.scale + frame.center;
}

OutputRay FastTree::trace(const Ray& object_ray) const {
    if (!is_ray(object_ray)) return {};
    OutputRay result = tracer_->trace(to_local(object_ray));
    move_to_object(result);
    return result;
}

/// Gives an answer without interpolation: missed, or traced if the caller wants that.
void FastTree::answer_plainly(const Search& search, const Ray& object_ray, AnsweredBy by, CachedAnswer& answer) const {
    const bool traces = is_traced(by) && search.others == Uninterpolated::Trace;
    answer.output = traces ? tracer_->trace(to_local(object_ray)) : OutputRay{};
    if (traces) move_to_object(answer.output);
    answer.by = by;
    answer.error = answer.position_error = 0.0;
}

/// Follows a ray that no cell answers through a convex body; false if it is to be traced.
bool FastTree::follow(const Batch& asked, int ray) const {
    CachedAnswer& answer = asked.answers[ray];
    const Ray local = to_local(asked.rays[ray]);
    ConvexBody::Meeting meeting;
    if (asked.differentials) {
        const RayDifferential& given = asked.differentials[ray];
        const RayChanges by_picture = {RayChange{Vec3d(given.dp_dx) * frame_.shrink, Vec3d(given.dd_dx)},
                                       RayChange{Vec3d(given.dp_dy) * frame_.shrink, Vec3d(given.dd_dy)}};
        OutputChanges changes;
        meeting = follow_glass(*body_, *tracer_, local, by_picture, answer.output, changes);
        if (meeting == ConvexBody::Meeting::Crossed)
            asked.changes[ray] = hit_changes(changes, tracer_->shape().frame().scale);
    } else {
        meeting = follow_glass(*body_, *tracer_, local, answer.output);
    }
    if (meeting == ConvexBody::Meeting::Uncertain) return false;
    const bool missed = meeting == ConvexBody::Meeting::Missed;
    move_to_object(answer.output);
    answer.by = missed ? AnsweredBy::FollowedMissed : AnsweredBy::Followed;
    answer.error = missed ? 0.0 : kFollowedError;
    answer.position_error = 0.0;
    return true;
}

void FastTree::ask(const RayQuestions& questions, std::span<CachedAnswer> answers, std::span<HitChanges> changes) {
    const FloatEnvironment environment;
    const std::span<const Ray> rays = questions.rays;
    for (size_t first = 0; first < rays.size(); first += kRaysPerReader) {
        const size_t end = std::min(first + kRaysPerReader, rays.size());
        Search search(store_, questions.others);
        for (size_t i = first; i < end; i += kBatchRays) {
            const int count = static_cast<int>(std::min<size_t>(kBatchRays, end - i));
            const auto from = [i](const auto& all) { return all.empty() ? nullptr : &all[i]; };
            ask_batch(search, {count, &rays[i], from(questions.spacings), from(questions.differentials), &answers[i],
                               from(changes)});
        }
    }
}

/// For each ray, the step of the smallest cells that enough rays cross.
std::array<int, kBatchRays> FastTree::deepest_crossed(const Search& search, const Batch& asked, RaySet pending) const {
    std::array<int, kBatchRays> crossed;
    crossed.fill(steps_.deepest());
    if (!asked.spacings) return crossed;
    const LineBatch& batch = search.batch;
    int near = steps_.deepest(), last = -1;
    for (uint32_t rest = pending; rest != 0; rest &= rest - 1) {
        const int ray = std::countr_zero(rest);
        const RaySpacing& spacing = asked.spacings[ray];
        const bool is_as_last = last >= 0 && batch.line_direction[ray] == batch.line_direction[last] &&
                                spacing.distance == asked.spacings[last].distance &&
                                spacing.angle == asked.spacings[last].angle;
        if (!is_as_last) {
            const auto distance = static_cast<float>(spacing.distance * frame_.shrink);
            const auto direction = static_cast<uint8_t>(batch.line_direction[ray]);
            near = steps_.deepest_crossed(direction, {distance, spacing.angle}, near);
        }
        crossed[ray] = near;
        last = ray;
    }
    return crossed;
}

void FastTree::ask_batch(Search& search, const Batch& asked) {
    LineBatch& batch = search.batch;
    functions_.prepare(asked.rays, asked.count, frame_, batch);
    RaySet pending = space_.box().isEmpty() ? RaySet{0} : batch.in_box;
    for (int i = 0; i < asked.count; ++i) {
        if (asked.changes) asked.changes[i] = {};
        if ((pending >> i & 1) != 0) continue;
        const bool is_one = (batch.rays >> i & 1) != 0;
        asked.answers[i] = CachedAnswer{{}, is_one ? AnsweredBy::BoxMissed : AnsweredBy::NotARay, 0.0};
    }
    const std::array<int, kBatchRays> crossed = deepest_crossed(search, asked, pending);
    begin_descents(search, pending);
    bool is_first = true;
    // This leaf is being fetched from memory while the next one is looked for.
    Found waiting;
    RaySet waiting_set = 0;
    while (pending != 0) {
        const int ray = std::countr_zero(pending);
        const Found found = find(search, ray, crossed[ray]);
        RaySet set = static_cast<RaySet>(1 << ray);
        if (found.verdict != CellVerdict::Unknown && pending != set) {
            const RaySet in_cell = functions_.rays_in(batch, found.key.direction, steps_.place(found.key)) & pending;
            for (uint32_t rest = in_cell; rest != 0; rest &= rest - 1) {
                const int other = std::countr_zero(rest);
                if (crossed[other] >= std::min(found.step, crossed[ray])) set = static_cast<RaySet>(set | 1 << other);
            }
        }
        const bool is_scattered = is_first && std::popcount(set) * kScatteredShare <= std::popcount(pending);
        pending = static_cast<RaySet>(pending & ~set);
        if (is_scattered) descend_together(search, pending, crossed);
        is_first = false;
        if (found.step > crossed[ray]) count_crossings(batch, set, crossed, found.step);
        const bool is_held = found.leaf && found.leaf != &search.own_leaf;
        if (is_held && pending != 0) {
            prefetch<3>(*found.leaf);
            if (waiting_set != 0) answer_cell(search, waiting, waiting_set, asked);
            waiting = found;
            waiting_set = set;
        } else {
            answer_cell(search, found, set, asked);
        }
    }
    if (waiting_set != 0) answer_cell(search, waiting, waiting_set, asked);
    for (int i = 0; i < asked.count; ++i) ++search.answers[static_cast<size_t>(asked.answers[i].by)];
}

/// Answers the rays of a set, all in one cell.
void FastTree::answer_cell(Search& search, const Found& found, RaySet set, const Batch& asked) {
    const AnsweredBy by = answered_by(found.verdict);
    if (by != AnsweredBy::Interpolated) {
        for (uint32_t rest = set; rest != 0; rest &= rest - 1) {
            const int ray = std::countr_zero(rest);
            const bool starts_inside = (search.batch.inside >> ray & 1) != 0;
            if (is_traced(by) && body_ && !starts_inside && follow(asked, ray)) continue;
            answer_plainly(search, asked.rays[ray], by, asked.answers[ray]);
        }
        return;
    }
    const CellPlace place = steps_.place(found.key);
    if (std::popcount(set) <= kOneByOne) {
        float values[kLeafPadding];
        for (uint32_t rest = set; rest != 0; rest &= rest - 1) {
            const int ray = std::countr_zero(rest);
            functions_.evaluate_one(search.batch, ray, place, *found.leaf, values);
            interpolate(search, found, ray, asked, values, 1);
        }
        return;
    }
    alignas(64) float values[kMostLeafValues][kBatchRays];
    functions_.evaluate(search.batch, place, *found.leaf, values);
    for (uint32_t rest = set; rest != 0; rest &= rest - 1) {
        const int ray = std::countr_zero(rest);
        interpolate(search, found, ray, asked, &values[0][ray], kBatchRays);
    }
}

void FastTree::interpolate(const Search& search, const Found& found, int ray, const Batch& asked, const float* values,
                           size_t stride) const {
    const LineBatch& batch = search.batch;
    const Ray& given = asked.rays[ray];
    CachedAnswer& answer = asked.answers[ray];
    const bool starts_inside = (batch.inside >> ray & 1) != 0;
    const OutputKind kind = tracer_->settings().kind;
    // The length of a line says nothing about where the object lies on it.
    if (starts_inside && kind == OutputKind::Volume)
        return answer_plainly(search, given, AnsweredBy::TracedOrigin, answer);
    LineGeometry line;
    line.axis = found.key.direction / 2;
    line.intercept = {batch.intercept[0][ray], batch.intercept[1][ray]};
    line.slope = {batch.slope[0][ray], batch.slope[1][ray]};
    line.direction = {batch.direction[0][ray], batch.direction[1][ray], batch.direction[2][ray]};
    set_output(kind, *found.leaf, {values, stride}, line, frame_.box_center, answer.output);
    if (starts_inside) {
        const Vec3d origin = (given.origin - frame_.center) * frame_.shrink;
        const double margin = kBeyondErrors * double{found.leaf->position_error} + kLeastBeyond * space_.half_extent();
        if (!((answer.output.position - origin).dot(line.direction) > margin))
            return answer_plainly(search, given, AnsweredBy::TracedOrigin, answer);
    }
    if (asked.differentials) asked.changes[ray] = changes_of(search, found, ray, asked, line);
    move_to_object(answer.output);
    answer.by = AnsweredBy::Interpolated;
    answer.error = found.leaf->error;
    answer.position_error = found.leaf->position_error / space_.half_extent();
}

/// Derivatives of an interpolated answer, which is still in local space.
HitChanges FastTree::changes_of(const Search& search, const Found& found, int ray, const Batch& asked,
                                const LineGeometry& line) const {
    RayDifferential differential = asked.differentials[ray];
    const auto shrink = static_cast<float>(frame_.shrink);
    differential.dp_dx *= shrink;
    differential.dp_dy *= shrink;
    const Vec3d from = (asked.rays[ray].origin - frame_.center) * frame_.shrink - frame_.box_center;
    const CellPlace place = steps_.place(found.key);
    const StepsInCell in_cell = steps_in_cell(frame_, place, line, from, differential);
    float changes[kPictureSteps][kLeafPadding];
    for (int i = 0; i < kPictureSteps; ++i)
        functions_.differentiate(search.batch, ray, place, *found.leaf, in_cell.steps[i], changes[i]);
    HitChanges result = output_changes(tracer_->settings().kind, *found.leaf, changes, asked.answers[ray].output);
    for (HitChanges::Step& step : result.steps)
        step.exit_position *= static_cast<float>(tracer_->shape().frame().scale);
    return result;
}

FastSample FastTree::sample(const LatticePoint& point) const {
    return take_sample(*tracer_, body_.get(), space_, point, judge_.contents());
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
    result.tracer_bytes = tracer_->bytes();
    return result;
}

}  // namespace rayleaf
