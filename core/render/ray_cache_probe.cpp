#include "render/ray_cache_probe.h"

#include "base/random.h"
#include "geometry/patch_surface.h"
#include "integrators/dimensions.h"
#include "integrators/path.h"
#include "render/tried_cache.h"
#include "ri_tree/ray_cache_adapter.h"
#include "tessellation/split_plan.h"
#include "trace/local_ray.h"

#include <algorithm>
#include <cstdio>

#include <oneapi/tbb/parallel_for.h>

namespace rayleaf {
namespace {

// Costs in units of one ray traced in a packet to its first hit on facets that stay in memory, from whole frames with
// and without caches. They should be right within about a third: an object whose gain is smaller is traced.
constexpr double kTracedMiss = 0.2;         ///< a ray that enters the box and hits nothing
constexpr double kInterpolatedQuery = 4.0;  ///< leaf found and evaluated
constexpr double kDerivatives = 1.0;        ///< in addition, as paths need them (Scene::needs_differentials)
constexpr double kMissedQuery = 2.0;        ///< leaf found, nothing there
constexpr double kAskedInVain = 5.0;        ///< leaf found, ray to be traced after all, and alone
/// A path through glass or a volume, first hit included.
constexpr double kTracedGlass = 3.0, kTracedVolume = 7.0;
/// A first hit and a path through glass where facets go through the geometry cache.
constexpr double kCachedRay = 5.0, kCachedGlass = 9.0;
/// In addition to a query: where a path goes on that leaves glass.
constexpr double kGlassExit = 5.0;
/// Following a path through a convex body, for which no cell answers.
constexpr double kFollowed = 8.0;
/// A sample is traced with its derivatives, alone, and its cell is judged and stored.
constexpr double kSample = 8.0;
/// Smaller gains than this share of the tracing are ignored, because the costs are not more exact.
constexpr double kLeastGain = 0.1;

constexpr int kBlockSide = 16;       ///< pixels
constexpr int kBlocksPerObject = 3;  ///< that see the object's box
constexpr int kSpreadBlocks = 3;     ///< anywhere, for what is seen in mirrors
constexpr int kMostBlocks = 12;
/// One sample of a pixel is probed for this many of the frame's, since cells are so large that several of the frame's
/// rays cross each; but at most so many.
constexpr int kFrameSamples = 4, kMostSamples = 4;
constexpr int kPlacesTried = 512;  ///< for blocks that see an object
/// At most this share of the frame's paths is probed, each about eight times as costly as others; a frame for which
/// that is less than two blocks is traced.
constexpr double kProbedShare = 1.0 / 1000.0;
/// Lower bound of samples per query, since the blocks are few: that of a smooth surface at 800 x 800 pixels.
constexpr double kLeastSamples = 0.02;
/// Fewer queries than this say nothing.
constexpr uint64_t kLeastQueries = 32;
/// An object is dropped from the probe if the queries of the first blocks cost this many times as much as tracing.
constexpr size_t kFirstBlocks = 2;
constexpr uint64_t kTellingQueries = 256;
constexpr double kHopeless = 1.5;

/// The cost of making the tracer of a cache, by its parts.
constexpr double kSetUpSubpatch = 40.0, kSetUpTriangle = 8.0;
/// In addition, for glass, that of the tables of convex bodies.
constexpr double kSetUpBody = 28000.0;
/// A path with its shading: at least two rays.
constexpr double kPath = 10.0;
/// Making all tried caches may take at most this share of the frame.
constexpr double kSetUpShare = 0.03;

bool skips_glass(const PlannedRayCache& planned) {
    return planned.samples.kind == OutputKind::Glass && !planned.first_hits_only;
}

/// The costs of a ray that meets an object.
struct RayCosts {
    double traced = 1.0, missed = kTracedMiss;
    double interpolated = kInterpolatedQuery, followed = kFollowed;

