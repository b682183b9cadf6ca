#include "shading/lobe_hair_facets.h"

#include "base/diagonal_basis.h"
#include "base/random.h"
#include "shading/fresnel.h"
#include "shading/lobe_fibre.h"
#include "shading/microfacet.h"
#include "shading/microfacet_albedo.h"

#include <bit>

namespace rayleaf {
namespace {

/// Of a plane vector that is no longer than 2.
float plane_length(float x, float y) {
    return std::sqrt(x * x + y * y);
}

/// Numbers in [0, 1), as many as are asked for: a function of what was added.
class HashedNumbers {
  public:
    void add(const Vec3f& v) {
        for (const float x : {v.x, v.y, v.z}) key_ = hash_combine(key_, std::bit_cast<uint32_t>(x));
    }
    float next() { return unit_float(hash_combine(key_, count_++)); }
    Vec2f next2() {
        const float x = next();
        return {x, next()};
    }

  private:
    uint32_t key_ = 0, count_ = 0;
};

/// The surface at a point of the cross section. Unit vectors that point to the side light comes from.
struct Surface {
    Vec3f smooth;  ///< of the cylinder
    Vec3f scale;   ///< of the tilted scale on it: facets are distributed around it

    bool faces(const Vec3f& w) const { return w.dot(scale) > 0.0f && w.dot(smooth) > 0.0f; }
    Surface from_inside() const { return {-smooth, -scale}; }
};

/// Where light meets a surface, by which facet, and the share that is reflected there.
struct Interface {
    Surface surface;
    Vec3f from;      ///< unit, to where light comes from
    Vec3f facet;     ///< unit
    float cosine;    ///< of `from` and the scale's normal, positive
    float gain;      ///< gives back the energy that single scattering loses
    float masking;   ///< share of facets that light sees
    float reflects;  ///< Fresnel's
};

/// Beyond a facet of that index over the one on this side; `w` as `Interface::from`. Zero where all is reflected.
Vec3f refracted(const Vec3f& w, const Vec3f& normal, float ior) {
    const float c = w.dot(normal), beyond2 = (ior - 1.0f) * (ior + 1.0f) + c * c;
    if (!(beyond2 > 0.0f)) return Vec3f(0.0f);
    return (normal * (c - std::sqrt(beyond2)) - w) * (1.0f / ior);
}

/// A fibre seen from one direction. Its frame: x the longer axis of the cross section, y along the fibre, z the shorter
/// axis. The longer half axis has length 1.
class FacetedFibre {
  public:
    Vec3f out;        ///< towards the viewer
    float reach;      ///< of the cross section to either side, seen from there
    float low, high;  ///< offsets from the middle that light of this point may have, over `reach`

    FacetedFibre(const Lobe& lobe, const Vec3f& outgoing)
        : lobe_(lobe), facets_{MicrofacetDistribution::Ggx, lobe.alpha_x, lobe.alpha_x}, ratio_(lobe.roughness) {
        make_frame(outgoing);
        out = to_local(outgoing);
        const float across = plane_length(out.x, out.z);
        reach = across > 0.0f ? plane_length(out.z, ratio_ * out.x) / across : 1.0f;
        set_offsets();
        const float tilt = std::clamp(lobe.tilt, -kMostTilt, kMostTilt);
        tilt_ = {std::sin(tilt), std::cos(tilt)};
    }

    Vec3f to_local(const Vec3f& v) const { return {x_.dot(v), y_.dot(v), z_.dot(v)}; }
    Vec3f to_world(const Vec3f& v) const { return x_ * v.x + y_ * v.y + z_ * v.z; }

