// One render of one scene: tiles over threads, progress, cancel, statistics.
#pragma once

#include "base/cancel.h"
#include "base/random.h"
#include "film/error_blocks.h"
#include "film/film.h"
#include "film/window_sums.h"
#include "integrators/irradiance_cache.h"
#include "integrators/ray_counts.h"
#include "render/curve_statistics.h"
#include "render/left_out.h"
#include "render/ray_caches.h"
#include "scene/description.h"
#include "scene/scene.h"
#include "scene/settings.h"

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <string>

namespace rayleaf {

enum class RenderState { Waiting, Building, Rendering, Done, Cancelled };

struct Progress {
    RenderState state = RenderState::Waiting;
    double share = 0;  ///< of the pixels, 0..1
};

struct RenderStatistics {
    double build_seconds = 0, render_seconds = 0;
    uint64_t pixels = 0, paths = 0;
    RayCounts rays;  ///< of distribution ray tracing
    size_t irradiance_records = 0, irradiance_bytes = 0;
    double irradiance_seconds = 0;  ///< of the render
    TraceStatistics trace;
    TextureStore::Statistics textures;
    bool has_textures = false;
    std::vector<RayCacheReport> ray_caches;
    CurveStatistics curves;
    size_t lights = 0, light_bytes = 0, film_bytes = 0, shape_bytes = 0;
    ShapeShares shapes_of;
    double target_error = 0;     ///< 0: none is set
    double estimated_error = 0;  ///< that noise makes then
    bool light_linking = false;  ///< some lights shine on some objects alone, or have their shadows alone
    size_t volumes = 0;          ///< instances shown by the length of rays inside them
};

class Session {
  public:
    /// Throws InputError for settings out of range. The description is read by `take_scene`.
    /// `ray_caches` keeps ray caches for later renders; null: they end with this one.
    Session(std::shared_ptr<const SceneDescription> description, Settings settings,
            std::shared_ptr<RayCacheStore> ray_caches = nullptr);

    /// Takes what the scene holds now; later additions are not in the picture. Once, while nothing is added to it.
    /// Throws InputError if it was taken before.
    void take_scene();
    /// Commits the scene that was taken and renders it; blocks. False if it was cancelled.
    bool render();
    // The same step by step, for pictures that are looked at while they get better. Each blocks; false if cancelled.
    /// Commits the scene.
    bool build();
    /// One sample for each block of so many pixels along a side.
    bool render_blocks(int size);
    /// The next samples of each pixel.
    bool render_more(int count);
    /// From any thread: `render` returns as soon as the samples in flight are done.
    void cancel() { cancel_.cancel(); }
    Progress progress() const;
    const Film& film() const { return film_; }
    /// The film as film/film.h writes it, with the names of Cryptomatte's ids. Throws InputError that names the path.
    void write_exr(const std::string& path) const;
    /// What the samples add up to; null unless the settings keep it.
    const FilmSums* sums() const { return sums_.get(); }
    const Settings& settings() const { return settings_; }
    /// Complete after `render`; before, what is known so far.
    RenderStatistics statistics() const;

  private:
    std::shared_ptr<const SceneDescription> description_;  ///< a copy once it is taken
    Settings settings_;
    std::shared_ptr<RayCacheStore> ray_caches_;
    Film film_;
    std::unique_ptr<FilmSums> sums_;
    std::unique_ptr<ErrorBlocks> error_;  ///< null: all pixels take all samples
    CancelToken cancel_;
    bool has_taken_scene_ = false;
    std::unique_ptr<Scene> scene_;
    std::unique_ptr<RayCaches> caches_;
    std::unique_ptr<const IrradianceCache> irradiance_;
    std::atomic<RenderState> state_{RenderState::Waiting};  ///< to be shown: publishes nothing else
    std::atomic<uint64_t> finished_paths_{0}, planned_paths_{1};
    mutable std::mutex mutex_;  ///< guards statistics_
    RenderStatistics statistics_;

    int samples_taken_ = 0;                        ///< in rounds so far, where all pixels take all
    std::chrono::steady_clock::time_point began_;  ///< to build
    double build_seconds_ = 0;

    /// In an arena of as many threads as are set; false if cancelled.
    bool run(const std::function<void()>& work);
    void build_scene();
    /// `step`: pixels along a side of the block that a sample stands for.
    void render_tiles(const SampleRange& samples, int step);
    /// Windows of the picture that are rendered together.
    using WindowGroup = std::vector<WindowSamples>;
    void render_groups(const std::vector<WindowGroup>& groups, int step);
    /// The next samples of each pixel, or of what is noisy still.
    void render_round(int count);
    /// All samples, in rounds, as far as error and time ask for them.
    void render_rounds();
    void render_to_goal();
    /// `most`: of a pixel.
    std::vector<WindowGroup> next_to_goal(int most) const;
    int next_round(double seconds_left) const;
    double seconds_left() const;
    /// Null where the settings want none; filled once.
    const IrradianceCache* filled_cache();
    struct Frame;  ///< what all tiles share
    void render_group(const WindowGroup& group, const Frame& frame);
    void store(const WindowSamples& of_film, const Frame& frame, const WindowSums::Sums& sums);
    /// A sample of a pixel.
    struct CameraSample {
        Vec2d middle{0, 0};  ///< of the pixel
        Sampler sampler{0, 0, 0};
        RayCounts* counts = nullptr;  ///< of its window
    };
    /// The first of a pixel, or of the one in the middle of a block.
    CameraSample sample_of(int x, int y, const Frame& frame) const;
    /// Of a sample, in [0,1).
    struct CameraNumbers {
        Vec2f filter{0, 0}, lens{0, 0};
        float time = 0;
    };
    CameraRay camera_ray(const CameraSample& sample, const CameraNumbers& random, const Frame& frame) const;
    template <typename Stream>
    void add_paths(std::span<const CameraSample> samples, const Frame& frame, Stream& stream) const;
    // `counts`: a window's each.
    bool render_paths(const WindowGroup& group, const Frame& frame, WindowSums& sums,
                      std::span<RayCounts> counts) const;
    bool render_streams(const WindowGroup& group, const Frame& frame, WindowSums& sums,
                        std::span<RayCounts> counts) const;
    template <typename Stream>
    bool render_stream(const WindowGroup& group, const Frame& frame, size_t most, Stream& stream, WindowSums& sums,
                       std::span<RayCounts> counts) const;
    bool render_pixel(const CameraSample& pixel, const SampleRange& range, const Frame& frame, WindowSums& sums,
                      RayCounts& counts) const;
    void add_counts(const RayCounts& counts);
    void gather_statistics(double build_seconds, double render_seconds);
    void count_shapes();
};

}  // namespace rayleaf