    RayCosts(const PlannedRayCache& planned, const Scene& scene) {
        const bool is_cached = scene.tracer().goes_through_geometry_cache(planned.instances.front());
        if (is_cached) missed *= kCachedRay;
        if (planned.samples.kind == OutputKind::Volume)
            traced = kTracedVolume;
        else if (skips_glass(planned))
            traced = is_cached ? kCachedGlass : kTracedGlass;
        else if (is_cached)
            traced = kCachedRay;
        const double exit = skips_glass(planned) ? kGlassExit : 0.0;
        interpolated += exit + (scene.needs_differentials() ? kDerivatives : 0.0);
        followed += exit;
    }
    /// Whether a cache that answers every ray is faster by enough.
    bool may_gain() const { return interpolated < (1.0 - kLeastGain) * traced; }
};

/// Queries that tell something about the object.
uint64_t met_box(const RayCacheTotals& totals) {
    return totals.interpolated + totals.followed + totals.traced + totals.missed;
}

/// Points that fill the unit square evenly, however many are taken: the R2 sequence (Roberts 2018).
Vec2d even_point(int index) {
    constexpr double kPlastic = 1.32471795724474602596;
    const double x = 0.5 + index / kPlastic, y = 0.5 + index / (kPlastic * kPlastic);
    return {x - std::floor(x), y - std::floor(y)};
}

struct Block {
    int x, y;  ///< lower left pixel
};

Block block_at(const Vec2d& point, const Settings& settings) {
    const auto place = [](double share, int size) {
        return std::clamp(static_cast<int>(share * size) - kBlockSide / 2, 0, std::max(size - kBlockSide, 0));
    };
    return {place(point.x, settings.width), place(point.y, settings.height)};
}

Ray ray_at(const Scene& scene, const Settings& settings, const Vec2d& point) {
    const Vec2d pixel(point.x * settings.width, point.y * settings.height);
    return scene.camera().ray(pixel, Vec2f(0.5f, 0.5f)).ray;
}

bool meets(const Ray& ray, const Scene& scene, const PlannedRayCache& candidate) {
    return std::any_of(candidate.instances.begin(), candidate.instances.end(), [&](uint32_t instance) {
        const auto inside = inside_box(scene.tracer().bounds(instance), ray.origin, ray.direction);
        return inside && inside->end > 0.0;
    });
}

std::vector<Block> blocks_for(const std::vector<PlannedRayCache>& candidates, const Scene& scene,
                              const Settings& settings, size_t most, const CancelToken& cancel) {
    std::vector<Block> blocks;
    std::vector<int> seen(candidates.size(), 0);
    for (int i = 0; i < kPlacesTried && blocks.size() < most; ++i) {
        cancel.throw_if_cancelled();
        const Vec2d point = even_point(i);
        const Ray ray = ray_at(scene, settings, point);
        bool wanted = i < kSpreadBlocks;
        for (size_t c = 0; c < candidates.size(); ++c) {
            if (seen[c] == kBlocksPerObject || !meets(ray, scene, candidates[c])) continue;
            ++seen[c];
            wanted = true;
        }
        if (wanted) blocks.push_back(block_at(point, settings));
    }
    return blocks;
}

/// A quarter of a block.
void render_quarter(const Block& block, int quarter, const Scene& scene, const Settings& settings, int samples,
                    const CancelToken& cancel) {
    const PixelFilter filter(settings.filter, settings.filter_width);
    const PathSettings path(settings);
    constexpr int kSide = kBlockSide / 2;
    const int left = block.x + kSide * (quarter % 2), below = block.y + kSide * (quarter / 2);
    for (int y = below; y < std::min(below + kSide, settings.height); ++y)
        for (int x = left; x < std::min(left + kSide, settings.width); ++x)
            for (int s = 0; s < samples; ++s) {
                cancel.throw_if_cancelled();
                const auto pixel =
                    static_cast<uint32_t>(y) * static_cast<uint32_t>(settings.width) + static_cast<uint32_t>(x);
                const Sampler sampler(pixel, static_cast<uint32_t>(s), settings.seed);
                const Vec2d place = Vec2d(x + 0.5, y + 0.5) + filter.offset(sampler.get2(kFilterDimension));
                RayCounts uncounted;
                trace_path(scene, path, scene.camera().ray(place, sampler.get2(kLensDimension)), sampler, uncounted);
            }
}

double set_up_cost(const PlannedRayCache& candidate) {
    const Shape& shape = *candidate.shape;
    if (shape.kind() != ShapeKind::PatchSurface) return kSetUpTriangle * shape.element_count();
    const double tolerance = candidate.samples.facet_tolerance;
    const SplitPlan plan(static_cast<const PatchSurface&>(shape), [&](const Box3d&) { return tolerance; });
    const double body = candidate.samples.kind == OutputKind::Glass ? kSetUpBody : 0.0;
    return kSetUpSubpatch * plan.subpatch_count() + body;
}

/// Chooses the objects to try: first those that the most camera rays may meet relative to the cost of making their
/// cache, until the sum is too much for the frame.
std::vector<bool> worth_a_try(const std::vector<PlannedRayCache>& candidates, const Scene& scene,
                              const Settings& settings, double paths, const CancelToken& cancel) {
    std::vector<double> cost(candidates.size()), rank(candidates.size(), 0.0);
    for (int i = 0; i < kPlacesTried; ++i) {
        cancel.throw_if_cancelled();
        const Ray ray = ray_at(scene, settings, even_point(i));
        for (size_t c = 0; c < candidates.size(); ++c) rank[c] += meets(ray, scene, candidates[c]) ? 1.0 : 0.0;
    }
    std::vector<size_t> order;
    for (size_t c = 0; c < candidates.size(); ++c) {
        cancel.throw_if_cancelled();
        const RayCosts costs(candidates[c], scene);
        if (!costs.may_gain()) continue;
        cost[c] = set_up_cost(candidates[c]);
        rank[c] *= costs.traced / std::max(cost[c], 1.0);
        order.push_back(c);
    }
    std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return rank[a] > rank[b]; });
    double left = kSetUpShare * kPath * paths;
    std::vector<bool> tried(candidates.size(), false);
    for (const size_t c : order) {
        left -= cost[c];
        if (left < 0.0) break;
        tried[c] = true;
    }
    return tried;
}

