// The fast tree while its cells and samples come and go: answers are those of a tree that forgets nothing.
#include "ri_tree/fast_tree.h"
#include "stress.h"

#include <algorithm>
#include <numeric>

using namespace rayleaf;

namespace {

using Answers = std::vector<CachedAnswer>;

std::unique_ptr<FastTree> tree(OutputKind kind, uint64_t cache_bytes) {
    SampleSettings samples;
    samples.kind = kind;
    samples.facet_tolerance = 0x1p-8;
    RayCacheSettings settings;
    settings.cache_bytes = cache_bytes;
    settings.rays_per_cell = 0;
    settings.depth_limit = settings.mixed_depth_limit = 28;
    settings.distance_threshold = 10;
    settings.direction_threshold = settings.angle_threshold = 4;  // any cell whose samples are of one class
    return std::make_unique<FastTree>(stress::ring(), samples, settings);
}

void check(const CachedAnswer& found, const CachedAnswer& wanted) {
    const OutputRay &a = found.output, &b = wanted.output;
    stress::require(found.by == wanted.by && found.error == wanted.error, "answered otherwise");
    stress::require(a.sample_class == b.sample_class && a.position == b.position && a.normal == b.normal &&
                        a.exit_position == b.exit_position && a.exit_direction == b.exit_direction &&
                        a.length == b.length,
                    "another answer");
}

/// Groups of rays, in another order for each thread.
void use(FastTree& cache, const std::vector<Ray>& rays, const Answers& wanted, int thread) {
    std::vector<size_t> order(rays.size());
    std::iota(order.begin(), order.end(), size_t{0});
    std::shuffle(order.begin(), order.end(), std::mt19937(static_cast<uint32_t>(thread)));
    constexpr size_t kGroup = 24;
    for (size_t first = 0; first < order.size(); first += kGroup) {
        std::vector<Ray> group;
        for (size_t i = first; i < std::min(first + kGroup, order.size()); ++i) group.push_back(rays[order[i]]);
        Answers found(group.size());
        const std::vector<RaySpacing> spacings(group.size());
        static_cast<RayCache&>(cache).ask(group, spacings, found);
        for (size_t i = 0; i < group.size(); ++i) check(found[i], wanted[order[first + i]]);
    }
    stress::require(cache.statistics().samples_taken > 0, "no counts");
}

}  // namespace

int main() {
    const stress::NoOtherThreads alone;
    const std::vector<Ray> rays = stress::rays_at_ring(30);
    for (const OutputKind kind : {OutputKind::Mirror, OutputKind::Glass}) {
        Answers wanted(rays.size());
        static_cast<RayCache&>(*tree(kind, 50'000'000)).ask(rays, std::vector<RaySpacing>(rays.size()), wanted);
        const auto is_interpolated = [](const CachedAnswer& each) { return each.by == AnsweredBy::Interpolated; };
        stress::require(std::count_if(wanted.begin(), wanted.end(), is_interpolated) > 3, "all are traced");
        for (const uint64_t cache_bytes : {0, 100'000, 300'000})
            for (const int threads : {2, 8}) {
                const std::unique_ptr<FastTree> cache = tree(kind, cache_bytes);
                const int shown = cache_bytes == 0 ? 2 : threads;
                stress::run_together(shown, [&](int thread) { use(*cache, rays, wanted, thread); });
                stress::require(cache->statistics().bytes <= cache_bytes, "more memory than allowed");
            }
    }
}
