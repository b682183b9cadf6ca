#include "shading/microfacet_albedo.h"

#include "shading/fresnel.h"
#include "shading/microfacet.h"

#include <array>
#include <optional>

namespace rayleaf {
namespace {

constexpr int kNodes = 24;                          ///< of each axis of the reflection table
constexpr int kGlassNodes = 16;                     ///< of each axis of the glass tables
constexpr int kQuadrature = 377, kFibonacci = 233;  ///< points of the quadrature, and the number before
constexpr float kLeastTableCosine = 1e-3f, kLeastTableAlpha = 1e-3f;
/// Axis of indices: |ior - 1| / (ior + 1), up to an index of 10.
constexpr float kLargestIndexAxis = 9.0f / 11.0f;

// Nodes lie closer at grazing angles and at small roughness, where albedo changes fastest.
float cosine_at(float x) {
    return std::max(x * x, kLeastTableCosine);
}
float alpha_at(float x) {
    return std::max(x * x, kLeastTableAlpha);
}

/// A Fibonacci lattice of the unit square, crowded towards both ends of x, where the integrands have roots; the weights
/// add up to 1.
struct QuadraturePoint {
    Vec2f random;
    float weight;

    explicit QuadraturePoint(int i) {
        const float t = (static_cast<float>(i) + 0.5f) / kQuadrature;
        random = Vec2f(t * t * (3.0f - 2.0f * t), static_cast<float>(i * kFibonacci % kQuadrature) / kQuadrature);
        weight = 6.0f * t * (1.0f - t) * kWeightScale / kQuadrature;
    }
    /// The midpoint rule overestimates the integral of 6 t (1 - t), which is 1.
    static constexpr float kWeightScale = 1.0f / (1.0f + 0.5f / (kQuadrature * kQuadrature));
};

/// Of white facets, or of those whose reflectance is how far `rising`'s has risen.
float reflection_quadrature(const Microfacets& facets, const Vec3f& o, Masking masking,
                            std::optional<float> rising = std::nullopt) {
    const float seen = facets.masking(o);
    float sum = 0.0f;
    for (int i = 0; i < kQuadrature; ++i) {
        const QuadraturePoint point(i);
        const Vec3f h = facets.sample_visible(o, point.random);
        const float cosine = o.dot(h), reflectance = rising ? fresnel_rise(*rising, cosine) : 1.0f;
        sum += point.weight * reflectance * facets.shadowing(seen, h * (2.0f * cosine) - o, masking);
    }
    return sum;
}

float glass_quadrature(const Microfacets& facets, const Vec3f& o, float ior, Masking masking) {
    const float seen = facets.masking(o);
    float sum = 0.0f;
    for (int i = 0; i < kQuadrature; ++i) {
        const QuadraturePoint point(i);
        const Vec3f h = facets.sample_visible(o, point.random);
        const float cosine = o.dot(h), fresnel = dielectric_fresnel(cosine, ior);
        sum += point.weight * fresnel * facets.shadowing(seen, h * (2.0f * cosine) - o, masking);
        const float beyond2 = (ior - 1.0f) * (ior + 1.0f) + cosine * cosine;
        if (!(beyond2 > 0.0f)) continue;
        const Vec3f through = (h * (cosine - std::sqrt(beyond2)) - o) / ior;
        sum +=
            point.weight * (1.0f - fresnel) * facets.shadowing(seen, Vec3f(through.x, through.y, -through.z), masking);
    }
    return sum;
}

/// A position on an axis of `nodes`: the node below and the share of the one above.
struct AxisPosition {
    int node;
    float share;

