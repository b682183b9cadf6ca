#include "ri_tree/line_batch.h"

#include "base/simd_choice.h"

#include <algorithm>
#include <bit>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "ri_tree/line_batch.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rayleaf {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Doubles = hn::CappedTag<double, 8>;
using DoubleVector = hn::Vec<Doubles>;
using DoubleMask = hn::Mask<Doubles>;
constexpr int kDoubles = static_cast<int>(hn::MaxLanes(Doubles()));
using Floats = hn::CappedTag<float, kBatchRays>;
using FloatVector = hn::Vec<Floats>;
constexpr int kFloats = static_cast<int>(hn::MaxLanes(Floats()));

#include "base/lanes.inl"

struct DoubleVectors {
    DoubleVector x, y, z;
};

HWY_INLINE DoubleVector dot(const DoubleVectors& a, const DoubleVectors& b) {
    return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}

/// Zero if the vector is finite.
HWY_INLINE DoubleVector finite_test(const DoubleVectors& v) {
    return hn::Add(hn::Add(hn::Sub(v.x, v.x), hn::Sub(v.y, v.y)), hn::Sub(v.z, v.z));
}

/// Unit directions. Those that are unit already, up to rounding, keep their bits.
HWY_INLINE DoubleVectors unit(const DoubleVectors& v) {
    const Doubles lanes;
    const DoubleVector one = hn::Set(lanes, 1.0);
    const DoubleMask is_unit = hn::Le(hn::Abs(hn::Sub(dot(v, v), one)), hn::Set(lanes, 0x1p-44));
    if (hn::AllTrue(lanes, is_unit)) return v;
    const DoubleVector largest = hn::Max(hn::Abs(v.x), hn::Max(hn::Abs(v.y), hn::Abs(v.z)));
    const DoubleVectors scaled{hn::Div(v.x, largest), hn::Div(v.y, largest), hn::Div(v.z, largest)};
    const DoubleVector length = hn::Sqrt(dot(scaled, scaled));
    return {hn::IfThenElse(is_unit, v.x, hn::Div(scaled.x, length)),
            hn::IfThenElse(is_unit, v.y, hn::Div(scaled.y, length)),
            hn::IfThenElse(is_unit, v.z, hn::Div(scaled.z, length))};
}

/// The intervals of lines within a box, clipped by one axis after the other.
struct BoxIntervals {
    DoubleVector begin, end;

    HWY_INLINE void clip(DoubleVector low, DoubleVector high, DoubleVector origin, DoubleVector direction,
                         DoubleVector inverse) {
        const Doubles lanes;
        const DoubleVector a = hn::Mul(hn::Sub(low, origin), inverse), b = hn::Mul(hn::Sub(high, origin), inverse);
        const DoubleVector infinity = hn::Inf(lanes);
        const DoubleMask across = hn::Eq(direction, hn::Zero(lanes));
        const DoubleMask between = hn::And(hn::Ge(origin, low), hn::Le(origin, high));
        const DoubleVector never = hn::IfThenElse(between, hn::Neg(infinity), infinity);
        begin = hn::Max(begin, hn::IfThenElse(across, never, hn::Min(a, b)));
        end = hn::Min(end, hn::IfThenElse(across, hn::Neg(never), hn::Max(a, b)));
    }
};

/// Values by axis, the dominant one first, then the two that follow cyclically.
struct Turned {
    DoubleMask is_x, is_y;

    HWY_INLINE DoubleVector pick(DoubleVector x, DoubleVector y, DoubleVector z) const {
        return hn::IfThenElse(is_x, x, hn::IfThenElse(is_y, y, z));
    }
    HWY_INLINE DoubleVectors turn(const DoubleVectors& v) const {
        return {pick(v.x, v.y, v.z), pick(v.y, v.z, v.x), pick(v.z, v.x, v.y)};
    }
};

