#include "geometry/strands.h"

#include "base/largest.h"

#include <algorithm>
#include <limits>
#include <numbers>

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_reduce.h>

namespace rayleaf {
namespace {

/// More are indistinguishable from the round form.
constexpr int kMostSpheres = 4096;

std::string at(const char* array, size_t index) {
    return std::string(array).append("[").append(std::to_string(index)).append("]");
}

template <typename T>
void require_size(const std::string& name, const char* argument, std::span<const T> got, size_t wanted) {
    if (got.size() != wanted)
        throw InputError(name, argument, std::to_string(got.size()) + " numbers", std::to_string(wanted));
}

/// Points of a strand per segment, and points in addition to those.
struct PointsOfBasis {
    uint32_t stride, ends;
};

PointsOfBasis points_of(StrandBasis basis) {
    if (basis == StrandBasis::Bezier) return {3, 1};
    if (basis == StrandBasis::BSpline) return {1, 3};
    return {1, 1};
}

uint32_t segments_of(StrandBasis basis, uint32_t points, bool cyclic) {
    const PointsOfBasis form = points_of(basis);
    if (cyclic) return points < 2 * form.stride ? 0 : points / form.stride;
    return points <= form.ends ? 0 : (points - form.ends) / form.stride;
}

Vec4f as_value(float x) {
    return {x, x, x, 1.0f};
}

}  // namespace

float wall_angle(const Vec3d& tangent, const Vec3d& around) {
    Vec3f across, up;
    orthonormal_basis(Vec3f(tangent), across, up);
    const double angle = std::atan2(around.dot(Vec3d(up)), around.dot(Vec3d(across))) / (2.0 * std::numbers::pi);
    constexpr float kBelowOne = 1.0f - 0x1p-24f;
    return std::min(static_cast<float>(angle < 0.0 ? angle + 1.0 : angle), kBelowOne);
}

Vec3d wall_direction(const Vec3d& tangent, double v) {
    Vec3f across, up;
    orthonormal_basis(Vec3f(tangent), across, up);
    const double angle = 2.0 * std::numbers::pi * v;
    return Vec3d(across) * std::cos(angle) + Vec3d(up) * std::sin(angle);
}

Strands::Strands(StrandArrays arrays)
    : Shape(ShapeKind::Strands, std::move(arrays.name)),
      info_(arrays.info),
      basis_(arrays.basis),
      form_(arrays.form),
      spheres_per_segment_(arrays.spheres_per_segment),
      has_inside_(arrays.has_inside) {
    if (spheres_per_segment_ < 1 || spheres_per_segment_ > kMostSpheres)
        throw InputError(name(), "spheres_per_segment", std::to_string(spheres_per_segment_),
                         "1 to " + std::to_string(kMostSpheres));
    set_strands(arrays);
    set_points(arrays);
    set_attributes(std::move(arrays.attributes), arrays.active_uv);
    if (info_.intercept >= 0 || info_.length >= 0) measure();
}

void Strands::set_strands(const StrandArrays& arrays) {
    const size_t point_count = arrays.points.size() / 3;
    const std::span<const int32_t> offsets = arrays.offsets;
    if (offsets.empty() || offsets.front() != 0 || offsets.back() != static_cast<int64_t>(point_count))
        throw InputError(name(), "offsets", offsets.empty() ? "empty" : "not from 0 to the number of points",
                         "0 first, " + std::to_string(point_count) + " last");
    const size_t count = offsets.size() - 1;
    if (!arrays.cyclic.empty()) require_size(name(), "cyclic", arrays.cyclic, count);
    cyclic_.assign(arrays.cyclic.begin(), arrays.cyclic.end());
    first_point_.reserve(count + 1);
    first_segment_.reserve(count + 1);
    uint32_t segments = 0;
    for (size_t i = 0; i < count; ++i) {
        if (offsets[i + 1] < offsets[i])
            throw InputError(name(), at("offsets", i + 1), std::to_string(offsets[i + 1]),
                             "no less than the one before, " + std::to_string(offsets[i]));
        const auto points = static_cast<uint32_t>(offsets[i + 1] - offsets[i]);
        const bool cyclic = !cyclic_.empty() && cyclic_[i] != 0;
        const bool whole = cyclic ? points % 3 == 0 : points % 3 == 1;
        if (basis_ == StrandBasis::Bezier && points > 1 && !whole)
            throw InputError(name(), "strand " + std::to_string(i), std::to_string(points) + " points",
                             cyclic ? "3 a segment" : "3 a segment and 1 more");
        first_point_.push_back(static_cast<uint32_t>(offsets[i]));
        first_segment_.push_back(segments);
        segments += segments_of(basis_, points, cyclic);
    }
    first_point_.push_back(static_cast<uint32_t>(point_count));
    first_segment_.push_back(segments);
    strand_of_segment_.reserve(segments);
    for (uint32_t i = 0; i < count; ++i)
        strand_of_segment_.insert(strand_of_segment_.end(), first_segment_[i + 1] - first_segment_[i], i);
    if (arrays.material_slots.empty()) return;
    require_size(name(), "material_slots", arrays.material_slots, count);
    material_slots_ = checked_material_slots(name(), arrays.material_slots);
}

/// Before it is known what is local.
void Strands::add_point(const StrandPoint& point, size_t index) {
    if (!is_place(axis_point(point)))
        throw InputError(name(), at("points", index), place_text(axis_point(point)), kCoordinatesWanted);
    if (!(point.w >= 0.0 && std::isfinite(point.w)))
        throw InputError(name(), at("radii", index), number_text(static_cast<float>(point.w)),
                         "0 or a positive finite number");
    points_.push_back(point);
}

void Strands::set_moved_points(const StrandArrays& arrays) {
    const std::span<const double> moved = arrays.moved_points;
    const size_t count = arrays.points.size() / 3;
    const size_t steps = count == 0 ? 0 : moved.size() / (4 * count);
    if (steps < 2 || 4 * count * steps != moved.size())
        throw InputError(name(), "moved_points", std::to_string(moved.size()) + " numbers",
                         "two or more times " + std::to_string(4 * count));
    points_.clear();
    points_.reserve(count * steps);
    for (size_t i = 0; i < moved.size(); i += 4)
        add_point({moved[i], moved[i + 1], moved[i + 2], moved[i + 3]}, i / 4 % count);
    steps_ = steps;
}

void Strands::set_points(const StrandArrays& arrays) {
    const size_t count = arrays.points.size() / 3;
    require_size(name(), "radii", arrays.radii, count);
    points_.reserve(count);
    for (size_t i = 0; i < count; ++i)
        add_point({arrays.points[3 * i], arrays.points[3 * i + 1], arrays.points[3 * i + 2], arrays.radii[i]}, i);
    object_bounds_ = box_at(kMiddleTime);
    Box3d whole = object_bounds_;
    if (!arrays.moved_points.empty()) {
        set_moved_points(arrays);
        for (size_t step = 0; step < steps(); ++step) whole.extendBy(box_at(time_of_step(step, steps())));
    }
    frame_ = LocalFrame::fitting(whole);
    for (StrandPoint& p : points_) {
        const Vec3d local = (axis_point(p) - frame_.center) / frame_.scale;
        p = StrandPoint(local.x, local.y, local.z, p.w / frame_.scale);
    }
    if (whole.isEmpty()) return;
    bounds_ = {frame_.to_local(whole.min), frame_.to_local(whole.max)};
}

Box3d Strands::box_at(float time) const {
    using Range = tbb::blocked_range<uint32_t>;
    const auto around = [&](const Range& part, Box3d box) {
        for (uint32_t i = part.begin(); i < part.end(); ++i) box.extendBy(segment(i, time).bounds());
        return box;
    };
    const auto both = [](Box3d a, const Box3d& b) {
        a.extendBy(b);
        return a;
    };
    return tbb::parallel_reduce(Range(0, element_count()), Box3d(), around, both);
}

void Strands::set_attributes(std::vector<StrandAttribute> attributes, AttributeId active_uv) {
    attributes_ = std::move(attributes);
    for (size_t i = 0; i < attributes_.size(); ++i) {
        const StrandAttribute& attribute = attributes_[i];
        const std::string argument = at("attributes", i);
        if (attribute.channels < 1 || attribute.channels > 4)
            throw InputError(name(), argument + ".channels", std::to_string(attribute.channels), "1 to 4");
        const size_t count = attribute.domain == StrandDomain::Strand ? strand_count() : point_count();
        require_size(name(), argument.c_str(), std::span<const float>(attribute.values), count * attribute.channels);
        const auto bad = std::find_if(attribute.values.begin(), attribute.values.end(),
                                      [](float value) { return !std::isfinite(value); });
        if (bad != attribute.values.end()) throw InputError(name(), argument, number_text(*bad), "finite numbers");
        if (attribute.id == active_uv && attribute.channels >= 2) active_uv_ = static_cast<int>(i);
    }
}

/// Measures the lengths of the axes by chords.
void Strands::measure() {
    constexpr int kChords = 8;
    lengths_.resize(element_count());
    tbb::parallel_for(uint32_t{0}, strand_count(), [&](uint32_t strand) {
        for (uint32_t i = first_segment_[strand]; i < first_segment_[strand + 1]; ++i) {
            double length = i == first_segment_[strand] ? 0.0 : lengths_[i - 1];
            const StrandSegment curve = segment(i);
            Vec3d before = axis_point(curve.at(0.0));
            for (int k = 1; k <= kChords; ++k) {
                const Vec3d here = axis_point(curve.at(static_cast<double>(k) / kChords));
                length += (here - before).length();
                before = here;
            }
            lengths_[i] = static_cast<float>(length);
        }
    });
}

/// Point number `point` of a strand, clamped at the ends, or wrapped around on a closed strand.
uint32_t Strands::point_index(uint32_t strand, int64_t point) const {
    const int64_t first = first_point_[strand], count = int64_t{first_point_[strand + 1]} - first;
    if (is_cyclic(strand)) return static_cast<uint32_t>(first + ((point % count) + count) % count);
    return static_cast<uint32_t>(first + std::clamp<int64_t>(point, 0, count - 1));
}

/// The first of four points of a segment, counted from its strand's first.
int64_t Strands::first_of_segment(uint32_t segment) const {
    const int64_t number = int64_t{segment} - first_segment_[strand_of_segment_[segment]];
    const bool centred = basis_ == StrandBasis::Linear || basis_ == StrandBasis::CatmullRom;
    return number * points_of(basis_).stride - (centred ? 1 : 0);
}

std::array<Double4, 4> Strands::points_at(const std::array<size_t, 4>& i, float time) const {
    const StrandPoint* from = points_.data();
    if (!deforms()) return {Double4(from[i[0]]), Double4(from[i[1]]), Double4(from[i[2]]), Double4(from[i[3]])};
    const StepShare step = step_share(time, steps());
    from += step.first * point_count();
    const StrandPoint* to = from + point_count();
    const auto mixed = [&](size_t k) {
        const Double4 begin(from[k]);
        return begin + (Double4(to[k]) - begin) * step.share;
    };
    return {mixed(i[0]), mixed(i[1]), mixed(i[2]), mixed(i[3])};
}

StrandSegment Strands::segment(uint32_t segment, float time) const {
    const uint32_t strand = strand_of_segment_[segment];
    const int64_t first = first_of_segment(segment);
    std::array<size_t, 4> indices{};
    for (int i = 0; i < 4; ++i) indices[static_cast<size_t>(i)] = point_index(strand, first + i);
    return bezier_segment(basis_, points_at(indices, time));
}

Strands::Place Strands::place(uint32_t segment) const {
    const uint32_t strand = strand_of_segment_[segment];
    const int64_t first = first_of_segment(segment), count = int64_t{first_point_[strand + 1]} - first_point_[strand];
    const bool first_twice = first<0, last_twice = first + 4> count;
    if (is_cyclic(strand) && (first_twice || last_twice)) return {0, Place::kClosed};
    const int ends = (first_twice ? Place::kFirstTwice : 0) | (last_twice ? Place::kLastTwice : 0);
    return {static_cast<uint32_t>(first_point_[strand] + (first_twice ? 0 : first)), static_cast<uint8_t>(ends)};
}

StrandSegment Strands::segment(uint32_t segment, const Place& place, float time) const {
    if ((place.ends & Place::kClosed) != 0) return this->segment(segment, time);
    const size_t shift = place.ends & Place::kFirstTwice, held = place.ends & Place::kLastTwice ? 2 - shift : 3 - shift;
    std::array<size_t, 4> indices{};
    for (size_t i = 0; i < 4; ++i) indices[i] = place.first + std::min(std::max(i, shift) - shift, held);
    return bezier_segment(basis_, points_at(indices, time));
}

std::optional<uint32_t> Strands::neighbour(uint32_t segment, int step) const {
    const uint32_t strand = strand_of_segment_[segment];
    const uint32_t first = first_segment_[strand], last = first_segment_[strand + 1] - 1;
    if (step < 0 && segment == first) return is_cyclic(strand) ? std::optional(last) : std::nullopt;
    if (step > 0 && segment == last) return is_cyclic(strand) ? std::optional(first) : std::nullopt;
    return segment + step;
}

LocalSurface Strands::surface(const LocalHit& hit) const {
    LocalSurface result;
    result.position = hit.position;
    result.normal = normalized_or(hit.normal, Vec3f(0, 0, 1));
    // The root's texture coordinate is that of the whole strand: it is constant, so the derivative by it is only a
    // direction.
    result.dp_du = normalized_or(Vec3f(axis_point(segment(hit.primitive, hit.time).derivative(hit.u))), Vec3f(0.0f));
    if (active_uv_ >= 0) {
        const Vec4f uv = attribute_value(attributes_[active_uv_], hit);
        result.uv = {uv.x, uv.y};
    }
    if (form_ != StrandForm::Ribbon) return result;
    const bool is_wall = hit.v != kStrandEnd && max_abs(result.dp_du) > 0.0f;
    if (is_wall) result.normal = Vec3f(wall_direction(Vec3d(result.dp_du), hit.v));
    return result;
}

/// Between points the value is linear along the segment.
Vec4f Strands::attribute_value(const StrandAttribute& attribute, const LocalHit& hit) const {
    const uint32_t strand = strand_of_segment_[hit.primitive];
    size_t begin = strand, end = strand;
    if (attribute.domain == StrandDomain::Point) {
        const int64_t middle = basis_ == StrandBasis::BSpline ? 1 : 0;
        const int64_t place = (int64_t{hit.primitive} - first_segment_[strand]) * points_of(basis_).stride + middle;
        begin = point_index(strand, place);
        end = point_index(strand, place + points_of(basis_).stride);
    }
    Vec4f result(0, 0, 0, 1);
    for (int c = 0; c < attribute.channels; ++c) {
        const float a = attribute.values[begin * attribute.channels + c];
        const float b = attribute.values[end * attribute.channels + c];
        result[c] = a + (b - a) * hit.u;
    }
    return result;
}

std::optional<Vec4f> Strands::info_value(AttributeId id, const LocalHit& hit) const {
    const auto scale = static_cast<float>(frame_.scale);
    if (id == info_.is_strand) return as_value(1.0f);
    if (id == info_.thickness)
        return as_value(2.0f * scale * static_cast<float>(segment(hit.primitive, hit.time).at(hit.u).w));
    if (id != info_.intercept && id != info_.length) return std::nullopt;
    const uint32_t strand = strand_of_segment_[hit.primitive];
    const float whole = lengths_[first_segment_[strand + 1] - 1];
    if (id == info_.length) return as_value(whole * scale);
    const float before = hit.primitive == first_segment_[strand] ? 0.0f : lengths_[hit.primitive - 1];
    const float here = before + (lengths_[hit.primitive] - before) * hit.u;
    return as_value(whole > 0.0f ? here / whole : 0.0f);
}

std::optional<Vec4f> Strands::attribute(AttributeId id, const LocalHit& hit) const {
    if (id < 0) return std::nullopt;
    const auto found = std::find_if(attributes_.begin(), attributes_.end(),
                                    [id](const StrandAttribute& attribute) { return attribute.id == id; });
    if (found != attributes_.end()) return attribute_value(*found, hit);
    return info_value(id, hit);
}

uint32_t Strands::material_slot(const LocalHit& hit) const {
    return material_slots_.empty() ? 0u : material_slots_[strand_of_segment_[hit.primitive]];
}

/// The wall of the round strand: P = C + r n, n = across cos(angle) + up sin(angle), turned towards the end where the
/// radius shrinks.
ElementPoint Strands::element_point_at(uint32_t element, const Vec2f& parameters, float time) const {
    const StrandSegment curve = segment(element, time);
    const StrandPoint center = curve.at(parameters.x), change = curve.derivative(parameters.x);
    const Vec3d along = axis_point(change);
    const Vec3d tangent = normalized_or(along, Vec3d(0, 0, 1));
    const Vec3d around = wall_direction(tangent, parameters.y);
    const double speed = along.length();
    // On the envelope of the balls the normal leans against the tangent by the sine -r'/|C'|.
    const double sine = speed > std::abs(change.w) ? -change.w / speed : 0.0;
    const double cosine = std::sqrt(1.0 - sine * sine);
    const Vec3d normal = around * cosine + tangent * sine;
    ElementPoint result;
    result.hit.primitive = element;
    result.hit.u = parameters.x;
    result.hit.v = parameters.y;
    result.hit.time = time;
    result.hit.position = axis_point(center) + normal * center.w;
    result.hit.normal = Vec3f(normal);
    result.normal = result.hit.normal;
    const bool is_wall = parameters.y != kStrandEnd;
    result.area_factor = is_wall ? static_cast<float>(2.0 * std::numbers::pi * center.w * speed)
                                 : std::numeric_limits<float>::infinity();
    return result;
}

std::optional<ContentHash> Strands::hash_of_content() const {
    ContentHasher hasher;
    add_to(hasher);
    for (const int number :
         {static_cast<int>(basis_), static_cast<int>(form_), spheres_per_segment_, has_inside_ ? 1 : 0, active_uv_,
          info_.is_strand, info_.intercept, info_.length, info_.thickness})
        hasher.add(number);
    hasher.add(steps_);
    hasher.add(points_);
    hasher.add(first_point_);
    hasher.add(cyclic_);
    hasher.add(material_slots_);
    for (const StrandAttribute& attribute : attributes_) {
        hasher.add(attribute.id);
        hasher.add(attribute.channels);
        hasher.add(static_cast<int>(attribute.domain));
        hasher.add(attribute.values);
    }
    return hasher.value();
}

size_t Strands::bytes() const {
    size_t total = sizeof(*this) + points_.capacity() * sizeof(StrandPoint) + first_point_.capacity() * 4 +
                   first_segment_.capacity() * 4 + strand_of_segment_.capacity() * 4 + cyclic_.capacity() +
                   material_slots_.capacity() * 2 + lengths_.capacity() * 4;
    for (const StrandAttribute& attribute : attributes_) total += attribute.values.capacity() * sizeof(float);
    return total;
}

}  // namespace rayleaf