    AxisPosition(float x, int nodes) {
        const float scaled = std::clamp(x, 0.0f, 1.0f) * static_cast<float>(nodes - 1);
        node = std::min(static_cast<int>(scaled), nodes - 2);
        share = scaled - static_cast<float>(node);
    }
};

float node_value(int i, int nodes) {
    return static_cast<float>(i) / static_cast<float>(nodes - 1);
}

Vec3f view_at(float x) {
    const float cosine = cosine_at(x);
    return {std::sqrt(1.0f - cosine * cosine), 0.0f, cosine};
}

using ReflectionTable = std::array<std::array<float, kNodes>, kNodes>;

ReflectionTable reflection_table(Masking masking) {
    ReflectionTable table;
    for (int a = 0; a < kNodes; ++a) {
        const float alpha = alpha_at(node_value(a, kNodes));
        for (int c = 0; c < kNodes; ++c)
            table[a][c] = reflection_quadrature({MicrofacetDistribution::Ggx, alpha, alpha},
                                                view_at(node_value(c, kNodes)), masking);
    }
    return table;
}

const ReflectionTable& reflection_table_of(Masking masking) {
    if (masking == Masking::Joint) {
        static const ReflectionTable joint = reflection_table(Masking::Joint);
        return joint;
    }
    static const ReflectionTable separate = reflection_table(Masking::Separate);
    return separate;
}

/// By roughness: the mean of a row over light from everywhere.
std::array<float, kNodes> mean_table() {
    constexpr int kSteps = 64;  // even in the squared cosine
    std::array<float, kNodes> means;
    for (int a = 0; a < kNodes; ++a) {
        float sum = 0.0f;
        for (int i = 0; i < kSteps; ++i)
            sum += ggx_reflection_albedo(alpha_at(node_value(a, kNodes)),
                                         std::sqrt((static_cast<float>(i) + 0.5f) / kSteps), Masking::Joint);
        means[a] = sum / kSteps;
    }
    return means;
}

using GlassTable = std::array<std::array<std::array<float, kGlassNodes>, kGlassNodes>, kGlassNodes>;

/// Of `quadrature` (roughness, the viewer's direction, index); `denser`: the medium beyond has the larger index.
template <typename Quadrature>
GlassTable glass_table(bool denser, Quadrature quadrature) {
    GlassTable table;
    for (int n = 0; n < kGlassNodes; ++n) {
        const float r = node_value(n, kGlassNodes) * kLargestIndexAxis;
        const float ior = denser ? (1.0f + r) / (1.0f - r) : (1.0f - r) / (1.0f + r);
        for (int a = 0; a < kGlassNodes; ++a) {
            const float alpha = alpha_at(node_value(a, kGlassNodes));
            for (int c = 0; c < kGlassNodes; ++c)
                table[n][a][c] = quadrature(alpha, view_at(node_value(c, kGlassNodes)), ior);
        }
    }
    return table;
}

template <typename Row>
float interpolated(const Row& row, const AxisPosition& x) {
    return row[x.node] * (1.0f - x.share) + row[x.node + 1] * x.share;
}
template <typename Plane>
float interpolated(const Plane& plane, const AxisPosition& y, const AxisPosition& x) {
    return interpolated(plane[y.node], x) * (1.0f - y.share) + interpolated(plane[y.node + 1], x) * y.share;
}

float table_value(const GlassTable& table, float alpha, float cosine, float ior) {
    const AxisPosition n(std::abs(ior - 1.0f) / (ior + 1.0f) / kLargestIndexAxis, kGlassNodes);
    const AxisPosition a(std::sqrt(alpha), kGlassNodes), c(std::sqrt(std::max(cosine, 0.0f)), kGlassNodes);
    return interpolated(table[n.node], a, c) * (1.0f - n.share) + interpolated(table[n.node + 1], a, c) * n.share;
}

/// A table for indices above 1, and one for those below.
struct GlassTables {
    GlassTable denser, thinner;

    template <typename Quadrature>
    explicit GlassTables(Quadrature quadrature)
        : denser(glass_table(true, quadrature)), thinner(glass_table(false, quadrature)) {}
    float at(float alpha, float cosine, float ior) const {
        return table_value(ior >= 1.0f ? denser : thinner, alpha, cosine, ior);
    }
};

const GlassTables& glass_tables_of(Masking masking) {
    const auto quadrature = [](Masking kind) {
        return [kind](float alpha, const Vec3f& o, float ior) {
            return glass_quadrature({MicrofacetDistribution::Ggx, alpha, alpha}, o, ior, kind);
        };
    };
    if (masking == Masking::Joint) {
        static const GlassTables joint(quadrature(Masking::Joint));
        return joint;
    }
    static const GlassTables separate(quadrature(Masking::Separate));
    return separate;
}

float rise_quadrature(float alpha, const Vec3f& o, float ior) {
    const Microfacets facets{MicrofacetDistribution::Ggx, alpha, alpha};
    return reflection_quadrature(facets, o, Masking::Joint, ior) / reflection_quadrature(facets, o, Masking::Joint);
}

}  // namespace

float ggx_reflection_albedo(float alpha, float cosine, Masking masking) {
    return interpolated(reflection_table_of(masking), AxisPosition(std::sqrt(alpha), kNodes),
                        AxisPosition(std::sqrt(cosine), kNodes));
}

float ggx_mean_albedo(float alpha) {
    static const std::array<float, kNodes> means = mean_table();
    return interpolated(means, AxisPosition(std::sqrt(alpha), kNodes));
}

float even_alpha(float alpha_x, float alpha_y) {
    const float x = std::min(alpha_x, 1.0f), y = std::min(alpha_y, 1.0f);
    return x == y ? x : std::sqrt(0.5f * (x * x + y * y));
}

float ggx_glass_albedo(float alpha, float cosine, float ior, Masking masking) {
    if (std::abs(ior - 1.0f) < kLeastIndexStep) return 1.0f;
    return glass_tables_of(masking).at(alpha, cosine, ior);
}

float ggx_fresnel_rise(float alpha, float cosine, float ior) {
    static const GlassTable table = glass_table(true, rise_quadrature);
    return table_value(table, alpha, cosine, std::max(ior, 1.0f / ior));
}

Color energy_compensation(const Color& color, float albedo) {
    return Color(1.0f) + color * ((1.0f - albedo) / albedo);
}

Color repeated_fresnel(const Color& mean_fresnel, float mean_albedo) {
    return mean_fresnel * mean_albedo / (Color(1.0f) - mean_fresnel * (1.0f - mean_albedo));
}

}  // namespace rayleaf
