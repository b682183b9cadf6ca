// Camera rays answered by interpolation in the image plane: no tree, nothing kept between frames.
//
// Idea: the rays of a pinhole camera are a two-dimensional family, so a block of the picture needs 4 samples where a
// cell of the tree needs 16. Blocks of 16 lattice units are quartered, down to 2, until the four corners and the middle
// have one path signature (output_ray.h) and the output direction interpolated in the middle is close to the true one.
// Where they never are, rays are traced.
//
// Blocks lie on an integer lattice of the picture, in tiles of 4 x 4. A tile's contents are a pure function of the
// camera, the object and the tile's integer key: the same bits in any order of requests. Each thread has an ImagePlane
// of its own over the same tracer; two threads that need the same tile compute it twice.
//
// Limitation: anything thinner than a block that lies between its five samples is not seen.
#pragma once

#include "ri_tree/ray_cache.h"
#include "ri_tree/sample_tracer.h"

#include <functional>
#include <memory>
#include <unordered_map>

namespace rayleaf {

struct ImagePlaneSettings {
    /// Largest angle between the interpolated and the true output direction (Simple: normal) in the middle of a block,
    /// radians. Volume: the largest error of the length, as a share of the shape's half extent.
    double angle_threshold = kPi / 180.0;
    /// Largest distance between the interpolated and the true first hit in the middle, as a share of the half extent.
    double distance_threshold = std::numeric_limits<double>::infinity();
};

class ImagePlane {
  public:
    /// The object-space ray through a point of the picture, lattice units.
    using Camera = std::function<Ray(const Vec2d&)>;

    ImagePlane(std::shared_ptr<const SampleTracer> tracer, Camera camera, const ImagePlaneSettings& settings);
    ~ImagePlane();

    /// Answers the camera's rays: object space, unit directions, each with its point in the picture. Fastest where
    /// neighbours follow one another.
    void ask(std::span<const Ray> rays, std::span<const Vec2d> points, std::span<CachedAnswer> answers);
    /// `nodes` counts blocks, `leaves` those that are interpolated.
    RayCacheStatistics statistics() const { return statistics_; }
    const SampleTracer& tracer() const { return *tracer_; }

    static constexpr int kBlock = 16, kTileBlocks = 4, kTile = kBlock * kTileBlocks, kSmallestBlock = 2;

  private:
    struct Leaf;
    struct Tile;
    class TileBuilder;

    std::shared_ptr<const SampleTracer> tracer_;
    Camera camera_;
    ImagePlaneSettings settings_;
    std::unordered_map<uint64_t, std::unique_ptr<const Tile>> tiles_;
    RayCacheStatistics statistics_;

    const Tile& tile_at(int32_t x, int32_t y);
    OutputRay blend(const Leaf& leaf, const Vec2d& point, const Vec3d& direction) const;
    void answer(const Leaf& leaf, const Vec2d& point, const Vec3d& direction, CachedAnswer& out) const;
    void trace(const Ray& object_ray, CachedAnswer& out) const;
    Ray to_local(const Ray& ray) const;
};

}  // namespace rayleaf
