#include "geometry/face_limit.h"

#include "geometry/corner_rings.h"

#include <algorithm>
#include <mutex>
#include <shared_mutex>

#include <opensubdiv/bfr/refinerSurfaceFactory.h>

namespace rayleaf {
namespace {

namespace Bfr = OpenSubdiv::Bfr;
using FaceSurface = Bfr::Surface<double>;
using SharedCache = Bfr::SurfaceFactoryCacheThreaded<std::shared_mutex, std::shared_lock<std::shared_mutex>,
                                                     std::unique_lock<std::shared_mutex>>;

/// The parameters of a part advance twice as fast as those of its face.
constexpr double kPartsAlong = 2.0;

const FaceSurface::PointDescriptor kPoints(3);

double* numbers(Vec3d* points) {
    return &points->x;
}
const double* numbers(const Vec3d* points) {
    return &points->x;
}

/// Corners counter-clockwise from (0, 0).
PatchPoint bilinear(const std::vector<Vec3d>& corners, const Vec2d& at) {
    const Vec3d &a = corners[0], &b = corners[1], &c = corners[2], &d = corners[3];
    const Vec3d low = b - a, high = c - d, twist = high - low;
    return {a + low * at.x + (d - a + twist * at.x) * at.y,
            low + twist * at.y,
            d - a + twist * at.x,
            Vec3d(0.0),
            twist,
            Vec3d(0.0)};
}

/// From parameters of a part to those of its face.
PatchPoint by_face(const PatchPoint& p) {
    constexpr double k = kPartsAlong;
    return {p.position, p.du * k, p.dv * k, p.duu * (k * k), p.duv * (k * k), p.dvv * (k * k)};
}

}  // namespace

FaceLimit::FaceLimit() = default;
FaceLimit::~FaceLimit() = default;
FaceLimit::FaceLimit(FaceLimit&&) noexcept = default;
FaceLimit& FaceLimit::operator=(FaceLimit&&) noexcept = default;

bool FaceLimit::is_regular() const {
    return surface_.IsValid() && surface_.IsRegular() && surface_.GetFaceSize() == 4;
}

FaceLimit::InPart FaceLimit::part_at(const Vec2d& at) const {
    if (parameters_.HasSubFaces()) {
        const double whole[2] = {at.x, at.y};
        double part[2];
        const int index = parameters_.ConvertCoordToNormalizedSubFace(whole, part);
        return {static_cast<size_t>(index), {part[0], part[1]}};
    }
    const bool far_u = at.x >= 0.5, far_v = at.y >= 0.5;
    const size_t part = far_v ? (far_u ? 2 : 3) : (far_u ? 1 : 0);
    return {part, at * kPartsAlong - Vec2d(far_u ? 1.0 : 0.0, far_v ? 1.0 : 0.0)};
}

FaceLimit::InPart FaceLimit::quad_at(const Vec2d& at) const {
    return parameters_.HasSubFaces() ? part_at(at) : InPart{0, at};
}

PatchPoint FaceLimit::evaluate(const Vec2d& parameters) const {
    if (!corners_.empty()) return bilinear(corners_, parameters);
    if (!parts_.empty()) {
        const InPart in = part_at(parameters);
        return by_face(parts_[in.part].evaluate(in.parameters));
    }
    const std::optional<PatchPoint> known = in_quadtree(parameters);
    return known ? *known : by_opensubdiv(parameters);
}

std::optional<PatchPoint> FaceLimit::in_quadtree(const Vec2d& parameters) const {
    if (quadtree_.quad_count() == 0) return std::nullopt;
    const InPart in = quad_at(parameters);
    const std::optional<PatchPoint> p = quadtree_.evaluate(in.part, in.parameters);
    return p && parameters_.HasSubFaces() ? by_face(*p) : p;
}

PatchPoint FaceLimit::by_opensubdiv(const Vec2d& parameters) const {
    PatchPoint p{Vec3d(0.0), Vec3d(0.0), Vec3d(0.0), Vec3d(0.0), Vec3d(0.0), Vec3d(0.0)};
    const double uv[2] = {parameters.x, parameters.y};
    surface_.Evaluate(uv, numbers(points_.data()), kPoints, numbers(&p.position), numbers(&p.du), numbers(&p.dv),
                      numbers(&p.duu), numbers(&p.duv), numbers(&p.dvv));
    return p;
}

Vec3d FaceLimit::position(const Vec2d& parameters) const {
    LimitQuadtree::Walk walk(quadtree_);
    return position(parameters, walk);
}

void FaceLimit::positions(std::span<const Vec2d> parameters, Vec3d* positions) const {
    LimitQuadtree::Walk walk(quadtree_);
    for (size_t i = 0; i < parameters.size(); ++i) positions[i] = position(parameters[i], walk);
}

Vec3d FaceLimit::position(const Vec2d& parameters, LimitQuadtree::Walk& walk) const {
    if (!corners_.empty()) return bilinear(corners_, parameters).position;
    if (!parts_.empty()) {
        const InPart in = part_at(parameters);
        return parts_[in.part].position(in.parameters);
    }
    if (quadtree_.quad_count() > 0) {
        const InPart in = quad_at(parameters);
        if (const std::optional<Vec3d> known = walk.position(in.part, in.parameters)) return *known;
    }
    Vec3d position(0.0);
    const double uv[2] = {parameters.x, parameters.y};
    surface_.Evaluate(uv, numbers(points_.data()), kPoints, numbers(&position));
    return position;
}

size_t FaceLimit::bytes() const {
    size_t total = sizeof(*this) + (points_.capacity() + corners_.capacity()) * sizeof(Vec3d) + quadtree_.bytes();
    for (const FaceLimit& part : parts_) total += part.bytes();
    return total;
}

/// OpenSubdiv's surface factory.
class FaceLimitMaker::Factory : public Bfr::RefinerSurfaceFactory<SharedCache> {
  public:
    enum class Sharing { BetweenFaces, None };