HWY_INLINE Turned turned_to(const DoubleVectors& direction) {
    const DoubleVector x = hn::Abs(direction.x), y = hn::Abs(direction.y), z = hn::Abs(direction.z);
    // Of equal components, the first.
    return {hn::And(hn::Ge(x, y), hn::Ge(x, z)), hn::Ge(y, z)};
}

HWY_INLINE void store_ints(DoubleVector v, int32_t* out) {
    const hn::Rebind<int32_t, Doubles> integers;
    hn::StoreU(hn::DemoteTo(integers, v), integers, out);
}

HWY_INLINE void store_places(const BatchFrame& frame, const Turned& turned, DoubleMask in_box,
                             const DoubleVector (&coordinates)[kLineAxes], int first, LineBatch& batch) {
    const Doubles lanes;
    const auto& sides = frame.inverse_half_sides;
    const DoubleVector half = hn::Set(lanes, 0.5 * static_cast<double>(uint32_t{1} << kPlaceBits));
    const DoubleVector last = hn::Set(lanes, static_cast<double>((uint32_t{1} << kPlaceBits) - 1));
    for (int k = 0; k < kLineAxes; ++k) {
        const DoubleVector inverse =
            turned.pick(hn::Set(lanes, sides[0][k]), hn::Set(lanes, sides[1][k]), hn::Set(lanes, sides[2][k]));
        const DoubleVector place = hn::Add(hn::Mul(hn::Mul(coordinates[k], inverse), half), half);
        const DoubleVector within = hn::Min(hn::Max(hn::IfThenElseZero(in_box, place), hn::Zero(lanes)), last);
        store_ints(within, &batch.place[k][first]);
    }
}

/// Distances from the first ray, in doubles.
constexpr std::array<int64_t, 8> ray_offsets() {
    static_assert(sizeof(Ray) % sizeof(double) == 0);
    std::array<int64_t, 8> offsets{};
    for (size_t i = 0; i < offsets.size(); ++i) offsets[i] = static_cast<int64_t>(i * sizeof(Ray) / sizeof(double));
    return offsets;
}

