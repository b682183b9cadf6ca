#include "integrators/medium_tracking.h"

#include "integrators/medium_majorants.h"
#include "integrators/medium_weights.h"

namespace rayleaf {
namespace {

/// Null collisions on one segment: beyond these a medium is taken to end.
constexpr int kMostCollisions = 4096;
/// Light dimmer than this share of what it was goes on by chance.
constexpr float kFaint = 0.02f, kFaintSurvival = 0.25f;

/// Length over which light that is emitted evenly gets to the begin of a segment; none where that has no end.
float lit_length(float extinction, double end) {
    const double depth = static_cast<double>(extinction) * end;
    if (depth > 0.0) return static_cast<float>(-std::expm1(-depth) / static_cast<double>(extinction));
    return std::isfinite(end) ? static_cast<float>(end) : 0.0f;
}

/// Optical depth up to the next collision.
double depth_of(float random) {
    return -std::log1p(-static_cast<double>(random));
}

/// Goes from one tentative collision to the next, as many per length as `rate(bounds)` says; `passed(bounds, from,
/// length)` is told of all that lies between; it and `visit(t, bounds)` say whether to go on. `first`: a random number.
template <typename Walk, typename Rate, typename Passed, typename Visit>
void track(Walk walk, double end, float first, RandomStream& random, const Rate& rate, const Passed& passed,
           const Visit& visit) {
    double t = 0.0, left = depth_of(first);
    for (int i = 0; i < kMostCollisions && t < end;) {
        const DensityBounds& bounds = walk.bounds();
        const double border = std::min(walk.end(), end);
        const auto per_length = static_cast<double>(rate(bounds));
        const double depth = per_length > 0.0 ? per_length * (border - t) : 0.0;
        if (!(left < depth)) {
            if (!passed(bounds, t, border - t)) return;
            left -= depth;
            t = border;
            walk.advance();
            continue;
        }
        const double length = left / per_length;
        if (!passed(bounds, t, length)) return;
        t += length;
        if (!visit(t, bounds)) return;
        left = depth_of(random.next());
        ++i;
    }
}

/// Ends faint light by chance; the rest is brighter.
bool stays(Color& light, RandomStream& random) {
    const float largest = max_abs(light);
    if (largest >= kFaint) return true;
    if (!(largest > 0.0f) || random.next() >= kFaintSurvival) {
        light = Color(0.0f);
        return false;
    }
    light /= kFaintSurvival;
    return true;
}

/// What all of it emits.
Color emission_of_even(const MediumSegment& segment, const Closures& closures) {
    Color emission = closures.emission;
    if (is_black(emission)) return Color(0.0f);
    for (int c = 0; c < 3; ++c) emission[c] *= lit_length(closures.medium.extinction[c], segment.end);
    return emission;
}

/// Through the whole of it.
MediumPassage pass_even(const MediumSegment& segment, const Closures& closures) {
    MediumPassage passage;
    passage.emission = emission_of_even(segment, closures);
    passage.weight = exponential(closures.medium.extinction, segment.end);
    return passage;
}

MediumPassage pass_even(const MediumSegment& segment, const Color& throughput, const Vec2f& distance) {
    const Closures closures = segment.at(0.0);
    const Color& extinction = closures.medium.extinction;
    if (!closures.medium.scatters()) return pass_even(segment, closures);
    const Color shares = shares_of(throughput);
    const float chosen = extinction[channel_of(shares, distance.y)];
    const double t = chosen > 0.0f ? -std::log1p(-static_cast<double>(distance.x)) / static_cast<double>(chosen)
                                   : std::numeric_limits<double>::infinity();
    if (!(t < segment.end)) {
        MediumPassage passage = pass_even(segment, closures);
        passage.weight /= shares.dot(passage.weight);
        return passage;
    }
    MediumPassage passage;
    passage.emission = emission_of_even(segment, closures);
    const Color through = exponential(extinction, t);
    passage.weight = through / (shares * extinction).dot(through);
    passage.t = t;
    passage.medium = closures.medium;
    return passage;
}

/// Nothing is scattered, but some is emitted: by what each tentative collision takes.
MediumPassage pass_dimmed(const MediumSegment& segment, float first, RandomStream& random) {
    MediumPassage passage;
    const auto rate = [](const DensityBounds& bounds) { return bounds.majorant; };
    const auto passed = [](const DensityBounds&, double, double) { return true; };
    track(BoundWalk(segment), segment.end, first, random, rate, passed, [&](double t, const DensityBounds& bounds) {
        const Closures closures = limited(segment.at(t), bounds.limit);
        passage.emission += passage.weight * closures.emission / bounds.majorant;
        passage.weight *= (Color(bounds.majorant) - closures.medium.extinction) / bounds.majorant;
        return stays(passage.weight, random);
    });
    return passage;
}

/// Where light is scattered in media that vary. What is certain of them collides by itself, the rest by null collisions
/// (Kutz et al. 2017, decomposition tracking). All that decides whether a path collides, here or there, is one number
/// and the way that this leaves, so even numbers make even decisions.
class VaryingPassage {
  public:
    VaryingPassage(const MediumSegment& segment, const Color& throughput, float decision)
        : segment_(segment), throughput_(throughput), depth_left_(depth_of(decision)) {}

    MediumPassage result(const SegmentBounds& all, float first, RandomStream& random) {
        const auto rate = [](const DensityBounds& bounds) { return bounds.majorant - bounds.certain; };
        const auto passed = [this](const DensityBounds& bounds, double from, double length) {
            return passes(bounds, from, length);
        };
        const auto visit = [&](double t, const DensityBounds& bounds) {
            return meets(t, bounds) && stays(passage_.weight, random);
        };
        track(SegmentBounds::Walk(all), segment_.end, first, random, rate, passed, visit);
        return passage_;
    }