    /// As many of these offsets as lie close together beside what the facets spread; half of `most` or more.
    int count(int most) const {
        constexpr float kWidth = 0.5f;  // in roughness
        return std::clamp(static_cast<int>((high - low) / (kWidth * lobe_.alpha_x)), (most + 1) / 2, most);
    }
    /// Where a ray from `out` meets the fibre, by the share of the way from `low` to `high`; on the unit circle that
    /// the cross section is stretched to.
    Vec2f entered_at(float share) const {
        constexpr float kMostOffset = 0.999f;  // at the very rim nothing is seen
        const float offset = std::clamp(low + share * (high - low), -kMostOffset, kMostOffset);
        const Vec2f towards = stretched(out);
        const float depth = cosine_of(offset);
        return {towards.x * depth - towards.y * offset, towards.y * depth + towards.x * offset};
    }
    /// Where a ray inside that leaves `at` along `direction` meets the surface again; `length` becomes the way within
    /// the cross section, over the sine of its angle to the fibre.
    Vec2f left_at(const Vec2f& at, const Vec3f& direction, float& length) const {
        const Vec2f along = stretched(direction);
        const float t = -2.0f * (at.x * along.x + at.y * along.y);
        const Vec2f to{at.x + t * along.x, at.y + t * along.y};
        const float flat = plane_length(direction.x, direction.z);
        length = plane_length(to.x - at.x, ratio_ * (to.y - at.y)) / std::max(flat, kLeastSine);
        return to;
    }
    Surface surface_at(const Vec2f& at) const {
        const Vec3f n = normalized_or(Vec3f(ratio_ * at.x, 0.0f, at.y), Vec3f(0.0f, 0.0f, 1.0f));
        return {n, Vec3f(n.x * tilt_.cosine, tilt_.sine, n.z * tilt_.cosine)};
    }

    /// Light from `from` at a surface; `ior` beyond it over this side. False where nothing of it is seen.
    bool meet(const Surface& surface, const Vec3f& from, float ior, const Vec2f& random, Interface& met) const {
        if (!surface.faces(from)) return false;
        met.surface = surface;
        met.from = from;
        met.cosine = from.dot(surface.scale);
        met.gain = gain(met.cosine, ior);
        met.masking = masking(met.cosine);
        Vec3f s, t;
        orthonormal_basis(surface.scale, s, t);
        const Vec3f h = facets_.sample_visible({s.dot(from), t.dot(from), met.cosine}, random);
        met.facet = s * h.x + t * h.y + surface.scale * h.z;
        met.reflects = dielectric_fresnel(from.dot(met.facet), ior);
        return from.dot(met.facet) > 0.0f;
    }
    /// Share of the facets that see `from` which see `towards` as well, on either side of the surface.
    float open(const Interface& at, const Vec3f& towards) const { return open(at.surface, at.masking, towards); }

    /// Density per solid angle times the share that a surface reflects to `towards`, unit; `half` between that and
    /// the viewer.
    float reflected_density(const Surface& surface, const Vec3f& half, const Vec3f& towards) const {
        const float c = out.dot(half), cosine = out.dot(surface.scale);
        if (!surface.faces(out) || !(towards.dot(surface.smooth) > 0.0f) || !(c > 0.0f)) return 0.0f;
        const float facets = normal_density(surface, half) * masking(cosine) * open(surface, masking(cosine), towards);
        return facets / (4.0f * cosine) * dielectric_fresnel(c, lobe_.ior) * gain(cosine, lobe_.ior);
    }
    /// The same of what leaves the fibre by a facet.
    float leaving_density(const Interface& at, const Vec3f& towards) const {
        if (!at.surface.faces(-towards)) return 0.0f;
        const float ior = 1.0f / lobe_.ior;
        const Vec3f sum = at.from + towards * ior;
        const float length2 = sum.length2();
        if (!(length2 > 0.0f)) return 0.0f;
        const Vec3f h = sum * (1.0f / std::sqrt(length2));
        const float in = at.from.dot(h), beyond = -towards.dot(h);
        if (!(in > 0.0f) || !(beyond > 0.0f)) return 0.0f;
        const float facets = normal_density(at.surface, h) * at.masking * open(at, towards) * in / at.cosine;
        return facets * beyond * ior * ior / length2 * (1.0f - dielectric_fresnel(in, ior)) * at.gain;
    }
    Color passed(float length) const {
        return {std::exp(-lobe_.fresnel_0.x * length), std::exp(-lobe_.fresnel_0.y * length),
                std::exp(-lobe_.fresnel_0.z * length)};
    }
    /// Of the distribution that stands for all longer ways.
    float variance() const { return 4.0f * lobe_.alpha_x; }
    SineCosine inclination(const Vec3f& w) const { return {w.y, cosine_of(w.y)}; }
    const Lobe& lobe() const { return lobe_; }

