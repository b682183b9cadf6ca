#include "integrators/irradiance_fill.h"

#include "integrators/ambient_occlusion.h"
#include "integrators/branch.h"
#include "integrators/dimensions.h"
#include "integrators/scattered_differential.h"
#include "shading/split_closures.h"

#include <mutex>

#include <oneapi/tbb/parallel_for.h>

namespace rayleaf {
namespace {

/// Pixels between the points of the first pass.
constexpr int kFirstSpacing = 16;
/// How far a record reaches at least, in pixels: no denser than a picture shows.
constexpr float kLeastReach = 1.5f;
/// The largest radius of a record, in pixels: with an error of 0.2 it reaches a dozen of them.
constexpr float kLargestRadius = 60.0f;
/// A record is for all samples of the pixels around: it takes the rays that the samples of one would, within these.
/// (The fewest: Christensen et al. 2003, section 4.6, for a hemisphere without visible noise.)
constexpr int kFewestRays = 256, kMostRays = 4096;
/// Mirrors and refractions dimmer than this are not followed to look for points.
constexpr float kLeastBrightness = 0.05f;
constexpr uint32_t kRecordTag = 0x49524143u;
/// Where more than this share of the points that pixels see are open even near the end, surfaces are too rough to
/// interpolate on: the remaining points sample their own hemispheres, instead of filling memory with unshared records.
constexpr double kMostOpen = 0.75;
constexpr int kLastSpacings = 2;

/// A diffuse point that needs a record.
struct OpenPoint {
    Vertex vertex;          ///< without its closures
    Vec3f normal{0, 0, 1};  ///< unit: the hemisphere's pole
    float pixel = 0;        ///< side of a pixel's footprint there, world units
    Sampler sampler;
};

/// Side of the square as large as a pixel's footprint; at most that of a pixel that faces the point: a curved mirror
/// may spread one over the whole scene, and the camera may see the place as well.
float pixel_side(const Scene& scene, const Vertex& vertex) {
    const DicingView view = scene.camera().dicing_view();
    const double facing = view.pixel_width + view.pixel_angle * (vertex.point.position - view.eye).length();
    const float footprint = std::sqrt(vertex.differential.dp_dx.cross(vertex.differential.dp_dy).length());
    return std::min(footprint, static_cast<float>(facing));
}

class PointFinder {
  public:
    PointFinder(const DistributionFrame& frame, const IrradianceCache& cache) : frame_(frame), cache_(cache) {}

    std::vector<OpenPoint> find(const CameraRay& camera_ray, const Sampler& sampler);
    size_t looked_at() const { return looked_at_; }

  private:
    const DistributionFrame& frame_;
    const IrradianceCache& cache_;
    std::vector<Branch> pending_;
    std::vector<OpenPoint> points_;
    size_t looked_at_ = 0;

