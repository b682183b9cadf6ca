#include "geometry/swept_curve_making.h"

#include "geometry/swept_surface.h"
#include "splines/outline_crossings.h"

#include <algorithm>
#include <atomic>
#include <future>

#include <oneapi/tbb/task_arena.h>

namespace rayleaf {
namespace {

/// Never destroyed: what is made there may outlive the last scene.
oneapi::tbb::task_arena& background() {
    static auto& arena = *new oneapi::tbb::task_arena;
    return arena;
}

}  // namespace

/// What a curve shares with the thread that makes its surface.
struct SweptCurve::Making {
    SweptCurveDescription description;
    std::atomic<bool> begun{false}, given{false};
    std::promise<std::shared_ptr<SweptSurface>> promise;
    std::shared_future<std::shared_ptr<SweptSurface>> surface = promise.get_future().share();

    explicit Making(SweptCurveDescription of) : description(std::move(of)) {}
    /// By the first thread that gets here.
    void make() {
        if (begun.exchange(true)) return;
        try {
            promise.set_value(std::make_shared<SweptSurface>(description));
        } catch (...) {  // handed to whoever asks
            promise.set_exception(std::current_exception());
        }
    }
    const std::shared_ptr<SweptSurface>& made() {
        make();
        return surface.get();
    }
};

SweptCurve::SweptCurve(SweptCurveDescription description) : making_(std::make_shared<Making>(std::move(description))) {}

SweptCurve::~SweptCurve() {
    making_->begun = true;
}

const SweptCurveDescription& SweptCurve::description() const {
    return making_->description;
}

void SweptCurve::begin() {
    background().enqueue([making = making_] { making->make(); });
}

bool SweptCurve::borders_cross() const {
    const std::vector<SweptFill>& fills = making_->made()->fills();
    return std::any_of(fills.begin(), fills.end(),
                       [](const SweptFill& fill) { return outlines_cross(fill.outlines, fill.begins); });
}

std::shared_ptr<SweptSurface> SweptCurve::surface() const {
    const std::shared_ptr<SweptSurface>& made = making_->made();
    return making_->given.exchange(true) ? std::make_shared<SweptSurface>(description()) : made;
}

}  // namespace rayleaf