/// Prepares the rays from `first` on.
HWY_INLINE void prepare_some(const Ray* rays, int first, int count, const BatchFrame& frame, LineBatch& batch) {
    const Doubles lanes;
    const hn::RebindToSigned<Doubles> indices;
    alignas(64) static constexpr std::array<int64_t, 8> kRayOffsets = ray_offsets();
    // Lanes without a ray read the last ray.
    const int last = std::min(count - first, kDoubles) - 1;
    const auto index = hn::Min(hn::Load(indices, kRayOffsets.data()), hn::Set(indices, kRayOffsets[last]));
    const uint32_t wanted = (uint32_t{1} << count) - 1;
    const auto load = [&](const double& member) HWY_ATTR { return hn::GatherIndex(lanes, &member, index); };
    const Ray& ray = rays[first];
    const DoubleVector shrink = hn::Set(lanes, frame.shrink);
    const auto local = [&](const double& member, double center)
                           HWY_ATTR { return hn::Mul(hn::Sub(load(member), hn::Set(lanes, center)), shrink); };
    const DoubleVectors given{load(ray.direction.x), load(ray.direction.y), load(ray.direction.z)};
    const DoubleVectors origin{local(ray.origin.x, frame.center.x), local(ray.origin.y, frame.center.y),
                               local(ray.origin.z, frame.center.z)};
    const DoubleVector zero = hn::Zero(lanes), one = hn::Set(lanes, 1.0);
    const DoubleMask finite = hn::Eq(hn::Add(finite_test(given), finite_test(origin)), zero);
    const DoubleMask somewhere = hn::Gt(hn::Max(hn::Abs(given.x), hn::Max(hn::Abs(given.y), hn::Abs(given.z))), zero);
    const uint32_t are_rays = mask_bits(lanes, hn::And(finite, somewhere)) & (wanted >> first);
    const DoubleVectors direction = unit(given);
    const DoubleVectors inverse{hn::Div(one, direction.x), hn::Div(one, direction.y), hn::Div(one, direction.z)};

    BoxIntervals within{hn::Neg(hn::Inf(lanes)), hn::Inf(lanes)};
    const Vec3d &low = frame.box_min, &high = frame.box_max;
    within.clip(hn::Set(lanes, low.x), hn::Set(lanes, high.x), origin.x, direction.x, inverse.x);
    within.clip(hn::Set(lanes, low.y), hn::Set(lanes, high.y), origin.y, direction.y, inverse.y);
    within.clip(hn::Set(lanes, low.z), hn::Set(lanes, high.z), origin.z, direction.z, inverse.z);
    const DoubleMask in_box = hn::And(hn::Le(within.begin, within.end), hn::Ge(within.end, zero));
    const uint32_t box_bits = mask_bits(lanes, in_box) & are_rays;
    batch.rays = static_cast<RaySet>(batch.rays | are_rays << first);
    batch.in_box = static_cast<RaySet>(batch.in_box | box_bits << first);
    batch.inside =
        static_cast<RaySet>(batch.inside | (mask_bits(lanes, hn::Lt(within.begin, zero)) & box_bits) << first);
    if (box_bits == 0) return;

    const Turned turned = turned_to(direction);
    const Vec3d& middle = frame.box_center;
    const DoubleVectors from =
        turned.turn({hn::Sub(origin.x, hn::Set(lanes, middle.x)), hn::Sub(origin.y, hn::Set(lanes, middle.y)),
                     hn::Sub(origin.z, hn::Set(lanes, middle.z))});
    const DoubleVectors along = turned.turn(direction);
    const DoubleVector inverse_along = turned.pick(inverse.x, inverse.y, inverse.z);
    const DoubleVector slope_b = hn::Mul(along.y, inverse_along), slope_c = hn::Mul(along.z, inverse_along);
    const DoubleVector coordinates[kLineAxes] = {hn::Sub(from.y, hn::Mul(slope_b, from.x)),
                                                 hn::Sub(from.z, hn::Mul(slope_c, from.x)), slope_b, slope_c};
    store_places(frame, turned, in_box, coordinates, first, batch);
    const DoubleVector axis = turned.pick(zero, hn::Set(lanes, 2.0), hn::Set(lanes, 4.0));
    const DoubleVector against = hn::IfThenElseZero(hn::Lt(along.x, zero), one);
    store_ints(hn::Add(axis, against), &batch.line_direction[first]);
    for (int i = 0; i < 2; ++i) {
        hn::StoreU(coordinates[i], lanes, &batch.intercept[i][first]);
        hn::StoreU(coordinates[i + 2], lanes, &batch.slope[i][first]);
    }
    hn::StoreU(direction.x, lanes, &batch.direction[0][first]);
    hn::StoreU(direction.y, lanes, &batch.direction[1][first]);
    hn::StoreU(direction.z, lanes, &batch.direction[2][first]);
}

void prepare(const Ray* rays, int count, const BatchFrame& frame, LineBatch& batch) {
    batch.rays = batch.in_box = batch.inside = 0;
    for (int first = 0; first < count; first += kDoubles) prepare_some(rays, first, count, frame, batch);
}

RaySet rays_in(const LineBatch& batch, int line_direction, const CellPlace& cell) {
    const hn::RebindToSigned<Floats> integers;
    uint32_t bits = 0;
    for (int first = 0; first < kBatchRays; first += kFloats) {
        auto in = hn::Eq(hn::Load(integers, &batch.line_direction[first]), hn::Set(integers, line_direction));
        for (int k = 0; k < kLineAxes; ++k) {
            const auto upper = hn::Set(integers, static_cast<int32_t>(~((uint32_t{1} << cell.bits[k]) - 1)));
            const auto first_place = hn::And(hn::Load(integers, &batch.place[k][first]), upper);
            in = hn::And(in, hn::Eq(first_place, hn::Set(integers, cell.first[k])));
        }
        bits |= mask_bits(integers, in) << first;
    }
    return static_cast<RaySet>(bits);
}

