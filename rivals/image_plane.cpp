#include "rivals/image_plane.h"

#include "base/error.h"

#include <limits>

namespace rayleaf {
namespace {

constexpr int kLattice = ImagePlane::kTile + 1;  ///< points along a tile's side
constexpr int kCells = ImagePlane::kTile / ImagePlane::kSmallestBlock;
constexpr uint16_t kTracedCell = 0xffff;
constexpr double kFarthestPoint = 1e9;  ///< lattice units: tiles are numbered by 32 bits

using Attributes = std::array<float, kMostAttributes>;

struct LatticeSample {
    Vec3d direction{0, 0, 0};
    OutputRay output;  ///< local space
    Attributes attributes{};
};

/// A blend of unit vectors, normalized again.
Vec3d unit_or_same(const Vec3d& v) {
    const double square = v.dot(v);
    return square > 0.0 ? v * (1.0 / std::sqrt(square)) : v;
}

}  // namespace

/// A block whose four corners are blended: c0 + x c1 + y (c2 + x c3), with x and y in [0, 1] over the block.
struct ImagePlane::Leaf {
    std::array<Attributes, 4> coefficients{};
    SampleClass sample_class;
    Vec2d corner{0, 0};
    double inverse_size = 0, error = 0;
};

struct ImagePlane::Tile {
    std::array<uint16_t, size_t{kCells} * kCells> leaf_of;  ///< by cell of 2 x 2 lattice units
    std::vector<Leaf> leaves;
};

/// Samples of a tile and their blocks, while it is made.
class ImagePlane::TileBuilder {
  public:
    TileBuilder(const ImagePlane& plane, int32_t x, int32_t y)
        : plane_(plane), origin_(double{kTile} * x, double{kTile} * y) {
        sample_of_.fill(kTracedCell);
        tile_->leaf_of.fill(kTracedCell);
        samples_.reserve(128);
        for (int block = 0; block < kTileBlocks * kTileBlocks; ++block)
            build(kBlock * (block % kTileBlocks), kBlock * (block / kTileBlocks), kBlock);
    }

    std::unique_ptr<const Tile> take() { return std::move(tile_); }
    size_t samples_taken() const { return samples_.size(); }
    uint64_t blocks() const { return blocks_; }

  private:
    const ImagePlane& plane_;
    Vec2d origin_;
    std::unique_ptr<Tile> tile_ = std::make_unique<Tile>();
    std::array<uint16_t, size_t{kLattice} * kLattice> sample_of_;
    std::vector<LatticeSample> samples_;
    uint64_t blocks_ = 0;

    uint16_t sample(int x, int y) {
        uint16_t& index = sample_of_[static_cast<size_t>(y) * kLattice + x];
        if (index != kTracedCell) return index;
        index = static_cast<uint16_t>(samples_.size());
        LatticeSample& made = samples_.emplace_back();
        const Ray ray = plane_.to_local(plane_.camera_(origin_ + Vec2d(x, y)));
        if (is_ray(ray)) made.output = plane_.tracer_->trace(ray);
        made.direction = ray.direction;
        store_attributes(plane_.tracer_->settings().kind, made.output, made.attributes);
        return index;
    }

    void build(int x, int y, int size) {
        ++blocks_;
        const int half = size / 2;
        const std::array<uint16_t, 4> corners = {sample(x, y), sample(x + size, y), sample(x, y + size),
                                                 sample(x + size, y + size)};
        const uint16_t middle = sample(x + half, y + half);
        if (is_uniform(corners, middle)) {
            Leaf leaf = blend(corners, x, y, size);
            leaf.error = error_at(leaf, middle);
            if (leaf.error <= 1.0) {
                add_leaf(leaf, x, y, size);
                return;
            }
        }
        if (size == kSmallestBlock) return;
        for (int part = 0; part < 4; ++part) build(x + half * (part % 2), y + half * (part / 2), half);
    }

    bool is_uniform(const std::array<uint16_t, 4>& corners, uint16_t middle) const {
        const SampleClass& first = samples_[middle].output.sample_class;
        if (first.is_faceted()) return false;
        return std::all_of(corners.begin(), corners.end(),
                           [&](uint16_t corner) { return samples_[corner].output.sample_class == first; });
    }

