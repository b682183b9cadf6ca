// The geometry cache while grids of all levels come and go: rays hit what they hit without it.
#include "stress.h"
#include "trace/tracer.h"

#include <algorithm>
#include <numeric>

using namespace rayleaf;

namespace {

struct Case {
    std::shared_ptr<const Shape> shape = stress::ring();
    std::vector<Ray> rays = stress::rays_at_ring(300);

    std::unique_ptr<Tracer> tracer(const GeometryCacheSettings& settings) const {
        DicingView view;
        view.eye = {0, -4, 0};
        return std::make_unique<Tracer>(std::vector<TracedInstance>{{shape, Affine3d(), kVisibleAll}}, view,
                                        kNeverCancelled, settings);
    }
};

void check(const Maybe<Hit>& found, const Maybe<Hit>& wanted) {
    stress::require(found.has_value() == wanted.has_value(), "hit or miss depends on the cache");
    if (!found) return;
    stress::require(found->t == wanted->t && found->local.position == wanted->local.position, "another point");
    stress::require(found->local.normal == wanted->local.normal && found->local.levels == wanted->local.levels,
                    "another facet");
}

void use(const Case& scene, const Tracer& tracer, const std::vector<Maybe<Hit>>& wanted, int thread) {
    std::vector<size_t> order(scene.rays.size());
    std::iota(order.begin(), order.end(), size_t{0});
    std::shuffle(order.begin(), order.end(), std::mt19937(static_cast<uint32_t>(thread)));
    for (const size_t i : order) check(tracer.closest_hit(scene.rays[i], kVisibleCamera), wanted[i]);
    stress::require(tracer.statistics().geometry.bytes > 0 && tracer.thread_misses() < 1'000'000, "statistics");
}

}  // namespace

int main() {
    const stress::NoOtherThreads alone;
    const Case scene;
    GeometryCacheSettings settings;
    settings.mode = CacheMode::None;
    const std::unique_ptr<Tracer> uncached = scene.tracer(settings);
    std::vector<Maybe<Hit>> wanted;
    for (const Ray& ray : scene.rays) wanted.push_back(uncached->closest_hit(ray, kVisibleCamera));
    uint64_t recomputed = 0, parts = 0;
    for (const CacheMode mode : {CacheMode::Multi, CacheMode::Single})
        for (const uint64_t budget : {0, 100'000, 130'000, 180'000, 400'000, 4'000'000})
            for (const int threads : stress::kThreadCounts) {
                settings.mode = mode;
                settings.budget = budget;
                if (mode == CacheMode::Single && threads > 16) continue;
                const std::unique_ptr<Tracer> tracer = scene.tracer(settings);
                const auto& expected = wanted;
                if (mode == CacheMode::Single) {
                    std::vector<Maybe<Hit>> fine;
                    for (const Ray& ray : scene.rays) fine.push_back(tracer->closest_hit(ray, kVisibleCamera));
                    stress::run_together(threads, [&](int thread) { use(scene, *tracer, fine, thread); });
                    continue;
                }
                stress::run_together(threads, [&](int thread) { use(scene, *tracer, expected, thread); });
                const GeometryCacheStatistics told = tracer->statistics().geometry;
                for (const LevelCounters& level : told.levels) recomputed += level.recomputed();
                parts += told.parts.lookups;
            }
    stress::require(recomputed > 1000 && parts > 1000, "nothing was ever forgotten, or nothing ever split");
}