struct Judgement {
    ProbeResult result;
    double ratio = 0;  ///< cost of asking over that of tracing
};

/// Samples taken for all blocks, and for the first quarter of each.
///
/// A square block of side L meets (L / l + 1)^2 square cells of side l, those at its border with its neighbours. So the
/// root of the samples grows evenly with L, and twice what it grows from half the side to the whole is the root of what
/// the block would cost without a border, as a part of a large picture.
struct BlockSamples {
    double blocks = 0, quarters = 0;
};

/// `growth`: how many times as many samples of each pixel the frame has. Up to kFrameSamples they cross the same cells;
/// beyond, mostly the same ones: the number of new samples grows with the root.
Judgement judge(const RayCacheStatistics& statistics, const BlockSamples& taken, const PlannedRayCache& planned,
                const Scene& scene, double growth) {
    const RayCacheTotals counts = totals_of(statistics);
    const uint64_t queries = met_box(counts);
    if (queries < kLeastQueries) return {{false, "the probe met too few rays", nullptr}, 0.0};
    const RayCosts costs(planned, scene);
    const double roots = 2.0 * (std::sqrt(taken.blocks) - std::sqrt(taken.quarters));
    const double shared = std::min(growth, double{kFrameSamples});
    const double samples =
        std::max(roots * roots / (shared * std::sqrt(growth / shared)), kLeastSamples * static_cast<double>(queries));
    const auto followed = static_cast<double>(counts.followed);
    const double hits = static_cast<double>(counts.interpolated) + followed + static_cast<double>(counts.traced);
    const auto missed = static_cast<double>(counts.missed);
    const double tracing = hits * costs.traced + missed * costs.missed;
    const double asking = static_cast<double>(counts.interpolated) * costs.interpolated + followed * costs.followed +
                          static_cast<double>(counts.traced) * (costs.traced + kAskedInVain) + missed * kMissedQuery +
                          samples * kSample;
    const auto percent = [&](double part) { return 100.0 * part / static_cast<double>(queries); };
    char text[160];
    std::snprintf(
        text, sizeof text,
        "probe: %llu queries, %.0f %% interpolated, %.0f %% traced, %.2f samples a query; costs %.2f of tracing",
        static_cast<unsigned long long>(queries), percent(static_cast<double>(counts.interpolated)),
        percent(static_cast<double>(counts.traced)), samples / static_cast<double>(queries), asking / tracing);
    return {{asking < (1.0 - kLeastGain) * tracing, text, nullptr}, asking / tracing};
}

