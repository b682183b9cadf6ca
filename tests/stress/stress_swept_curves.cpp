// Bevelled curves whose surface many threads ask for at once, as the thread in the background and those that wait for
// it do: it is made once, by whoever comes first, and given to the first that takes it.
#include "base/error.h"
#include "geometry/swept_curve_making.h"
#include "geometry/swept_surface.h"
#include "stress.h"

using namespace rayleaf;

namespace {

constexpr int kRounds = 40;

SweptCurveDescription tube() {
    CurveSplines spline;
    spline.type = CurveSplineType::Poly;
    spline.counts = {3};
    spline.points = {Vec4d(0, 0, 0, 1), Vec4d(1, 0.5, 0, 1), Vec4d(2, 0, 1, 1)};
    SweptCurveDescription curve;
    curve.name = "tube";
    curve.splines = {spline};
    curve.bevel_depth = 0.2;
    return curve;
}

/// It names more points than there are.
SweptCurveDescription broken() {
    SweptCurveDescription curve = tube();
    curve.splines[0].counts = {1000};
    return curve;
}

bool is_refused(const SweptCurve& curve) {
    try {
        return curve.borders_cross();
    } catch (const InputError&) {
        return true;
    }
}

}  // namespace

int main() {
    const stress::NoOtherThreads alone;
    const uint32_t elements = SweptSurface(tube()).element_count();
    for (const int threads : stress::kThreadCounts) {
        for (int round = 0; round < kRounds; ++round) {
            const SweptCurve curve(tube()), wrong(broken());
            stress::run_together(threads, [&](int thread) {
                const bool first = thread % 2 == 0;
                if (first) stress::require(is_refused(wrong), "a broken curve has a surface");
                stress::require(!curve.borders_cross(), "there are no borders");
                if (!first) stress::require(is_refused(wrong), "a broken curve has a surface");
            });
            const std::shared_ptr<SweptSurface> taken = curve.surface(), other = curve.surface();
            stress::require(taken != other, "two got one surface");
            stress::require(taken->element_count() == elements && other->element_count() == elements,
                            "another surface");
        }
    }
}