  private:
    const MediumSegment& segment_;
    const Color& throughput_;
    double depth_left_;  ///< up to where it collides
    MediumPassage passage_;

    /// What is certain; false where it collides.
    bool passes(const DensityBounds& bounds, double from, double length) {
        const auto certain = static_cast<double>(bounds.certain);
        if (!(certain > 0.0) || depth_left_ >= certain * length) {
            if (certain > 0.0) depth_left_ -= certain * length;
            return true;
        }
        const double t = from + depth_left_ / certain;
        const Closures closures = limited(segment_.at(t), bounds.limit);
        emit(closures, bounds);
        // Where there is less than was certain, that decides.
        const Color& extinction = closures.medium.extinction;
        for (int c = 0; c < 3; ++c) passage_.weight[c] /= std::max(extinction[c], bounds.certain);
        scatter(t, closures);
        return false;
    }
    /// A tentative collision; false where it is one.
    bool meets(double t, const DensityBounds& bounds) {
        const Closures closures = limited(segment_.at(t), bounds.limit);
        emit(closures, bounds);
        const float rate = bounds.majorant - bounds.certain;
        const Color& extinction = closures.medium.extinction;
        const Color null = Color(bounds.majorant) - extinction;
        if (!closures.medium.scatters()) {
            passage_.weight *= null / rate;
            return true;
        }
        Color more(0.0f);
        for (int c = 0; c < 3; ++c) more[c] = std::max(extinction[c] - bounds.certain, 0.0f);
        const Color shares = shares_of(throughput_ * passage_.weight);
        const float real = shares.dot(more);
        // Where it is denser than its bound, there is less than nothing of the null collision.
        const float other = std::abs(shares.dot(null));
        const float probability = real > 0.0f ? real / (real + other) : 0.0f;
        depth_left_ -= depth_of(probability);
        if (!(depth_left_ < 0.0)) {
            passage_.weight *= null / (rate * (1.0f - probability));
            return true;
        }
        for (int c = 0; c < 3; ++c)
            passage_.weight[c] *= extinction[c] > 0.0f ? more[c] / (extinction[c] * rate * probability) : 0.0f;
        scatter(t, closures);
        return false;
    }
    /// At a collision of any kind.
    void emit(const Closures& closures, const DensityBounds& bounds) {
        passage_.emission += passage_.weight * closures.emission / bounds.majorant;
    }
    void scatter(double t, const Closures& closures) {
        passage_.t = t;
        passage_.medium = closures.medium;
    }
};

/// By the mean of each cell, and by null collisions for how far the medium is from that: residual ratio tracking
/// (Novak et al. 2014).
template <typename Walk>
Color tracked_transmittance(const MediumSegment& segment, const Walk& walk, RandomStream& random) {
    Color residual(1.0f), depth(0.0f);
    const auto rate = [](const DensityBounds& bounds) { return bounds.residual; };
    const auto passed = [&](const DensityBounds& bounds, double /*from*/, double length) {
        if (!is_black(bounds.mean)) depth += bounds.mean * static_cast<float>(length);
        return true;
    };
    track(walk, segment.end, random.next(), random, rate, passed, [&](double t, const DensityBounds& bounds) {
        const Color extinction = limited(segment.at(t), bounds.limit).medium.extinction;
        residual *= Color(1.0f) - (extinction - bounds.mean) / bounds.residual;
        // What is left decides, of all that dims it.
        Color left = residual * exponential(depth, 1.0);
        if (max_abs(left) >= kFaint) return true;
        const bool goes_on = stays(left, random);
        residual = goes_on ? residual / kFaintSurvival : Color(0.0f);
        return goes_on;
    });
    return residual * exponential(depth, 1.0);
}

}  // namespace

Closures MediumSegment::at(double t) const {
    Closures sum;
    const std::span<const SceneMedium* const> all = media.all();
    scene.media().evaluate(*all.front(), ray.at(t), outgoing(), state, sum);
    for (const SceneMedium* medium : all.subspan(1)) {
        Closures more;
        scene.media().evaluate(*medium, ray.at(t), outgoing(), state, more);
        sum.medium.add(more.medium);
        sum.emission += more.emission;
    }
    return sum;
}

Color transmittance(const MediumSegment& segment, RandomStream& random) {
    if (!segment.media.varies()) return exponential(segment.at(0.0).medium.extinction, segment.end);
    return tracked_transmittance(segment, BoundWalk(segment), random);
}

Color transmittance(const MediumSegment& segment, const SegmentBounds& bounds, RandomStream& random) {
    if (!segment.media.varies()) return exponential(segment.at(0.0).medium.extinction, segment.end);
    return tracked_transmittance(segment, SegmentBounds::Walk(bounds), random);
}

MediumPassage pass(const MediumSegment& segment, const SegmentBounds& bounds, const Color& throughput,
                   const Vec2f& distance, RandomStream& random) {
    if (!segment.media.varies()) return pass_even(segment, throughput, distance);
    return VaryingPassage(segment, throughput, distance.x).result(bounds, distance.y, random);
}

MediumPassage pass_unscattered(const MediumSegment& segment, float first, RandomStream& random) {
    if (!segment.media.varies()) return pass_even(segment, segment.at(0.0));
    if (segment.media.emits()) return pass_dimmed(segment, first, random);
    MediumPassage passage;
    passage.weight = tracked_transmittance(segment, BoundWalk(segment), random);
    return passage;
}

}  // namespace rayleaf