    void look(const Branch& branch);
    void add(const Branch& branch, const Vertex& vertex, const Vec3f& normal);
    void push(Branch&& branch) {
        if (max_abs(branch.throughput) >= kLeastBrightness) pending_.push_back(std::move(branch));
    }
};

std::vector<OpenPoint> PointFinder::find(const CameraRay& camera_ray, const Sampler& sampler) {
    pending_.emplace_back(frame_.settings.path, camera_ray, sampler);
    while (!pending_.empty()) {
        const Branch branch = pending_.back();
        pending_.pop_back();
        look(branch);
    }
    return std::move(points_);
}

void PointFinder::look(const Branch& branch) {
    const Tracer& tracer = frame_.scene.tracer();
    Ray ray = branch.ray;
    if (frame_.scene.needs_widths()) set_width(ray, branch.differential);
    const Maybe<Hit> hit = tracer.closest_hit(ray, branch.bounces.ray_kind());
    if (!hit || branch.bounces.is_spent()) return;
    Vertex vertex;
    vertex.point = tracer.surface_point(ray, *hit);
    const Vec3f direction(branch.ray.direction);
    vertex.outgoing = -direction;
    vertex.differential = branch.differential.transferred(direction, hit->t, vertex.point.facet_normal);
    frame_.scene.shade(vertex.point, vertex.outgoing, vertex.differential, branch.bounces.at(hit->t), vertex.closures,
                       {branch.sampler, dimension(branch.vertex, PathDimension::Probe)});
    if (branch.bounces.count() == 0 && frame_.settings.path.wants(Pass::ambient_occlusion))
        add(branch, vertex, facing_normal(vertex));
    push(branch.straight_on(frame_.scene, vertex));
    if (branch.bounces.is_last()) return;
    const SplitClosures lobes(vertex.closures, vertex.outgoing, vertex.point.facet_normal);
    if (hemisphere_brings_light(frame_)) {
        for (int i = 0; i < lobes.diffuse().size(); ++i) {
            const Lobe& lobe = lobes.diffuse()[i];
            add(branch, vertex, lobe.type == LobeType::Translucent ? -lobe.normal : lobe.normal);
        }
        // Light that enters leaves nearby.
        for (int i = 0; i < lobes.subsurface().size(); ++i) add(branch, vertex, lobes.subsurface()[i].normal);
    }
    for (const LobeSample& sample : lobes.singular()) {
        Branch child = branch.scattered(frame_.scene, vertex, vertex.closures, sample, 1);
        child.differential = glossy_differential(vertex.differential, direction, vertex.point, sample, 1);
        push(std::move(child));
    }
}

void PointFinder::add(const Branch& branch, const Vertex& vertex, const Vec3f& normal) {
    for (const OpenPoint& other : points_)
        if (other.vertex.point.position == vertex.point.position && other.normal == normal) return;
    ++looked_at_;
    if (cache_.interpolate(vertex.point.position, normal)) return;
    OpenPoint point{vertex, normal, pixel_side(frame_.scene, vertex),
                    branch.sampler.branch(static_cast<uint32_t>(points_.size()), 1, kRecordTag)};
    point.vertex.closures.clear();
    points_.push_back(std::move(point));
}

class Fill {
  public:
    Fill(const Scene& scene, const Settings& settings, const CancelToken& cancel, RayCounts& counts)
        : scene_(scene),
          settings_(settings),
          distribution_(with_light_passes(settings)),
          frame_{scene, distribution_},
          cancel_(cancel),
          counts_(counts),
          cache_(std::make_unique<IrradianceCache>(settings.irradiance_error)),
          grid_(std::clamp(settings.hemisphere_rays * std::min(settings.samples, kMostRays), kFewestRays, kMostRays)) {}

    std::unique_ptr<IrradianceCache> run() {
        for (int spacing = kFirstSpacing; spacing >= 1; spacing /= 2) {
            const double open = pass(spacing);
            if (spacing <= kLastSpacings && open > kMostOpen) break;
        }
        return std::move(cache_);
    }

  private:
    const Scene& scene_;
    const Settings& settings_;
    DistributionSettings distribution_;
    DistributionFrame frame_;
    const CancelToken& cancel_;
    RayCounts& counts_;
    std::mutex mutex_;  ///< guards counts_
    std::unique_ptr<IrradianceCache> cache_;
    HemisphereGrid grid_;

    /// A record separates direct from indirect light by the passes.
    static DistributionSettings with_light_passes(Settings settings) {
        settings.passes.push_back(Pass::diffuse_direct);
        settings.passes.push_back(Pass::diffuse_indirect);
        return DistributionSettings(settings);
    }

