#include "rivals/object_set.h"

#include <limits>

namespace rayleaf {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Rays in one batch to the only member of a set; their answers are 14 kB.
constexpr size_t kRaysAtOnce = 64;

/// The distance at which a ray enters a box, 0 inside it, infinity if it misses. `inverse`: 1 over its direction.
double entry(const Box3d& box, const Ray& ray, const Vec3d& inverse) {
    double begin = 0.0, end = kInfinity;
    for (int axis = 0; axis < 3; ++axis) {
        const double a = (box.min[axis] - ray.origin[axis]) * inverse[axis];
        const double b = (box.max[axis] - ray.origin[axis]) * inverse[axis];
        begin = std::max(begin, std::min(a, b));
        end = std::min(end, std::max(a, b));
    }
    return begin <= end ? begin : kInfinity;
}

}  // namespace

void TracedObject::ask(const RayQuestions& questions, std::span<CachedAnswer> answers, std::span<HitChanges> changes) {
    std::fill(changes.begin(), changes.end(), HitChanges{});
    const bool traces = questions.others == Uninterpolated::Trace;
    for (size_t i = 0; i < questions.rays.size(); ++i) {
        answers[i].output = traces ? cache_->trace(questions.rays[i]) : OutputRay{};
        answers[i].by = AnsweredBy::TracedManyClasses;
    }
}

ObjectSet::ObjectSet(std::vector<SetMember> members, SetAnswer wanted) : members_(std::move(members)), wanted_(wanted) {
    for (const SetMember& member : members_) boxes_.push_back(member.shape->object_bounds());
}

/// The boxes that a ray enters, the nearest first; returns how many.
size_t ObjectSet::find_entries(const Ray& ray, int32_t left, Entry* entries) const {
    size_t count = 0;
    const Vec3d inverse(1.0 / ray.direction.x, 1.0 / ray.direction.y, 1.0 / ray.direction.z);
    for (size_t i = 0; i < boxes_.size(); ++i) {
        if (static_cast<int32_t>(i) == left) continue;
        const double begin = entry(boxes_[i], ray, inverse);
        if (begin < kInfinity) entries[count++] = {static_cast<float>(begin), static_cast<int32_t>(i)};
    }
    std::sort(entries, entries + count, [](const Entry& a, const Entry& b) { return a.begin < b.begin; });
    return count;
}

void ObjectSet::ask_member(int32_t member, const SetQuery& query) {
    const SetMember& asked = members_[member];
    answers_.resize(std::max(answers_.size(), query.rays.size()));
    const std::span<CachedAnswer> answers(answers_.data(), query.rays.size());
    if (asked.cache)
        asked.cache->ask(query.rays, query.spacings, answers);
    else
        asked.plane->ask(query.rays, query.points, answers);
}

void ObjectSet::take(int32_t member, const Ray& ray, const CachedAnswer& got, double& nearest,
                     PathAnswer& answer) const {
    const OutputRay& output = got.output;
    if (wanted_ == SetAnswer::SumOfLengths) {
        answer.length += static_cast<float>(output.length);
        if (answer.object != kNoObject) return;
        answer.by = got.by;
        if (!output.sample_class.is_miss()) answer.object = member;
        return;
    }
    if (answer.object == kNoObject) answer.by = got.by;
    if (output.sample_class.is_miss()) return;
    if (members_.size() > 1) {
        const double t = (output.position - ray.origin).dot(ray.direction);
        if (t >= nearest) return;
        nearest = t;
    }
    const bool leaves = output.sample_class.ending != PathEnding::CutOff;
    answer = {member,
              got.by,
              Vec3f(output.position),
              Vec3f(output.normal),
              Vec3f(output.exit_position),
              leaves ? Vec3f(output.exit_direction) : Vec3f(0.0f),
              static_cast<float>(output.length)};
}

/// The rays that ask a member next; false if there are none.
bool ObjectSet::gather(int32_t member, const SetQuery& query) {
    asking_.clear();
    rays_.clear();
    spacings_.clear();
    points_.clear();
    for (uint32_t i = 0; i < query.rays.size(); ++i) {
        if (next_[i] == ends_[i]) continue;
        const Entry& next = entries_[next_[i]];
        if (next.member != member || (wanted_ == SetAnswer::Nearest && next.begin > nearest_[i])) continue;
        ++next_[i];
        asking_.push_back(i);
        rays_.push_back(query.rays[i]);
        if (!query.spacings.empty()) spacings_.push_back(query.spacings[i]);
        if (!query.points.empty()) points_.push_back(query.points[i]);
    }
    return !asking_.empty();
}

/// A set of one: nothing is sorted, and the member's answers stay in the processor's first cache.
void ObjectSet::ask_only_member(const SetQuery& query, std::span<PathAnswer> answers) {
    const auto part = [](auto all, size_t first, size_t count) {
        return all.empty() ? all : all.subspan(first, count);
    };
    for (size_t first = 0; first < query.rays.size(); first += kRaysAtOnce) {
        const size_t count = std::min(kRaysAtOnce, query.rays.size() - first);
        ask_member(0, {query.rays.subspan(first, count),
                       part(query.spacings, first, count),
                       part(query.points, first, count),
                       {}});
        double nearest = kInfinity;
        for (size_t i = 0; i < count; ++i) {
            answers[first + i] = PathAnswer{};
            take(0, query.rays[first + i], answers_[i], nearest, answers[first + i]);
        }
    }
}

void ObjectSet::ask(const SetQuery& query, std::span<PathAnswer> answers) {
    const std::span<const Ray> rays = query.rays;
    if (members_.size() == 1 && query.left.empty()) {
        ask_only_member(query, answers);
        return;
    }
    std::fill(answers.begin(), answers.end(), PathAnswer{});
    nearest_.assign(rays.size(), kInfinity);
    entries_.resize(std::max(entries_.size(), rays.size() * members_.size()));
    next_.resize(rays.size());
    ends_.resize(rays.size());
    for (size_t i = 0; i < rays.size(); ++i) {
        next_[i] = i * members_.size();
        ends_[i] =
            next_[i] + find_entries(rays[i], query.left.empty() ? kNoObject : query.left[i], &entries_[next_[i]]);
    }
    for (bool any = true; any;) {
        any = false;
        for (int32_t member = 0; member < static_cast<int32_t>(members_.size()); ++member) {
            if (!gather(member, query)) continue;
            any = true;
            ask_member(member, {rays_, spacings_, points_, {}});
            for (size_t k = 0; k < asking_.size(); ++k)
                take(member, rays_[k], answers_[k], nearest_[asking_[k]], answers[asking_[k]]);
        }
    }
}

}  // namespace rayleaf