/// A candidate that is tried.
struct Trial {
    size_t candidate = 0;
    std::shared_ptr<FastTree> tree;  ///< empty
    std::shared_ptr<TriedCache> asked;
    RayCacheStatistics counts;  ///< answers and samples of all blocks so far
    BlockSamples taken;
    bool dropped = false;
};

class Probe {
  public:
    Probe(const std::vector<PlannedRayCache>& candidates, Scene& scene, const Settings& settings,
          double neighbour_scale, const CancelToken& cancel)
        : candidates_(candidates),
          scene_(scene),
          settings_(settings),
          neighbour_scale_(neighbour_scale),
          cancel_(cancel),
          samples_(std::clamp(settings.samples / kFrameSamples, 1, kMostSamples)),
          results_(candidates.size(), {false, "the picture has too few rays", nullptr}) {}

    std::vector<ProbeResult> run();

  private:
    const std::vector<PlannedRayCache>& candidates_;
    Scene& scene_;
    const Settings& settings_;
    double neighbour_scale_;
    const CancelToken& cancel_;
    int samples_;
    std::vector<ProbeResult> results_;
    std::vector<Trial> trials_;

    /// The counts of one trial in one block.
    struct BlockCounts {
        RayCacheStatistics counts;
        double quarter = 0;  ///< samples taken for the first quarter
    };
    void choose_trials(double paths);
    void make_trees();
    void give(const Trial& trial, const std::shared_ptr<const RayCacheAdapter>& object);
    std::vector<BlockCounts> render_block(const Block& block) const;
    void render_blocks(std::span<const Block> blocks);
    void judge_trials();
};

void Probe::choose_trials(double paths) {
    const std::vector<bool> tried = worth_a_try(candidates_, scene_, settings_, paths, cancel_);
    for (size_t i = 0; i < candidates_.size(); ++i) {
        if (tried[i])
            trials_.push_back({i, nullptr, nullptr, {}, {}, false});
        else if (!RayCosts(candidates_[i], scene_).may_gain())
            results_[i].reason = "its rays are traced faster than interpolated";
        else
            results_[i].reason = "the picture has too few rays for what a cache of this object takes to make";
    }
}

void Probe::make_trees() {
    oneapi::tbb::parallel_for(size_t{0}, trials_.size(), [&](size_t k) {
        Trial& trial = trials_[k];
        const PlannedRayCache& planned = candidates_[trial.candidate];
        trial.tree =
            std::make_shared<FastTree>(planned.shape, planned.samples, planned.interpolation.thresholds, cancel_);
        trial.asked = std::make_shared<TriedCache>(trial.tree);
    });
    for (const Trial& trial : trials_) {
        const PlannedRayCache& planned = candidates_[trial.candidate];
        give(trial, std::make_shared<const RayCacheAdapter>(0, trial.asked, planned.shape, planned.samples.kind,
                                                            neighbour_scale_, cancel_));
    }
}