/// The factor that scales a place in a cell to 0 to 2.
HWY_INLINE float place_scale(int bits) {
    return std::bit_cast<float>(static_cast<uint32_t>(127 + 1 - bits) << 23);
}

/// The terms of a cell's polynomial at u; in the order of cell_leaf.h. `Number` is a float or a vector of them.
template <typename Number, typename Multiply, typename Subtract>
HWY_INLINE void make_terms(const Number (&u)[kLineAxes], Number one, int count, const Multiply& multiply,
                           const Subtract& subtract, Number (&terms)[kCubicTerms]) {
    terms[kConstantTerm] = one;
    for (int k = 0; k < kLineAxes; ++k) terms[kAxisTerms + k] = u[k];
    int next = kAxisTerms + kLineAxes;
    for (int i = 0; i < kLineAxes; ++i)
        for (int j = i + 1; j < kLineAxes; ++j) terms[next++] = multiply(u[i], u[j]);
    const Number first_two = terms[5], last_two = terms[10];
    terms[next++] = multiply(first_two, u[2]);
    terms[next++] = multiply(first_two, u[3]);
    terms[next++] = multiply(u[0], last_two);
    terms[next++] = multiply(u[1], last_two);
    if (count == kLinearTerms) return;
    for (int k = 0; k < kLineAxes; ++k) {
        const Number square = subtract(multiply(u[k], u[k]), one);
        terms[kSquareTerms + k] = square;
        terms[kCubeTerms + k] = multiply(square, u[k]);
        int mixed = kMixedTerms + 3 * k;
        for (int l = 0; l < kLineAxes; ++l)
            if (l != k) terms[mixed++] = multiply(square, u[l]);
    }
}

/// The sum of a polynomial's terms, as four partial sums in turn, so that no addition waits for the one before it;
/// written out, so that they stay in registers. The order of additions is the same for one ray and for sixteen.
template <typename Product>
HWY_INLINE auto sum_of(int terms, const Product& product) {
    static_assert(kLinearTerms % 4 == 3 && kCubicTerms % 4 == 3);
    auto a = product(0), b = product(1), c = product(2), d = product(3);
    int t = 4;
    for (; t + 4 <= terms; t += 4) {
        a = hn::Add(a, product(t));
        b = hn::Add(b, product(t + 1));
        c = hn::Add(c, product(t + 2));
        d = hn::Add(d, product(t + 3));
    }
    a = hn::Add(a, product(t));
    b = hn::Add(b, product(t + 1));
    c = hn::Add(c, product(t + 2));
    return hn::Add(hn::Add(a, b), hn::Add(c, d));
}

void evaluate(const LineBatch& batch, const CellPlace& cell, const CellLeaf& leaf, float (*values)[kBatchRays]) {
    const Floats lanes;
    const hn::RebindToSigned<Floats> integers;
    const FloatVector one = hn::Set(lanes, 1.0f);
    const auto multiply = [](FloatVector a, FloatVector b) HWY_ATTR { return hn::Mul(a, b); };
    const auto subtract = [](FloatVector a, FloatVector b) HWY_ATTR { return hn::Sub(a, b); };
    for (int first = 0; first < kBatchRays; first += kFloats) {
        FloatVector u[kLineAxes], terms[kCubicTerms];
        for (int k = 0; k < kLineAxes; ++k) {
            const auto offset = hn::Sub(hn::Load(integers, &batch.place[k][first]), hn::Set(integers, cell.first[k]));
            u[k] = hn::Sub(hn::Mul(hn::ConvertTo(lanes, offset), hn::Set(lanes, place_scale(cell.bits[k]))), one);
        }
        make_terms(u, one, leaf.terms, multiply, subtract, terms);
        for (int i = 0; i < leaf.values; ++i) {
            const float* coefficients = leaf.coefficients.data() + i;
            const auto product = [&](int t) HWY_ATTR {
                return hn::Mul(hn::Set(lanes, coefficients[t * leaf.values]), terms[t]);
            };
            hn::StoreU(sum_of(leaf.terms, product), lanes, &values[i][first]);
        }
    }
}

