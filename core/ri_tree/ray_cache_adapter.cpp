#include "ri_tree/ray_cache_adapter.h"

#include "ri_tree/patch_classes.h"

namespace rayleaf {
namespace {

/// The error is known at a cell's centre only, where it may be small by chance. This many times as much is assumed for
/// points.
constexpr double kErrorsBeside = 2.0;
/// And at least this share of the half extent: samples are in single precision.
constexpr double kLeastError = 0x1p-20;
/// Rays that meet an interpolated surface at less than this cosine are traced: the side they meet would be uncertain.
constexpr double kLeastCosine = 0.02;

RayAnswer kind_of(AnsweredBy by) {
    switch (by) {
        case AnsweredBy::NotARay:
        case AnsweredBy::BoxMissed:
        case AnsweredBy::CellMissed:
        case AnsweredBy::TwoClassMissed:
        case AnsweredBy::FollowedMissed:
            return RayAnswer::Missed;
        case AnsweredBy::Interpolated:
            return RayAnswer::Interpolated;
        case AnsweredBy::TwoClassInterpolated:
        case AnsweredBy::Followed:
            return RayAnswer::Followed;
        default:
            return RayAnswer::Traced;
    }
}

GlassWay way_of(PathEnding ending) {
    if (ending == PathEnding::CutOff) return GlassWay::CutOff;
    return ending == PathEnding::Left ? GlassWay::Leaves : GlassWay::Unknown;
}

}  // namespace

RayCacheAdapter::RayCacheAdapter(uint32_t number, std::shared_ptr<RayCache> cache, std::shared_ptr<const Shape> shape,
                                 OutputKind kind, double neighbour_scale, const CancelToken& cancel)
    : LocalRayCache(number),
      cache_(std::move(cache)),
      shape_(std::move(shape)),
      kind_(kind),
      neighbour_scale_(neighbour_scale) {
    const Box3d box(Vec3d(shape_->bounds().min), Vec3d(shape_->bounds().max));
    half_extent_ = box.isEmpty() ? 0.0 : 0.5 * max_component(box.size());
    list_elements(cancel);
}

void RayCacheAdapter::list_elements(const CancelToken& cancel) {
    const uint32_t count = shape_->element_count();
    const auto slot_of = [&](uint32_t element) {
        return shape_->material_slot(shape_->element_point(element, Vec2f(0.25f, 0.25f)).hit);
    };
    bool one_slot = true;
    for (uint32_t element = 1; element < count && one_slot; ++element) one_slot = slot_of(element) == slot_of(0);
    if (one_slot) return;
    const PatchClasses classes(*shape_, kind_ == OutputKind::Simple ? TextureSeams::Parted : TextureSeams::Joined,
                               cancel);
    element_of_class_.assign(classes.count() + 1, 0);
    for (uint32_t element = count; element-- > 0;)
        if (classes.of_element(element) != kFacetedClass) element_of_class_[classes.of_element(element)] = element;
}

CachedAnswer RayCacheAdapter::answer(const Vec3d& origin, const Vec3d& direction, const RayNeighbours& neighbours,
                                     HitChanges& changes) const {
    const LocalFrame& frame = shape_->frame();
    Ray ray;
    ray.origin = origin * frame.scale + frame.center;
    ray.direction = direction;
    const RaySpacing spacing{static_cast<float>(neighbours.distance * frame.scale * neighbour_scale_),
                             static_cast<float>(neighbours.angle * neighbour_scale_)};
    CachedAnswer result;
    RayQuestions question{{&ray, 1}, {&spacing, 1}, Uninterpolated::Leave, {}};
    if (!neighbours.differential) {
        cache_->ask(question, {&result, 1}, {});
        return result;
    }
    RayDifferential differential = *neighbours.differential;
    differential.dp_dx *= static_cast<float>(frame.scale);
    differential.dp_dy *= static_cast<float>(frame.scale);
    question.differentials = {&differential, 1};
    cache_->ask(question, {&result, 1}, {&changes, 1});
    for (HitChanges::Step& step : changes.steps) step.exit_position /= static_cast<float>(frame.scale);
    return result;
}

ObjectAnswer RayCacheAdapter::ask(const Vec3d& origin, const Vec3d& direction, const RayNeighbours& neighbours) const {
    ObjectAnswer result;
    const CachedAnswer found = answer(origin, direction, neighbours, result.hit.changes);
    result.answer = kind_of(found.by);
    if (result.answer == RayAnswer::Traced || result.answer == RayAnswer::Missed) return result;
    const OutputRay& output = found.output;
    if (!(std::abs(output.normal.dot(direction)) > kLeastCosine)) {
        result.answer = RayAnswer::Traced;
        return result;
    }
    const LocalFrame& frame = shape_->frame();
    const auto to_local = [&](const Vec3d& object) { return (object - frame.center) / frame.scale; };
    const uint32_t first_class = output.sample_class.first_hit;
    if (first_class < element_of_class_.size()) result.primitive = element_of_class_[first_class];
    result.distance = (to_local(output.position) - origin).dot(direction);
    result.normal = output.normal;
    InterpolatedHit& hit = result.hit;
    hit.uv = Vec2f(output.uv);
    hit.error = static_cast<float>(found.error);
    hit.position_error = std::max(kErrorsBeside * found.position_error, kLeastError) * half_extent_;
    if (kind_ == OutputKind::Glass) hit.way = way_of(output.sample_class.ending);
    hit.exit_position = to_local(output.exit_position);
    hit.exit_direction = output.exit_direction;
    hit.interior_hits = output.sample_class.interior_hits;
    hit.total_reflections = output.sample_class.total_reflections;
    return result;
}

LengthAnswer RayCacheAdapter::ask_length(const Vec3d& origin, const Vec3d& direction,
                                         const RayNeighbours& neighbours) const {
    HitChanges unwanted;
    const CachedAnswer found = answer(origin, direction, neighbours, unwanted);
    const RayAnswer kind = kind_of(found.by);
    return {kind, kind == RayAnswer::Missed ? 0.0 : found.output.length / shape_->frame().scale,
            static_cast<float>(found.error)};
}

}  // namespace rayleaf
