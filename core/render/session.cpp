#include "render/session.h"

#include "base/error.h"
#include "base/sample_pairs.h"
#include "geometry/displaced_surface.h"
#include "integrators/dimensions.h"
#include "integrators/distribution.h"
#include "integrators/distribution_stream.h"
#include "integrators/irradiance_fill.h"
#include "integrators/path_stream.h"
#include "render/tiles.h"
#include "trace/float_environment.h"

#include <array>
#include <optional>
#include <unordered_set>

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

namespace rayleaf {
namespace {

/// Camera rays that are made together, of three pairs of random numbers each.
constexpr size_t kMostCameraSamples = SamplePairs::kMost / 3;

/// Paths between two looks at the cancel token: well under a frame of a display for any scene.
constexpr int kSamplesPerLook = 4;

/// What noise may leave of a target error beside interpolated rays: squares add up.
const double kNoiseShareBeside = std::sqrt(1.0 - kInterpolationShare * kInterpolationShare);

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// None: all pixels take all samples.
std::optional<ErrorGoal> error_goal(const Settings& settings) {
    using Unit = ErrorGoal::Unit;
    if (settings.target_error > 0.0) return ErrorGoal{Unit::Displayed, settings.target_error, ErrorBlocks::kFirstRound};
    if (settings.noise_threshold > 0.0)
        return ErrorGoal{Unit::CyclesNoise, settings.noise_threshold, least_samples(settings)};
    return std::nullopt;
}

Settings validated(Settings settings) {
    validate(settings);
    return settings;
}

}  // namespace

struct Session::Frame {
    PixelFilter filter;
    PathSettings path;
    DistributionFrame distribution;
    IntegratorKind integrator;
    bool has_lens;  ///< else no ray asks where it passes the lens
    bool has_time;  ///< else nothing moves, and no ray asks when it is
    Footprint footprint;
    int step;  ///< tiles count blocks of so many pixels along a side
};

Session::Session(std::shared_ptr<const SceneDescription> description, Settings settings,
                 std::shared_ptr<RayCacheStore> ray_caches)
    : description_(std::move(description)),
      settings_(validated(std::move(settings))),
      ray_caches_(std::move(ray_caches)),
      film_(part(settings_).width, part(settings_).height, computed_passes(settings_.passes)) {
    settings_.passes = film_.passes();
    if (settings_.keep_sums) sums_ = std::make_unique<FilmSums>(film_.width(), film_.height(), film_.passes());
    if (const auto goal = error_goal(settings_))
        error_ = std::make_unique<ErrorBlocks>(film_.width(), film_.height(), *goal);
}

void Session::take_scene() {
    if (has_taken_scene_) throw InputError("session", "render", "asked for again", "a new session for each picture");
    has_taken_scene_ = true;
    description_ = std::make_shared<const SceneDescription>(*description_);
}

bool Session::run(const std::function<void()>& work) {
    // Before the arena is made, which hands this thread's on to all that work in it.
    const FloatEnvironment environment;
    const int threads = settings_.threads > 0 ? settings_.threads : oneapi::tbb::this_task_arena::max_concurrency();
    // More threads than cores only where their number was set.
    const oneapi::tbb::global_control allow(oneapi::tbb::global_control::max_allowed_parallelism,
                                            static_cast<size_t>(threads));
    oneapi::tbb::task_arena arena(threads);
    try {
        arena.execute(work);
    } catch (const Cancelled&) {  // the token says it too
    }
    if (cancel_.cancelled()) state_ = RenderState::Cancelled;
    return !cancel_.cancelled();
}

bool Session::render() {
    const bool finished = run([this] {
        build_scene();
        const auto start = std::chrono::steady_clock::now();
        if (error_ || settings_.time_limit > 0.0)
            render_rounds();
        else
            render_tiles(sample_range(settings_), 1);
        gather_statistics(build_seconds_, seconds_since(start));
    });
    if (finished) state_ = RenderState::Done;
    return finished;
}

bool Session::build() {
    return run([this] { build_scene(); });
}

bool Session::render_blocks(int size) {
    return run([this, size] {
        if (!scene_) build_scene();
        film_.hold_means();
        render_tiles({0, 1}, size);
    });
}

bool Session::render_more(int count) {
    const auto start = std::chrono::steady_clock::now();
    const bool finished = run([this, count, start] {
        if (!scene_) build_scene();
        finished_paths_ = 0;
        film_.hold_means();
        render_round(count);
        gather_statistics(build_seconds_, seconds_since(start));
    });
    return finished;
}

void Session::build_scene() {
    began_ = std::chrono::steady_clock::now();
    state_ = RenderState::Building;
    scene_ = std::make_unique<Scene>(*description_, settings_, cancel_);
    caches_ = std::make_unique<RayCaches>(*description_, *scene_, settings_, ray_caches_.get(), cancel_);
    if (settings_.target_error > 0.0 && caches_->any_used())
        error_->set_target(settings_.target_error * kNoiseShareBeside);
    build_seconds_ = seconds_since(began_);
    state_ = RenderState::Rendering;
}

void Session::render_tiles(const SampleRange& samples, int step) {
    Window whole = part(settings_);
    whole.width = (whole.width + step - 1) / step;
    whole.height = (whole.height + step - 1) / step;
    std::vector<WindowGroup> groups;
    const int threads = oneapi::tbb::this_task_arena::max_concurrency();
    for (const Window& each : tiles_of(whole, tile_side(whole, samples.count, threads, settings_.tile_size)))
        groups.push_back({{each, samples, samples_taken_}});
    if (samples_taken_ == 0 && step == 1)
        planned_paths_ =
            WindowSamples{whole, settings_.time_limit > 0.0 ? sample_range(settings_) : samples, 0}.paths();
    render_groups(groups, step);
}

void Session::render_groups(const std::vector<WindowGroup>& groups, int step) {
    const DistributionSettings distribution(settings_);
    const Frame frame{PixelFilter(settings_.filter, settings_.filter_width),
                      PathSettings(settings_),
                      {*scene_, distribution, filled_cache()},
                      settings_.integrator,
                      description_->camera()->aperture_radius > 0,
                      scene_->has_motion(),
                      scene_->needs_footprints() ? Footprint::Known : Footprint::Unknown,
                      step};
    oneapi::tbb::parallel_for(
        size_t{0}, groups.size(), [&](size_t i) { render_group(groups[i], frame); }, oneapi::tbb::simple_partitioner());
}

const IrradianceCache* Session::filled_cache() {
    if (settings_.integrator != IntegratorKind::Distribution || !settings_.irradiance_cache) return nullptr;
    if (scene_->has_motion()) return nullptr;  // what it keeps holds for one moment
    if (irradiance_) return irradiance_.get();
    const auto start = std::chrono::steady_clock::now();
    RayCounts counts;
    irradiance_ = fill_irradiance_cache(*scene_, settings_, cancel_, counts);
    add_counts(counts);
    const std::scoped_lock lock(mutex_);
    statistics_.irradiance_records = irradiance_->size();
    statistics_.irradiance_bytes = irradiance_->bytes();
    statistics_.irradiance_seconds = seconds_since(start);
    return irradiance_.get();
}

void Session::render_group(const WindowGroup& group, const Frame& frame) {
    if (cancel_.cancelled()) return;  // before memory is taken for paths
    const bool is_error_asked = error_ && frame.step == 1, shows_mattes = film_.has_mattes() && frame.step == 1;
    const Window whole = part(settings_);
    WindowGroup of_film = group;
    for (WindowSamples& each : of_film) {
        each.window.x -= whole.x;
        each.window.y -= whole.y;
    }
    WindowSums sums(of_film, film_.summed_passes(), {sums_.get(), is_error_asked, shows_mattes, film_.holds_means()});
    std::vector<RayCounts> counts(group.size());  // by window
    // Which pixel caused a tessellation is known for single paths only.
    const bool alone = settings_.stream_paths == 0 || frame.path.wants(Pass::geometry_misses);
    if (!(alone ? render_paths(group, frame, sums, counts) : render_streams(group, frame, sums, counts))) return;
    RayCounts all;
    for (size_t i = 0; i < of_film.size(); ++i) {
        store(of_film[i], frame, sums[i]);
        if (is_error_asked) error_->add_rays(of_film[i], counts[i].sum());
        all += counts[i];
    }
    add_counts(all);
}

/// Puts a window of the film's pixels, or blocks of them, where it belongs.
void Session::store(const WindowSamples& of_film, const Frame& frame, const WindowSums::Sums& sums) {
    const int count = of_film.samples.count, taken = of_film.taken;
    if (frame.step > 1)
        film_.put_blocks(of_film.window, sums.values, frame.step);
    else if (taken == 0)
        film_.put(of_film.window, sums.values);
    else
        film_.refine(of_film.window, sums.values, static_cast<float>(count) / static_cast<float>(taken + count));
    if (film_.has_mattes() && frame.step == 1) film_.add_mattes(of_film.window, count, sums.mattes);
    if (error_ && frame.step == 1) error_->add(of_film, sums.moments);
    finished_paths_ += sums.values.size() * static_cast<uint64_t>(count);
}

/// One path after the other.
bool Session::render_paths(const WindowGroup& group, const Frame& frame, WindowSums& sums,
                           std::span<RayCounts> counts) const {
    return for_each_pixel(group, [&](size_t window, int x, int y) {
        return render_pixel(sample_of(x, y, frame), group[window].samples, frame, sums, counts[window]);
    });
}

bool Session::render_streams(const WindowGroup& group, const Frame& frame, WindowSums& sums,
                             std::span<RayCounts> counts) const {
    size_t paths = 0;
    for (const WindowSamples& each : group) paths += each.paths();
    const size_t most = std::min(static_cast<size_t>(settings_.stream_paths), paths);
    if (frame.integrator == IntegratorKind::Distribution) {
        DistributionStream stream(frame.distribution, cancel_);
        return render_stream(group, frame, std::min(most, DistributionStream::kMost), stream, sums, counts);
    }
    PathStream stream(*scene_, frame.path, most, cancel_);
    return render_stream(group, frame, most, stream, sums, counts);
}

/// The paths of windows, pixel by pixel, at most so many at once.
template <typename Stream>
bool Session::render_stream(const WindowGroup& group, const Frame& frame, size_t most, Stream& stream, WindowSums& sums,
                            std::span<RayCounts> counts) const {
    const auto trace = [&] {
        if (cancel_.cancelled()) return false;
        stream.trace([&](const PixelSample& value) { sums.add(value); });
        return true;
    };
    std::array<CameraSample, kMostCameraSamples> samples;
    size_t count = 0;
    const auto add = [&] {
        add_paths({samples.data(), std::exchange(count, 0)}, frame, stream);
        return stream.size() < most || trace();
    };
    const bool finished = for_each_pixel(group, [&](size_t window, int x, int y) {
        CameraSample pixel = sample_of(x, y, frame);
        pixel.counts = &counts[window];
        const SampleRange& range = group[window].samples;
        for (int i = 0; i < range.count; ++i) {
            samples[count] = pixel;
            samples[count++].sampler = pixel.sampler.of_sample(static_cast<uint32_t>(range.first + i));
            const bool is_full = count == kMostCameraSamples || stream.size() + count == most;
            if (is_full && !add()) return false;
        }
        return true;
    });
    if (!finished || (count > 0 && !add())) return false;
    return stream.size() == 0 || trace();
}

/// Of a pixel, or of the pixel in the middle of a block.
Session::CameraSample Session::sample_of(int x, int y, const Frame& frame) const {
    const Window whole = part(settings_);
    const auto middle = [&](int at, int first, int size) {
        return first + std::min((at - first) * frame.step + frame.step / 2, size - 1);
    };
    const int column = middle(x, whole.x, whole.width), row = middle(y, whole.y, whole.height);
    const uint32_t pixel =
        static_cast<uint32_t>(row) * static_cast<uint32_t>(settings_.width) + static_cast<uint32_t>(column);
    return {Vec2d(column + 0.5, row + 0.5), Sampler(pixel, 0, settings_.seed)};
}

CameraRay Session::camera_ray(const CameraSample& sample, const CameraNumbers& random, const Frame& frame) const {
    const Camera& camera = scene_->camera();
    const Vec2d place = sample.middle + frame.filter.offset(random.filter);
    return camera.ray(place, random.lens, frame.has_time ? camera.time(place, random.time) : kMiddleTime,
                      frame.footprint);
}

/// The paths of up to kMostCameraSamples samples.
template <typename Stream>
void Session::add_paths(std::span<const CameraSample> samples, const Frame& frame, Stream& stream) const {
    SamplePairs pairs;
    for (const CameraSample& sample : samples) {
        pairs.add(sample.sampler, kFilterDimension);
        if (frame.has_lens) pairs.add(sample.sampler, kLensDimension);
        if (frame.has_time) pairs.add(sample.sampler, kTimeDimension);
    }
    pairs.compute();
    size_t pair = 0;
    for (const CameraSample& sample : samples) {
        CameraNumbers random{pairs.pair(pair++)};
        if (frame.has_lens) random.lens = pairs.pair(pair++);
        if (frame.has_time) random.time = pairs.pair(pair++).x;
        stream.add(camera_ray(sample, random, frame), sample.sampler, *sample.counts);
    }
}

void Session::add_counts(const RayCounts& counts) {
    const std::scoped_lock lock(mutex_);
    statistics_.rays += counts;
}

bool Session::render_pixel(const CameraSample& pixel, const SampleRange& range, const Frame& frame, WindowSums& sums,
                           RayCounts& counts) const {
    SampleExtras extras;
    SampleExtras* const wanted_extras = frame.path.has_extras() ? &extras : nullptr;
    for (int s = 0; s < range.count; ++s) {
        if (s % kSamplesPerLook == 0 && cancel_.cancelled()) return false;
        const Sampler sampler = pixel.sampler.of_sample(static_cast<uint32_t>(range.first + s));
        CameraNumbers random{sampler.get2(kFilterDimension)};
        if (frame.has_lens) random.lens = sampler.get2(kLensDimension);
        if (frame.has_time) random.time = sampler.get2(kTimeDimension).x;
        const CameraRay ray = camera_ray({pixel.middle, sampler}, random, frame);
        const uint64_t misses = frame.path.wants(Pass::geometry_misses) ? scene_->tracer().thread_misses() : 0;
        PixelSample value = frame.integrator == IntegratorKind::Distribution
                                ? trace_distributed(frame.distribution, ray, sampler, counts, wanted_extras)
                                : trace_path(*scene_, frame.path, ray, sampler, counts, wanted_extras);
        if (frame.path.wants(Pass::geometry_misses))
            value[Pass::geometry_misses].x = static_cast<float>(scene_->tracer().thread_misses() - misses);
        sums.add(value);
    }
    return true;
}

void Session::write_exr(const std::string& path) const {
    std::map<std::string, std::string> attributes;
    for (const auto& [kind, layer] : kMatteLayers)
        if (film_.has(matte_pass(kind, 0))) attributes.merge(description_->matte_attributes(kind, layer));
    rayleaf::write_exr(film_, path, attributes);
}

Progress Session::progress() const {
    return {state_, std::min(static_cast<double>(finished_paths_) / static_cast<double>(planned_paths_), 1.0)};
}

void Session::gather_statistics(double build_seconds, double render_seconds) {
    const std::scoped_lock lock(mutex_);
    statistics_.build_seconds = build_seconds;
    statistics_.render_seconds = render_seconds;
    statistics_.pixels = static_cast<uint64_t>(film_.width()) * static_cast<uint64_t>(film_.height());
    statistics_.paths = finished_paths_;
    statistics_.trace = scene_->tracer().statistics();
    statistics_.has_textures = scene_->textures() != nullptr;
    if (scene_->textures()) statistics_.textures = scene_->textures()->statistics();
    statistics_.lights = scene_->lights().count();
    statistics_.light_bytes = scene_->lights().bytes();
    statistics_.film_bytes = film_.bytes() + (sums_ ? sums_->bytes() : 0) + (error_ ? error_->bytes() : 0);
    statistics_.target_error = settings_.target_error;
    statistics_.estimated_error = error_ ? error_->error() : 0;
    statistics_.ray_caches = caches_->report();
    statistics_.light_linking = scene_->has_light_linking();
    statistics_.volumes = scene_->volumes().size();
    count_shapes();
}

void Session::count_shapes() {
    std::unordered_set<const Shape*> seen;
    const auto count = [&](const Shape& shape, size_t bytes) {
        if (!seen.insert(&shape).second) return;
        ShapeShare& share = statistics_.shapes_of[static_cast<size_t>(shape.kind())];
        ++share.shapes;
        share.bytes += bytes;
        statistics_.shape_bytes += bytes;
        statistics_.curves.add(shape);
    };
    for (const auto& shape : description_->shapes) count(*shape, shape->bytes());
    const Tracer& tracer = scene_->tracer();
    for (uint32_t i = 0; i < description_->instances.size();
         ++i) {  // what materials displaced stands above one of those
        const Shape& shape = *tracer.instance(i).shape;
        if (shape.kind() == ShapeKind::DisplacedSurface) count(shape, sizeof(DisplacedSurface));
    }
}

RenderStatistics Session::statistics() const {
    const std::scoped_lock lock(mutex_);
    return statistics_;
}

}  // namespace rayleaf