    struct Pixel {
        int x = 0, y = 0;
    };
    std::vector<Pixel> pixels(int spacing) const;
    struct PixelPoints {
        std::vector<OpenPoint> open;
        size_t looked_at = 0;
    };
    PixelPoints points(const Pixel& pixel) const;
    HemisphereRecord sampled(const OpenPoint& point);
    RadiusLimits radius_limits(float pixel) const;
    /// Returns the share of the points seen that were open.
    double pass(int spacing);
};

std::vector<Fill::Pixel> Fill::pixels(int spacing) const {
    const Window part = window(settings_);
    std::vector<Pixel> result;
    const auto first = [spacing](int from) { return (from + spacing - 1) / spacing * spacing; };
    const int before = spacing == kFirstSpacing ? 0 : 2 * spacing;
    for (int y = first(part.y); y < part.y + part.height; y += spacing)
        for (int x = first(part.x); x < part.x + part.width; x += spacing)
            if (before == 0 || x % before != 0 || y % before != 0) result.push_back({x, y});
    return result;
}

Fill::PixelPoints Fill::points(const Pixel& pixel) const {
    const auto number =
        static_cast<uint32_t>(pixel.y) * static_cast<uint32_t>(settings_.width) + static_cast<uint32_t>(pixel.x);
    const CameraRay ray = scene_.camera().ray(Vec2d(pixel.x + 0.5, pixel.y + 0.5), Vec2f(0.5f, 0.5f));
    PointFinder finder(frame_, *cache_);
    std::vector<OpenPoint> open = finder.find(ray, Sampler(number, 0, settings_.seed));
    return {std::move(open), finder.looked_at()};
}

HemisphereRecord Fill::sampled(const OpenPoint& point) {
    RayCounts counts;
    Vec3f tangent, bitangent;
    orthonormal_basis(point.normal, tangent, bitangent);
    const Vertex& vertex = point.vertex;
    std::vector<HemisphereRay> rays(static_cast<size_t>(grid_.size()));
    for (int i = 0; i < grid_.size(); ++i) {
        const uint32_t use = dimension(0, PathDimension::Hemisphere);
        const Sampler sampler =
            point.sampler.branch(static_cast<uint32_t>(i), static_cast<uint32_t>(grid_.size()), kRecordTag);
        const Vec3f local = grid_.direction(i, sampler.get2(use));
        LobeSample sample;
        sample.direction = tangent * local.x + bitangent * local.y + point.normal * local.z;
        sample.weight = Color(1.0f);
        sample.density = local.z / kPi;
        // A shading normal bent from the facet has part of its hemisphere inside the surface.
        const float side = point.normal.dot(vertex.point.facet_normal);
        if (!(sample.direction.dot(vertex.point.facet_normal) * side > 0.0f)) continue;
        Branch ray = Branch(distribution_.path, {}, sampler).scattered(frame_.scene, vertex, {}, sample, 1);
        ray.first_shares[LobeKind::Diffuse] = Color(1.0f);
        ray.differential = hemisphere_differential(vertex.differential, sample.direction, local.z, grid_.size());
        ray.departure.sampling = LightSampling::Alone;
        ray.spread = Spread::One;
        ray.use = RayUse::Hemisphere;
        if (frame_.scene.has_media()) ray.media = media_around(frame_.scene, ray.ray.origin, ray.ray.time);
        rays[static_cast<size_t>(i)] = trace_hemisphere_ray(frame_, ray, counts);
    }
    HemisphereRecord record = make_record(vertex.point.position, point.normal, grid_, rays, radius_limits(point.pixel));
    const std::scoped_lock lock(mutex_);
    counts_ += counts;
    return record;
}

RadiusLimits Fill::radius_limits(float pixel) const {
    RadiusLimits limits{kLeastReach * pixel / settings_.irradiance_error, kLargestRadius * pixel};
    // What is just beyond the occlusion distance comes into it that far on.
    const bool occlusion =
        distribution_.indirect == IndirectLight::AmbientOcclusion || distribution_.path.wants(Pass::ambient_occlusion);
    if (occlusion) limits.most = std::min(limits.most, static_cast<float>(distribution_.path.occlusion_distance));
    limits.most = std::max(limits.most, limits.least);
    return limits;
}

double Fill::pass(int spacing) {
    const std::vector<Pixel> all = pixels(spacing);
    std::vector<PixelPoints> found(all.size());
    oneapi::tbb::parallel_for(size_t{0}, all.size(), [&](size_t i) {
        cancel_.throw_if_cancelled();
        found[i] = points(all[i]);
    });
    std::vector<OpenPoint> open;
    size_t looked_at = 0;
    for (PixelPoints& pixel : found) {
        std::move(pixel.open.begin(), pixel.open.end(), std::back_inserter(open));
        looked_at += pixel.looked_at;
    }
    std::vector<HemisphereRecord> records(open.size());
    oneapi::tbb::parallel_for(size_t{0}, open.size(), [&](size_t i) {
        cancel_.throw_if_cancelled();
        records[i] = sampled(open[i]);
    });
    for (const HemisphereRecord& record : records) cache_->insert(record);
    return looked_at == 0 ? 0.0 : static_cast<double>(open.size()) / static_cast<double>(looked_at);
}

}  // namespace

std::unique_ptr<IrradianceCache> fill_irradiance_cache(const Scene& scene, const Settings& settings,
                                                       const CancelToken& cancel, RayCounts& counts) {
    return Fill(scene, settings, cancel, counts).run();
}

}  // namespace rayleaf