HWY_INLINE float place_in_cell(const LineBatch& batch, int ray, const CellPlace& cell, int k) {
    return static_cast<float>(batch.place[k][ray] - cell.first[k]) * place_scale(cell.bits[k]) - 1.0f;
}

void evaluate_one(const LineBatch& batch, int ray, const CellPlace& cell, const CellLeaf& leaf, float* values) {
    const hn::CappedTag<float, kLeafPadding> lanes;
    constexpr int kWidth = static_cast<int>(hn::MaxLanes(lanes));
    float u[kLineAxes], terms[kCubicTerms];
    for (int k = 0; k < kLineAxes; ++k) u[k] = place_in_cell(batch, ray, cell, k);
    const auto multiply = [](float a, float b) { return a * b; };
    const auto subtract = [](float a, float b) { return a - b; };
    make_terms(u, 1.0f, leaf.terms, multiply, subtract, terms);
    for (int first = 0; first < leaf.values; first += kWidth) {
        const float* coefficients = leaf.coefficients.data() + first;
        const auto product = [&](int t) HWY_ATTR {
            return hn::Mul(hn::LoadU(lanes, coefficients + t * leaf.values), hn::Set(lanes, terms[t]));
        };
        hn::StoreU(sum_of(leaf.terms, product), lanes, values + first);
    }
}

/// A number and its derivative.
struct Changing {
    float value = 0, change = 0;
};

void differentiate(const LineBatch& batch, int ray, const CellPlace& cell, const CellLeaf& leaf,
                   const float (&step)[kLineAxes], float* changes) {
    const hn::CappedTag<float, kLeafPadding> lanes;
    constexpr int kWidth = static_cast<int>(hn::MaxLanes(lanes));
    Changing u[kLineAxes], terms[kCubicTerms];
    for (int k = 0; k < kLineAxes; ++k) u[k] = {place_in_cell(batch, ray, cell, k), step[k]};
    const auto multiply = [](const Changing& a, const Changing& b) {
        return Changing{a.value * b.value, a.value * b.change + a.change * b.value};
    };
    const auto subtract = [](const Changing& a, const Changing& b) {
        return Changing{a.value - b.value, a.change - b.change};
    };
    make_terms(u, Changing{1.0f, 0.0f}, leaf.terms, multiply, subtract, terms);
    for (int first = 0; first < leaf.values; first += kWidth) {
        const float* coefficients = leaf.coefficients.data() + first;
        const auto product = [&](int t) HWY_ATTR {
            return hn::Mul(hn::LoadU(lanes, coefficients + t * leaf.values), hn::Set(lanes, terms[t].change));
        };
        hn::StoreU(sum_of(leaf.terms, product), lanes, changes + first);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace rayleaf
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayleaf {

HWY_EXPORT(prepare);
HWY_EXPORT(rays_in);
HWY_EXPORT(evaluate);
HWY_EXPORT(evaluate_one);
HWY_EXPORT(differentiate);

BatchFunctions batch_functions() {
    choose_kernels();
    return {&HWY_DYNAMIC_DISPATCH(prepare), &HWY_DYNAMIC_DISPATCH(rays_in), &HWY_DYNAMIC_DISPATCH(evaluate),
            &HWY_DYNAMIC_DISPATCH(evaluate_one), &HWY_DYNAMIC_DISPATCH(differentiate)};
}

}  // namespace rayleaf
#endif