    Factory(const FaceCage::Refiner& mesh, Sharing sharing)
        : Bfr::RefinerSurfaceFactory<SharedCache>(mesh, options(sharing)) {}

    bool init(int face, int channel, std::span<const Vec3d> values, FaceLimit& limit) const {
        FaceSurface& surface = limit.surface_;
        const bool made = channel == kOfVertices ? InitVertexSurface(face, &surface)
                                                 : InitFaceVaryingSurface(face, &surface, FVarID{channel});
        if (!made) return false;
        limit.points_.resize(static_cast<size_t>(surface.GetNumPatchPoints()));
        surface.PreparePatchPoints(numbers(values.data()), kPoints, numbers(limit.points_.data()), kPoints);
        return true;
    }

  private:
    static Options options(Sharing sharing) {
        Options options;
        options.SetApproxLevelSmooth(kApproximationLevels).SetApproxLevelSharp(kSharpLevels);
        return options.EnableCaching(sharing == Sharing::BetweenFaces);
    }
};

FaceLimitMaker::FaceLimitMaker(const FaceCage::Refiner& mesh, int channel, std::span<const Vec3d> values)
    : mesh_(&mesh),
      channel_(channel),
      values_(values),
      factory_(std::make_unique<const Factory>(mesh, Factory::Sharing::BetweenFaces)) {}
FaceLimitMaker::~FaceLimitMaker() = default;

std::optional<FaceLimit> FaceLimitMaker::operator()(int face) const {
    const FaceCage::Level level = mesh_->GetLevel(0);
    if (mesh_->GetSchemeType() == OpenSubdiv::Sdc::SCHEME_CATMARK)
        for (int corner = 0; corner < level.GetFaceVertices(face).size(); ++corner)
            if (is_between_two_faces(level, face, corner))
                return in_parts(FaceCage(*mesh_, 0, face, channel_, values_), 1);
    FaceLimit limit;
    if (!factory_->init(face, channel_, values_, limit)) return std::nullopt;
    if (channel_ == kOfVertices && mesh_->GetSchemeType() == OpenSubdiv::Sdc::SCHEME_CATMARK && !limit.is_regular()) {
        const std::optional<std::vector<CornerRing>> corners = corner_rings(level, face, values_);
        if (corners) limit.quadtree_ = LimitQuadtree(*corners);
        limit.parameters_ = {OpenSubdiv::Sdc::SCHEME_CATMARK, level.GetFaceVertices(face).size()};
    }
    return limit;
}

std::optional<FaceLimit> FaceLimitMaker::in_parts(const FaceCage& cage, int steps) {
    FaceLimit limit;
    for (const FaceCage& part : cage.refined()) {
        std::optional<FaceLimit> of_part = of_cage(part, steps);
        if (!of_part) return std::nullopt;
        limit.parts_.push_back(std::move(*of_part));
    }
    limit.parameters_ = {OpenSubdiv::Sdc::SCHEME_CATMARK, static_cast<int>(limit.parts_.size())};
    return limit;
}

/// The limit of a cage's face, a quad, after `steps` steps of subdivision.
std::optional<FaceLimit> FaceLimitMaker::of_cage(const FaceCage& cage, int steps) {
    FaceLimit limit;
    bool ends = false;
    for (int corner = 0; corner < 4; ++corner)
        ends = ends || ends_crease_between_two_faces(cage.refiner().GetLevel(0), 0, corner, cage.channel());
    if (ends && steps < kMostParts) return in_parts(cage, steps + 1);
    if (ends) {
        for (int corner = 0; corner < 4; ++corner) limit.corners_.push_back(cage.value(corner));
        return limit;
    }
    if (!Factory(cage.refiner(), Factory::Sharing::None).init(0, cage.channel(), cage.values(), limit))
        return std::nullopt;
    return limit;
}

}  // namespace rayleaf
