#include "scene/cell_detail.h"

#include "base/simd.h"

#include <algorithm>
#include <bit>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "scene/cell_detail.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rayleaf {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, kMostPieces>;
using Ints = hn::RebindToSigned<Floats>;
using Float = hn::Vec<Floats>;
using Int = hn::Vec<Ints>;

/// Along an axis: a whole number of steps, and the share of the next.
struct Place {
    Int whole;
    Float share;
};

HWY_INLINE Place place_of(float begin, float step, Float piece) {
    const Floats floats;
    const Float at = hn::Add(hn::Set(floats, begin), hn::Mul(hn::Set(floats, step), piece));
    const Float inside = hn::Max(hn::Zero(floats), at);
    const Float last = hn::Set(floats, static_cast<float>(CellDetail::kSteps - 1));
    const Int whole = hn::ConvertTo(Ints(), hn::Min(inside, last));
    const Float share = hn::Sub(inside, hn::ConvertTo(floats, whole));
    return {whole, hn::Min(share, hn::Set(floats, 1.0f))};
}

HWY_INLINE Float mixed(Float a, Float b, Float share) {
    return hn::Add(a, hn::Mul(hn::Sub(b, a), share));
}

/// Between two points of a row.
HWY_INLINE Float in_row(const uint8_t* points, Int first, Float share) {
    const Int bytes = hn::GatherOffset(Ints(), reinterpret_cast<const int32_t*>(points), first);
    const Int byte = hn::Set(Ints(), 255);
    const Float a = hn::ConvertTo(Floats(), hn::And(bytes, byte));
    const Float b = hn::ConvertTo(Floats(), hn::And(hn::ShiftRight<8>(bytes), byte));
    return mixed(a, b, share);
}

HWY_ATTR void look_up_pieces(const uint8_t* points, PiecesOfCell& pieces) {
    static_assert(std::endian::native == std::endian::little);
    constexpr int kRow = CellDetail::kSide, kLayer = kRow * kRow;
    const Floats floats;
    const Ints ints;
    for (size_t first = 0; first < kMostPieces; first += hn::Lanes(floats)) {
        const Float piece = hn::Iota(floats, static_cast<float>(first) + 0.5f);
        const Place x = place_of(pieces.begin[0], pieces.step[0], piece);
        const Place y = place_of(pieces.begin[1], pieces.step[1], piece);
        const Place z = place_of(pieces.begin[2], pieces.step[2], piece);
        const Int corner =
            hn::Add(hn::Add(x.whole, hn::Mul(y.whole, hn::Set(ints, kRow))), hn::Mul(z.whole, hn::Set(ints, kLayer)));
        const auto row = [&](int more) { return in_row(points, hn::Add(corner, hn::Set(ints, more)), x.share); };
        const Float low = mixed(row(0), row(kRow), y.share);
        const Float high = mixed(row(kLayer), row(kLayer + kRow), y.share);
        hn::Store(mixed(low, high, z.share), floats, pieces.shares.data() + first);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace rayleaf
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayleaf {

HWY_EXPORT(look_up_pieces);

namespace {

/// Between points extinctions are as far from what is expected there as this share of how far the points are from
/// what the cell's corners make expect.
constexpr float kFromPoints = 0.5f;
/// The least residual, over the cell's majorant: what is rarely met must not weigh much.
constexpr float kLeastResidual = 0.05f;
/// A bound that is larger than the densest point by more than this factor knows of what the points miss.
constexpr float kCovered = 2.0f;
/// Detail that leaves more than this share of the residual is not worth its lookups.
constexpr float kWorthy = 0.9f;

using Densities = std::array<float, CellDetail::kPoints>;

/// What a cell's corners make expect at its points: along one axis after the other.
Densities between_corners(const Densities& densities) {
    Densities expected = densities;
    size_t stride = 1;
    for (int axis = 0; axis < 3; ++axis, stride *= CellDetail::kSide)
        for (size_t i = 0; i < CellDetail::kPoints; ++i) {
            const size_t place = i / stride % CellDetail::kSide;
            if (place == 0 || place == CellDetail::kSteps) continue;
            const float first = expected[i - stride * place];
            const float last = expected[i + stride * (CellDetail::kSteps - place)];
            expected[i] = first + (last - first) * static_cast<float>(place) / CellDetail::kSteps;
        }
    return expected;
}

}  // namespace

CellDetail::CellDetail(std::span<const FoundDensity, kPoints> found, const DensityBounds& cell) {
    const float mean = average(cell.mean);
    if (!(mean > 0.0f) || !std::isfinite(mean) || !std::isfinite(cell.majorant)) return;
    Densities densities;
    float largest = 0.0f;
    scatters_ = true;
    for (size_t i = 0; i < kPoints; ++i) {
        if (found[i].lookups > 0.0f) return;
        densities[i] = average(found[i].extinction);
        const float extinction = max_component(found[i].extinction);
        largest = std::max(largest, extinction);
        if (extinction > 0.0f && !found[i].scatters) scatters_ = false;
    }
    const auto [least, most] = std::ranges::minmax(densities);
    const Densities expected = between_corners(densities);
    float colors = 0.0f, corners = 0.0f;
    for (size_t i = 0; i < kPoints; ++i) {
        colors = std::max(colors, max_abs(found[i].extinction - cell.mean * (densities[i] / mean)));
        corners = std::max(corners, std::abs(densities[i] - expected[i]));
    }
    const float shown = colors + corners * (max_component(cell.mean) / mean) * kFromPoints;
    const float missed = cell.majorant - kCovered * largest;
    const float residual = std::max({shown, missed, kLeastResidual * cell.majorant});
    if (!(residual < kWorthy * cell.residual)) return;
    residual_ = residual;
    least_ = least / mean;
    per_share_ = (most - least) / mean / 255.0f;
    if (!(most > least)) return;
    for (size_t i = 0; i < kPoints; ++i)
        shares_[i] = static_cast<uint8_t>(std::lround((densities[i] - least) / (most - least) * 255.0f));
}

void CellDetail::look_up(PiecesOfCell& pieces) const {
    HWY_DYNAMIC_DISPATCH(look_up_pieces)(shares_.data(), pieces);
}

DensityBounds CellDetail::bounds(const DensityBounds& cell, float share) const {
    DensityBounds bounds = cell;
    bounds.mean = cell.mean * (least_ + per_share_ * share);
    bounds.residual = residual_;
    bounds.majorant = std::min(max_component(bounds.mean) + residual_, cell.majorant);
    if (scatters_)
        bounds.certain = std::max(std::min({bounds.mean.x, bounds.mean.y, bounds.mean.z}) - residual_, cell.certain);
    return bounds;
}

}  // namespace rayleaf
#endif
