// Many threads at once, for the stress tests: they begin together, and the first thing that is wrong ends the program.
#pragma once

#include "geometry/patch_surface.h"

#include <barrier>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <random>
#include <source_location>
#include <thread>
#include <vector>

#include <oneapi/tbb/global_control.h>

namespace rayleaf::stress {

/// Fewer than cores, more, and many more.
inline constexpr int kThreadCounts[] = {2, 5, 16, 64};

inline void require(bool truth, const char* what, const std::source_location& at = std::source_location::current()) {
    if (truth) return;
    std::fprintf(stderr, "%s:%u: %s\n", at.file_name(), static_cast<unsigned>(at.line()), what);
    std::abort();
}

/// Calls `work` with the number of each thread.
template <typename Work>
void run_together(int threads, const Work& work) {
    std::barrier begin(threads);
    std::vector<std::jthread> running;
    for (int thread = 0; thread < threads; ++thread)
        running.emplace_back([&, thread] {
            begin.arrive_and_wait();
            work(thread);
        });
}

/// The threads are the tests' own: the sanitizer does not see how oneTBB's threads wait for one another.
struct NoOtherThreads {
    oneapi::tbb::global_control one{oneapi::tbb::global_control::max_allowed_parallelism, 1};
};

/// A smooth ring of cubic patches, closed and of one piece.
inline std::shared_ptr<const Shape> ring() {
    constexpr int kAround = 8, kAcross = 6;
    NurbsSpline spline;
    NurbsSurface& surface = spline.surface;
    surface.count_u = kAround;
    surface.count_v = kAcross;
    surface.u = surface.v = {4, true, false, false};
    for (int j = 0; j < kAcross; ++j)
        for (int i = 0; i < kAround; ++i) {
            const double a = 2 * kPi * i / kAround, b = 2 * kPi * j / kAcross, out = 1.0 + 0.45 * std::cos(b);
            surface.points.emplace_back(out * std::cos(a), out * std::sin(a), 0.45 * std::sin(b), 1.0);
        }
    return std::make_shared<PatchSurface>("ring", std::vector<NurbsSpline>{spline});
}

/// Rays from around towards the ring, the same each time; beams from narrow to wide.
inline std::vector<Ray> rays_at_ring(int count) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> even(-1.0, 1.0);
    std::vector<Ray> rays;
    for (int i = 0; i < count; ++i) {
        Ray ray;
        ray.origin = Vec3d(3 * even(random), -4, 3 * even(random));
        ray.direction = (Vec3d(1.3 * even(random), 1.3 * even(random), 0.4 * even(random)) - ray.origin).normalized();
        ray.beam = RayBeam::cone(0.0f, static_cast<float>(std::exp2(-4.0 - 10.0 * i / count)));
        rays.push_back(ray);
    }
    return rays;
}

}  // namespace rayleaf::stress