    Leaf blend(const std::array<uint16_t, 4>& corners, int x, int y, int size) const {
        Leaf leaf;
        leaf.sample_class = samples_[corners[0]].output.sample_class;
        leaf.corner = origin_ + Vec2d(x, y);
        leaf.inverse_size = 1.0 / size;
        const Attributes &a = samples_[corners[0]].attributes, &b = samples_[corners[1]].attributes;
        const Attributes &c = samples_[corners[2]].attributes, &d = samples_[corners[3]].attributes;
        for (size_t i = 0; i < a.size(); ++i) {
            leaf.coefficients[0][i] = a[i];
            leaf.coefficients[1][i] = b[i] - a[i];
            leaf.coefficients[2][i] = c[i] - a[i];
            leaf.coefficients[3][i] = d[i] - c[i] - b[i] + a[i];
        }
        return leaf;
    }

    /// The error in the middle of a block, as a multiple of the allowed error.
    double error_at(const Leaf& leaf, uint16_t middle) const {
        if (leaf.sample_class.is_miss()) return 0.0;
        const OutputRay& truth = samples_[middle].output;
        const Vec2d point = leaf.corner + Vec2d(0.5, 0.5) / leaf.inverse_size;
        const ImagePlaneSettings& settings = plane_.settings_;
        const OutputRay blended = plane_.blend(leaf, point, samples_[middle].direction);
        const double half_extent = 0.5 * max_component(Vec3d(plane_.tracer_->shape().bounds().size()));
        if (plane_.tracer_->settings().kind == OutputKind::Volume)
            return std::abs(blended.length - truth.length) / (settings.angle_threshold * half_extent);
        const double chord = (blended.exit_direction - truth.exit_direction).length();
        const double angle = 2.0 * std::asin(std::min(1.0, 0.5 * chord));
        const double distance = (blended.position - truth.position).length();
        return std::max(angle / settings.angle_threshold, distance / (settings.distance_threshold * half_extent));
    }