void Probe::give(const Trial& trial, const std::shared_ptr<const RayCacheAdapter>& object) {
    scene_.set_ray_cache(candidates_[trial.candidate].instances, object);
}

std::vector<Probe::BlockCounts> Probe::render_block(const Block& block) const {
    std::vector<BlockCounts> result(trials_.size());
    for (const Trial& trial : trials_)
        if (!trial.dropped) trial.asked->begin_block();
    for (int quarter = 0; quarter < 4; ++quarter) {
        render_quarter(block, quarter, scene_, settings_, samples_, cancel_);
        for (size_t k = 0; k < trials_.size() && quarter == 0; ++k)
            result[k].quarter = static_cast<double>(trials_[k].asked->statistics().samples_taken);
    }
    for (size_t k = 0; k < trials_.size(); ++k) {
        result[k].counts = trials_[k].asked->statistics();
        trials_[k].asked->end_block();
    }
    return result;
}

/// Renders blocks on any number of threads; counts are added up in the order of the blocks.
void Probe::render_blocks(std::span<const Block> blocks) {
    std::vector<std::vector<BlockCounts>> counted(blocks.size());
    oneapi::tbb::parallel_for(size_t{0}, blocks.size(), [&](size_t i) { counted[i] = render_block(blocks[i]); });
    for (const std::vector<BlockCounts>& block : counted)
        for (size_t k = 0; k < trials_.size(); ++k) {
            RayCacheStatistics& sum = trials_[k].counts;
            for (size_t kind = 0; kind < kAnswerKinds; ++kind) sum.answers[kind] += block[k].counts.answers[kind];
            trials_[k].taken.blocks += static_cast<double>(block[k].counts.samples_taken);
            trials_[k].taken.quarters += block[k].quarter;
        }
}

void Probe::judge_trials() {
    const double growth = static_cast<double>(settings_.samples) / samples_;
    for (Trial& trial : trials_) {
        if (trial.dropped) continue;
        Judgement judgement = judge(trial.counts, trial.taken, candidates_[trial.candidate], scene_, growth);
        results_[trial.candidate] = std::move(judgement.result);
        trial.dropped = met_box(totals_of(trial.counts)) >= kTellingQueries && judgement.ratio > kHopeless;
        if (trial.dropped) give(trial, nullptr);
    }
}

std::vector<ProbeResult> Probe::run() {
    const double paths = static_cast<double>(settings_.width) * settings_.height * settings_.samples;
    const auto affordable = static_cast<size_t>(kProbedShare * paths / (kBlockSide * kBlockSide * samples_));
    if (candidates_.empty() || affordable < 2) return std::move(results_);
    choose_trials(paths);
    make_trees();
    std::vector<PlannedRayCache> tried;
    for (const Trial& trial : trials_) tried.push_back(candidates_[trial.candidate]);
    const std::vector<Block> blocks =
        blocks_for(tried, scene_, settings_, std::min<size_t>(affordable, kMostBlocks), cancel_);
    const size_t first = std::min(kFirstBlocks, blocks.size());
    render_blocks(std::span(blocks).first(first));
    judge_trials();
    render_blocks(std::span(blocks).subspan(first));
    judge_trials();
    for (const Trial& trial : trials_) {
        give(trial, nullptr);
        if (results_[trial.candidate].pays) results_[trial.candidate].cache = trial.tree;
    }
    return std::move(results_);
}

}  // namespace

std::vector<ProbeResult> probe_ray_caches(const std::vector<PlannedRayCache>& candidates, Scene& scene,
                                          const Settings& settings, double neighbour_scale, const CancelToken& cancel) {
    return Probe(candidates, scene, settings, neighbour_scale, cancel).run();
}

}  // namespace rayleaf
