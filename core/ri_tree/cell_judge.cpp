#include "ri_tree/cell_judge.h"

#include <bit>

namespace rayleaf {
namespace {

/// The component computed from the two others must keep its sign, and is not trusted where it is small.
constexpr float kLeastThird = 0.2f;
/// Error of the function between the corners of [-1, 1] for an error of 1 in the derivatives there: at most 8/27 for
/// one corner, and the errors of the corners partly cancel.
constexpr double kResidualShare = 0.25;

/// Functions sampled at the corners, side by side: a leaf's values, then their derivatives along each axis in turn.
constexpr int kMostFunctions = kMostLeafValues * (1 + kLineAxes);
using CornerFunctions = std::array<std::array<double, kMostFunctions>, kCellCorners>;

/// Walsh-Hadamard transform of the first `count` functions. A set bit means +1, so row S is the coefficient of
/// prod(u_k, k in S).
void transform(CornerFunctions& functions, int count) {
    for (int bit = 1; bit < kCellCorners; bit *= 2) {
        for (int i = 0; i < kCellCorners; ++i) {
            if ((i & bit) != 0) continue;
            std::array<double, kMostFunctions>&below = functions[i], &above = functions[i | bit];
            for (int f = 0; f < count; ++f) {
                const double low = below[f], high = above[f];
                below[f] = 0.5 * (low + high);
                above[f] = 0.5 * (high - low);
            }
        }
    }
}

/// Sets of axes by term, constant to three factors, in the order of cell_leaf.h.
constexpr std::array<int, kLinearTerms> kTermAxes = {0, 1, 2, 4, 8, 3, 5, 9, 6, 10, 12, 7, 11, 13, 14};

struct Fit {
    std::array<double, kCubicTerms> terms{};
    double residual = 0;  ///< the part of the samples that no such polynomial fits
};

/// The fit of value `i`; `sums` are the transforms.
Fit fit_value(const CornerFunctions& sums, int i) {
    Fit fit;
    for (int t = 0; t < kLinearTerms; ++t) fit.terms[t] = sums[kTermAxes[t]][i];
    fit.residual = std::abs(sums[kCellCorners - 1][i]);
    return fit;
}

Fit fit_value_and_changes(const CornerFunctions& sums, int i, int values) {
    Fit fit = fit_value(sums, i);
    double squares = 0.0;
    int mixed = kMixedTerms;
    for (int k = 0; k < kLineAxes; ++k) {
        const int own = 1 << k, change = values * (1 + k) + i;
        fit.terms[kSquareTerms + k] = 0.5 * sums[own][change];
        fit.terms[kCubeTerms + k] = 0.5 * (sums[0][change] - sums[own][i]);
        for (int l = 0; l < kLineAxes; ++l)
            if (l != k) fit.terms[mixed++] = 0.5 * sums[own | (1 << l)][change];
        for (int set = 1; set < kCellCorners; ++set) {
            if ((set & own) != 0 && std::popcount(static_cast<unsigned>(set)) <= 2) continue;
            const double off = (set & own) != 0 ? sums[set][change] : sums[set][change] - sums[set | own][i];
            squares += off * off;
        }
    }
    fit.residual += kResidualShare * std::sqrt(squares);
    return fit;
}

Vec3d vector_at(const std::array<float, kMostSampleValues>& values, int first) {
    return {values[first], values[first + 1], values[first + 2]};
}

/// The fold that suits a vector of all samples; false if no component keeps its sign everywhere.
bool fold(const CellSamples& samples, int first, FoldedVector& folded) {
    const Vec3d center = vector_at(samples[kCenterSample].values, first);
    folded.third = 0;
    for (uint8_t i = 1; i < 3; ++i)
        if (std::abs(center[i]) > std::abs(center[folded.third])) folded.third = i;
    folded.sign = center[folded.third] < 0.0 ? -1 : 1;
    for (const FastSample& sample : samples)
        if (!(sample.values[first + folded.third] * folded.sign >= kLeastThird)) return false;
    return true;
}

/// The sample value behind each leaf value.
std::array<int, kMostLeafValues> sources_of(OutputKind kind, const CellLeaf& leaf) {
    using namespace sample_value;
    const auto other = [](int first, const FoldedVector& folded, int i) { return first + (folded.third + i) % 3; };
    if (kind == OutputKind::Volume) return {kLength};
    std::array<int, kMostLeafValues> sources = {kDepth, other(kNormal, leaf.normal, 1), other(kNormal, leaf.normal, 2)};
    if (kind == OutputKind::Simple) {
        sources[3] = kUv;
        sources[4] = kUv + 1;
    } else if (kind == OutputKind::Glass) {
        for (int i = 0; i < 3; ++i) sources[3 + i] = kExitPosition + i;
        for (int i = 1; i < 3; ++i) sources[5 + i] = other(kExitDirection, leaf.exit_direction, i);
    }
    return sources;
}

LineGeometry geometry_of(const LineSpace& space, const Ray& ray, int axis) {
    LineGeometry line;
    line.axis = axis;
    line.direction = ray.direction;
    const Vec3d from = ray.origin - space.center();
    for (int i = 0; i < 2; ++i) {
        const int other = (axis + 1 + i) % 3;
        line.slope[i] = ray.direction[other] / ray.direction[axis];
        line.intercept[i] = from[other] - line.slope[i] * from[axis];
    }
    return line;
}

}  // namespace

CellJudge::CellJudge(const SampleTracer& tracer, const LineSpace& space, const RayCacheSettings& settings)
    : space_(space),
      kind_(tracer.settings().kind),
      contents_(tracer.shape().kind() == ShapeKind::PatchSurface ? SampleContents::ValuesAndChanges
                                                                 : SampleContents::Values),
      settings_(settings) {}

CellVerdict CellJudge::judge(const CellKey& key, const CellDepths& depths, const CellSamples& samples,
                             CellLeaf& leaf) const {
    const SampleClass& first = samples[0].sample_class;
    for (const FastSample& sample : samples)
        if (sample.sample_class != first) return judge_mixed(depths);
    const auto halved_or = [&](CellVerdict last) { return depths.deepest ? last : CellVerdict::Halved; };
    if (first.is_miss()) return space_.is_narrow(key) ? CellVerdict::Missed : halved_or(CellVerdict::LargeCell);
    if (first.is_faceted()) return CellVerdict::ManyClasses;
    if (spreads_too_far(key, samples)) return halved_or(CellVerdict::Angle);
    return fit(key, samples, leaf) ? CellVerdict::Interpolated : halved_or(CellVerdict::Error);
}

/// Whether output directions at the corners differ by more than the angular threshold.
bool CellJudge::spreads_too_far(const CellKey& key, const CellSamples& samples) const {
    if (kind_ == OutputKind::Volume || settings_.angle_threshold >= kPi) return false;
    std::array<Vec3d, kCellCorners> directions;
    for (int corner = 0; corner < kCellCorners; ++corner) {
        const std::array<float, kMostSampleValues>& values = samples[corner].values;
        if (kind_ == OutputKind::Glass) {
            directions[corner] = vector_at(values, sample_value::kExitDirection);
        } else {
            directions[corner] = vector_at(values, sample_value::kNormal);
            if (kind_ == OutputKind::Mirror)
                directions[corner] = mirrored(space_.corner_ray(key, corner).direction, directions[corner]);
        }
    }
    const double least_cosine = std::cos(settings_.angle_threshold);
    for (size_t i = 1; i < directions.size(); ++i)
        for (size_t j = 0; j < i; ++j)
            if (!(directions[i].dot(directions[j]) >= least_cosine)) return true;
    return false;
}

bool CellJudge::fit(const CellKey& key, const CellSamples& samples, CellLeaf& leaf) const {
    leaf = {};
    leaf.sample_class = samples[0].sample_class;
    leaf.values = static_cast<uint8_t>(leaf_value_count(kind_));
    leaf.terms = contents_ == SampleContents::Values ? kLinearTerms : kCubicTerms;
    if (kind_ != OutputKind::Volume && !fold(samples, sample_value::kNormal, leaf.normal)) return false;
    if (kind_ == OutputKind::Glass && !fold(samples, sample_value::kExitDirection, leaf.exit_direction)) return false;
    const std::array<int, kMostLeafValues> sources = sources_of(kind_, leaf);
    const int values = leaf.values;
    const bool has_changes = contents_ == SampleContents::ValuesAndChanges;
    const std::array<uint8_t, kLineAxes>& levels = space_.levels(key.direction, key.depth);
    std::array<double, kLineAxes> shares{};
    for (int k = 0; k < kLineAxes; ++k) shares[k] = std::ldexp(1.0, -levels[k]);
    CornerFunctions functions;
    for (int corner = 0; corner < kCellCorners; ++corner) {
        const FastSample& sample = samples[corner];
        for (int i = 0; i < values; ++i) {
            functions[corner][i] = sample.values[sources[i]];
            if (!has_changes) continue;
            for (int k = 0; k < kLineAxes; ++k)
                functions[corner][values * (1 + k) + i] = double{sample.changes[sources[i]][k]} * shares[k];
        }
    }
    transform(functions, has_changes ? values * (1 + kLineAxes) : values);
    std::array<double, kMostLeafValues> residual{};
    for (int i = 0; i < values; ++i) {
        const Fit fit = has_changes ? fit_value_and_changes(functions, i, values) : fit_value(functions, i);
        residual[i] = fit.residual;
        for (int t = 0; t < leaf.terms; ++t)
            leaf.coefficients[static_cast<size_t>(t) * leaf.values + i] = static_cast<float>(fit.terms[t]);
    }
    return is_close(key, samples[kCenterSample], residual, leaf);
}

bool CellJudge::is_close(const CellKey& key, const FastSample& center,
                         const std::array<double, kMostLeafValues>& residual, CellLeaf& leaf) const {
    // At the centre all terms vanish but the constant and the squares, which are -1.
    std::array<float, kMostLeafValues> estimate{}, displaced{}, truth{};
    const std::array<int, kMostLeafValues> sources = sources_of(kind_, leaf);
    for (int i = 0; i < leaf.values; ++i) {
        double sum = leaf.coefficients[i];
        if (leaf.terms == kCubicTerms)
            for (int k = 0; k < kLineAxes; ++k)
                sum -= leaf.coefficients[(static_cast<size_t>(kSquareTerms) + k) * leaf.values + i];
        estimate[i] = static_cast<float>(sum);
        displaced[i] = static_cast<float>(sum + residual[i]);
        truth[i] = center.values[sources[i]];
    }
    const LineGeometry line = geometry_of(space_, space_.center_ray(key), key.direction / 2);
    const auto output = [&](const std::array<float, kMostLeafValues>& values) {
        OutputRay ray;
        set_output(kind_, leaf, {values.data()}, line, space_.center(), ray);
        return ray;
    };
    const OutputRay got = output(estimate);
    leaf.error = leaf.position_error = 0.0f;
    for (const OutputRay& other : {output(truth), output(displaced)}) {
        const double error = distance(kind_, other, got, 2.0 * space_.half_extent()) / space_.half_extent();
        if (!(error <= settings_.distance_threshold)) return false;
        if (!((other.exit_direction - got.exit_direction).length() <= settings_.direction_threshold)) return false;
        if (!((other.normal - got.normal).length() <= settings_.direction_threshold)) return false;
        leaf.error = std::max(leaf.error, static_cast<float>(error));
        leaf.position_error =
            std::max({leaf.position_error, static_cast<float>((other.position - got.position).length()),
                      static_cast<float>((other.exit_position - got.exit_position).length())});
    }
    return true;
}

}  // namespace rayleaf