    void add_leaf(const Leaf& leaf, int x, int y, int size) {
        const auto index = static_cast<uint16_t>(tile_->leaves.size());
        tile_->leaves.push_back(leaf);
        for (int j = y / kSmallestBlock; j < (y + size) / kSmallestBlock; ++j) {
            for (int i = x / kSmallestBlock; i < (x + size) / kSmallestBlock; ++i)
                tile_->leaf_of[static_cast<size_t>(j) * kCells + i] = index;
        }
    }
};

ImagePlane::ImagePlane(std::shared_ptr<const SampleTracer> tracer, Camera camera, const ImagePlaneSettings& settings)
    : tracer_(std::move(tracer)), camera_(std::move(camera)), settings_(settings) {
    const auto require_positive = [&](const char* argument, double value) {
        if (!(value > 0.0)) throw InputError(tracer_->shape().name(), argument, number_text(value), "a number above 0");
    };
    require_positive("angle_threshold", settings.angle_threshold);
    require_positive("distance_threshold", settings.distance_threshold);
}

ImagePlane::~ImagePlane() = default;

Ray ImagePlane::to_local(const Ray& ray) const {
    const LocalFrame& frame = tracer_->shape().frame();
    Ray local;
    local.origin = (ray.origin - frame.center) / frame.scale;
    local.direction = normalized_or(ray.direction, Vec3d(0, 0, 0));
    return local;
}

const ImagePlane::Tile& ImagePlane::tile_at(int32_t x, int32_t y) {
    const uint64_t key = uint64_t{static_cast<uint32_t>(y)} << 32 | static_cast<uint32_t>(x);
    std::unique_ptr<const Tile>& tile = tiles_[key];
    if (!tile) {
        TileBuilder builder(*this, x, y);
        tile = builder.take();
        statistics_.samples_taken += builder.samples_taken();
        statistics_.nodes += builder.blocks();
        statistics_.leaves += tile->leaves.size();
        statistics_.bytes += sizeof(Tile) + tile->leaves.size() * sizeof(Leaf);
        statistics_.most_bytes = statistics_.bytes;
    }
    return *tile;
}

/// The answer of a leaf whose rays hit; local space, like the unit `direction`.
OutputRay ImagePlane::blend(const Leaf& leaf, const Vec2d& point, const Vec3d& direction) const {
    const auto x = static_cast<float>((point.x - leaf.corner.x) * leaf.inverse_size);
    const auto y = static_cast<float>((point.y - leaf.corner.y) * leaf.inverse_size);
    const auto& [c0, c1, c2, c3] = leaf.coefficients;
    Attributes sums;
    for (size_t i = 0; i < sums.size(); ++i) sums[i] = c0[i] + x * c1[i] + y * (c2[i] + x * c3[i]);
    const auto vector = [&](size_t first) { return Vec3d(sums[first], sums[first + 1], sums[first + 2]); };
    OutputRay out;
    out.sample_class = leaf.sample_class;
    const OutputKind kind = tracer_->settings().kind;
    if (kind == OutputKind::Volume) {
        out.length = double{sums[0]};
        return out;
    }
    out.position = out.exit_position = vector(0);
    out.normal = unit_or_same(vector(3));
    if (kind == OutputKind::Mirror) {
        out.exit_direction = mirrored(direction, out.normal);
    } else if (kind == OutputKind::Glass) {
        out.exit_position = vector(6);
        out.exit_direction = unit_or_same(vector(9));
    } else {
        out.uv = Vec2d(sums[6], sums[7]);
        out.exit_direction = out.normal;
    }
    return out;
}

void ImagePlane::answer(const Leaf& leaf, const Vec2d& point, const Vec3d& direction, CachedAnswer& out) const {
    const bool missed = leaf.sample_class.is_miss();
    out.output = missed ? OutputRay{} : blend(leaf, point, direction);
    out.by = missed ? AnsweredBy::CellMissed : AnsweredBy::Interpolated;
    out.error = leaf.error * settings_.angle_threshold;
}

void ImagePlane::trace(const Ray& object_ray, CachedAnswer& out) const {
    const Ray ray = to_local(object_ray);
    const bool traced = is_ray(ray);
    out.output = traced ? tracer_->trace(ray) : OutputRay{};
    out.by = traced ? AnsweredBy::TracedManyClasses : AnsweredBy::NotARay;
    out.error = 0.0;
}

void ImagePlane::ask(std::span<const Ray> rays, std::span<const Vec2d> points, std::span<CachedAnswer> answers) {
    const LocalFrame& frame = tracer_->shape().frame();
    const OutputKind kind = tracer_->settings().kind;
    const Tile* tile = nullptr;
    int32_t tile_x = 0, tile_y = 0;
    for (size_t i = 0; i < points.size(); ++i) {
        const Vec2d& point = points[i];
        uint16_t leaf = kTracedCell;
        if (std::abs(point.x) < kFarthestPoint && std::abs(point.y) < kFarthestPoint) {  // not so for NaN
            const auto x = static_cast<int32_t>(std::floor(point.x / kTile));
            const auto y = static_cast<int32_t>(std::floor(point.y / kTile));
            if (!tile || x != tile_x || y != tile_y) tile = &tile_at(x, y);
            tile_x = x;
            tile_y = y;
            const auto cell_of = [](double t) { return std::min(static_cast<int>(t / kSmallestBlock), kCells - 1); };
            leaf = tile->leaf_of[static_cast<size_t>(cell_of(point.y - double{kTile} * y)) * kCells +
                                 cell_of(point.x - double{kTile} * x)];
        }
        CachedAnswer& out = answers[i];
        if (leaf == kTracedCell)
            trace(rays[i], out);
        else
            answer(tile->leaves[leaf], point, rays[i].direction, out);
        ++statistics_.answers[static_cast<size_t>(out.by)];
        if (out.output.sample_class.is_miss()) continue;
        out.output.length *= frame.scale;
        if (kind == OutputKind::Volume) continue;
        out.output.position = out.output.position * frame.scale + frame.center;
        out.output.exit_position = out.output.exit_position * frame.scale + frame.center;
    }
}

}  // namespace rayleaf