  private:
    static constexpr float kMostTilt = 1.5f, kLeastSine = 1e-6f;

    const Lobe& lobe_;
    Microfacets facets_;
    float ratio_;  ///< of the axes, at most 1
    SineCosine tilt_;
    Vec3f x_, y_, z_;

    /// A round fibre is turned to the viewer.
    void make_frame(const Vec3f& outgoing) {
        y_ = lobe_.tangent;
        const Vec3f wanted = ratio_ < 1.0f ? lobe_.radius : y_.cross(outgoing);
        x_ = normalized_or(wanted - y_ * y_.dot(wanted), Vec3f(0.0f));
        if (x_ == Vec3f(0.0f)) {
            diagonal_basis(y_, z_, x_);
        } else {
            z_ = x_.cross(y_);
        }
    }
    /// Up close, where the fibre is wider than a pixel, that of the point; else all.
    void set_offsets() {
        const bool whole = lobe_.softness >= reach;
        low = whole ? -1.0f : std::clamp(lobe_.across / reach, -1.0f, 1.0f);
        high = whole ? 1.0f : low;
    }
    /// The unit direction in the cross section's plane, where that has been stretched to a circle.
    Vec2f stretched(const Vec3f& v) const {
        const float x = ratio_ * v.x, length = plane_length(x, v.z);
        return length > 0.0f ? Vec2f(x / length, v.z / length) : Vec2f(0.0f, 1.0f);
    }
    float gain(float cosine, float ior) const {
        return 1.0f / ggx_glass_albedo(lobe_.alpha_x, cosine, ior, Masking::Joint);
    }
    float masking(float cosine) const { return facets_.masking(cosine, facets_.even_spread2(cosine)); }
    float open(const Surface& surface, float seen, const Vec3f& towards) const {
        return Microfacets::shadowing(seen, masking(std::abs(surface.scale.dot(towards))), Masking::Joint);
    }
    float normal_density(const Surface& surface, const Vec3f& h) const {
        const float c = h.dot(surface.scale);
        return facets_.normal_density(c, facets_.alpha_x * facets_.alpha_x * std::max(1.0f - c * c, 0.0f));
    }
};

constexpr int kFacetPaths = 4;  ///< R, TT, TRT and all longer ones

/// Light that is followed through a fibre from one offset, by random facets. What could not be met stays false.
struct WayThrough {
    bool enters = false, crosses = false, returns = false;
    Interface first, second, third;
    /// What of the light reaches the interface where the path ends; of the longer paths, what leaves.
    Color reached[kFacetPaths] = {Color(0.0f), Color(0.0f), Color(0.0f), Color(0.0f)};

    WayThrough(const FacetedFibre& fibre, float share, const Vec2f& u1, HashedNumbers& numbers) {
        const Lobe& lobe = fibre.lobe();
        const float ior = lobe.ior, inside_ior = 1.0f / ior;
        const Vec2f at = fibre.entered_at(share);
        enters = fibre.meet(fibre.surface_at(at), fibre.out, ior, u1, first);
        if (!enters) return;
        reached[0] = Color(lobe.refracted.x);
        const Vec3f inside = refracted(fibre.out, first.facet, ior);
        if (is_black(inside) || !first.surface.faces(-inside)) return;
        float length = 0.0f;
        const Vec2f across = fibre.left_at(at, inside, length);
        crosses = fibre.meet(fibre.surface_at(across).from_inside(), -inside, inside_ior, numbers.next2(), second);
        if (!crosses) return;
        const Color once = fibre.passed(length);
        const Color at_second = once * ((1.0f - first.reflects) * first.gain * fibre.open(first, -inside));
        reached[1] = at_second * lobe.refracted.y;

        const Vec3f back = mirrored(second.from, second.facet);
        const Vec2f again = fibre.left_at(across, back, length);
        returns = fibre.meet(fibre.surface_at(again).from_inside(), -back, inside_ior, numbers.next2(), third);
        if (!returns) return;
        const Color twice = fibre.passed(length);
        const Color at_third = at_second * twice * (second.reflects * second.gain * fibre.open(second, back));
        reached[2] = at_third * lobe.refracted.z;
        set_longer(fibre, at_third, once * twice);
    }

  private:
    /// The rest as a geometric series, whose factors are means of those met so far (Chiang et al. 2016).
    void set_longer(const FacetedFibre& fibre, const Color& at_third, const Color& both) {
        constexpr float kLeastPassed = 1e-5f;
        const float leaves = std::max(1.0f - 0.5f * (second.reflects + third.reflects), kLeastPassed);
        const float stays = third.reflects * third.gain * fibre.open(third, mirrored(third.from, third.facet));
        for (int c = 0; c < 3; ++c) {
            const float passed = std::sqrt(both[c]);
            reached[3][c] = at_third[c] * stays * passed * leaves / (1.0f - passed * (1.0f - leaves));
        }
    }
};

/// Seeds by both directions, so that a value is the same each time.
HashedNumbers numbers_of(const Vec3f& a, const Vec3f& b) {
    HashedNumbers numbers;
    numbers.add(a);
    numbers.add(b);
    return numbers;
}

/// What is reflected where it arrives: at few offsets, by no facets but those half way between both directions.
float mean_reflected(const FacetedFibre& fibre, const Vec3f& in, HashedNumbers& numbers) {
    const int count = fibre.low == fibre.high ? 1 : 2 * fibre.count(static_cast<int>(fibre.lobe().alpha_y));
    const Vec3f half = normalized_or(fibre.out + in, Vec3f(0.0f));
    const float offset = numbers.next();
    float sum = 0.0f;
    for (int i = 0; i < count; ++i) {
        const float share = (static_cast<float>(i) + offset) / static_cast<float>(count);
        sum += fibre.reflected_density(fibre.surface_at(fibre.entered_at(share)), half, in);
    }
    return sum / static_cast<float>(count);
}

}  // namespace

LobeValue evaluate_hair_facets(const Lobe& lobe, const Vec3f& outgoing, const Vec3f& incoming) {
    const FacetedFibre fibre(lobe, outgoing);
    const Vec3f in = fibre.to_local(incoming);
    HashedNumbers numbers = numbers_of(outgoing, incoming);
    const int count = fibre.count(static_cast<int>(lobe.alpha_y));
    const float offset = numbers.next();
    Color sum(0.0f), longer(0.0f);
    for (int i = 0; i < count; ++i) {
        const float share = (static_cast<float>(i) + offset) / static_cast<float>(count);
        const Vec2f u = numbers.next2();
        const WayThrough light(fibre, share, u, numbers);
        if (light.crosses) sum += light.reached[1] * fibre.leaving_density(light.second, in);
        if (light.returns) sum += light.reached[2] * fibre.leaving_density(light.third, in);
        longer += light.reached[3];
    }
    if (!is_black(longer)) {
        const SineCosine from = fibre.inclination(fibre.out), to = fibre.inclination(in);
        sum += longer * (longitudinal_density(to, from, fibre.variance()) * 0.5f / kPi);
    }
    sum /= static_cast<float>(count);
    if (lobe.refracted.x > 0.0f) sum += Color(lobe.refracted.x * mean_reflected(fibre, in, numbers));
    return {lobe.weight * sum, kDensityAlone};
}

std::optional<LobeDirection> sample_hair_facets(const Lobe& lobe, const Vec3f& outgoing, const Vec3f& random) {
    const FacetedFibre fibre(lobe, outgoing);
    HashedNumbers numbers = numbers_of(outgoing, random);
    const Vec2f u1{random.z, numbers.next()};
    const WayThrough light(fibre, random.y, u1, numbers);
    if (!light.enters) return std::nullopt;

    // What leaves by the facets that were met.
    Vec3f ways[kFacetPaths] = {Vec3f(0.0f), Vec3f(0.0f), Vec3f(0.0f), Vec3f(0.0f)};
    Color leaves[kFacetPaths] = {Color(0.0f), Color(0.0f), Color(0.0f), light.reached[3]};
    const auto leave = [&](int path, const Interface& by, const Vec3f& way, float share) {
        ways[path] = way;
        leaves[path] = light.reached[path] * (share * by.gain * fibre.open(by, way));
    };
    const Vec3f off = mirrored(fibre.out, light.first.facet);
    if (off.dot(light.first.surface.smooth) > 0.0f) leave(0, light.first, off, light.first.reflects);
    const auto refract = [&](int path, const Interface& by) {
        const Vec3f way = refracted(by.from, by.facet, 1.0f / lobe.ior);
        if (!is_black(way) && by.surface.faces(-way)) leave(path, by, way, 1.0f - by.reflects);
    };
    if (light.crosses) refract(1, light.second);
    if (light.returns) refract(2, light.third);

    float total = 0.0f, energies[kFacetPaths];
    for (int i = 0; i < kFacetPaths; ++i) total += energies[i] = average(leaves[i]);
    if (!(total > 0.0f)) return std::nullopt;
    int path = 0;
    float rest = random.x * total;
    while (path + 1 < kFacetPaths && rest >= energies[path]) rest -= energies[path++];
    if (!(energies[path] > 0.0f)) return std::nullopt;
    if (path == 3) {
        const float u = numbers.next(), turn = numbers.next(), around = 2.0f * kPi * numbers.next();
        const SineCosine to = longitudinal_sample(fibre.inclination(fibre.out), fibre.variance(), u, turn);
        ways[path] = {to.cosine * std::sin(around), to.sine, to.cosine * std::cos(around)};
    }
    LobeDirection result{normalized_or(fibre.to_world(ways[path]), outgoing)};
    result.weight = lobe.weight * leaves[path] * (total / energies[path]);
    result.density = kDensityAlone;
    result.weighed = true;
    return result;
}

Color hair_facets_albedo(const Lobe& lobe, const Vec3f& outgoing) {
    const float sine = std::clamp(lobe.tangent.dot(outgoing), -1.0f, 1.0f);
    const float offset = std::clamp(lobe.across, -1.0f, 1.0f);
    const float cosine = cosine_of(offset) * cosine_of(sine);
    const float reflected = dielectric_fresnel(cosine, lobe.ior), inside = sine / lobe.ior;
    const float beyond = std::sqrt(std::max((lobe.ior - 1.0f) * (lobe.ior + 1.0f) + cosine * cosine, 0.0f)) / lobe.ior;
    const float length = 2.0f * beyond / std::max(1.0f - inside * inside, 1e-6f);
    Color albedo(0.0f);
    for (int c = 0; c < 3; ++c) {
        const float passed = std::exp(-lobe.fresnel_0[c] * length);
        const float rest = 1.0f - reflected * passed;
        albedo[c] = rest > 0.0f ? (passed - 2.0f * reflected * passed + reflected) / rest : 1.0f;
    }
    return lobe.weight * albedo;
}

bool passes_hair_facets(const Lobe& lobe, const Vec3f& outgoing) {
    return std::abs(lobe.across) >= FacetedFibre(lobe, outgoing).reach;
}

}  // namespace rayleaf
