#include "geometry/limit_faces.h"

#include "base/error.h"
#include "geometry/face_limit.h"

#include <algorithm>
#include <map>

#include <oneapi/tbb/parallel_for.h>
#include <opensubdiv/bfr/parameterization.h>
#include <opensubdiv/far/topologyDescriptor.h>
#include <opensubdiv/far/topologyRefinerFactory.h>

namespace rayleaf {
namespace {

namespace Bfr = OpenSubdiv::Bfr;
namespace Far = OpenSubdiv::Far;
namespace Sdc = OpenSubdiv::Sdc;

using Descriptor = Far::TopologyDescriptor;

/// Texture coordinates of one vertex closer than this are equal (Blender's STD_UV_CONNECT_LIMIT).
constexpr float kSameUv = 1e-4f;

Sdc::Options::FVarLinearInterpolation linear_where(UvSmoothing smoothing) {
    switch (smoothing) {
        case UvSmoothing::None:
            return Sdc::Options::FVAR_LINEAR_ALL;
        case UvSmoothing::KeepCorners:
            return Sdc::Options::FVAR_LINEAR_CORNERS_ONLY;
        case UvSmoothing::KeepCornersJunctions:
            return Sdc::Options::FVAR_LINEAR_CORNERS_PLUS1;
        case UvSmoothing::KeepCornersJunctionsConcave:
            return Sdc::Options::FVAR_LINEAR_CORNERS_PLUS2;
        case UvSmoothing::KeepBoundaries:
            return Sdc::Options::FVAR_LINEAR_BOUNDARIES;
        case UvSmoothing::All:
            break;
    }
    return Sdc::Options::FVAR_LINEAR_NONE;
}

Sdc::Options options_of(const SubdivisionCage& cage) {
    Sdc::Options options;
    options.SetVtxBoundaryInterpolation(cage.border_corners == BorderCorners::Sharp
                                            ? Sdc::Options::VTX_BOUNDARY_EDGE_AND_CORNER
                                            : Sdc::Options::VTX_BOUNDARY_EDGE_ONLY);
    options.SetCreasingMethod(Sdc::Options::CREASE_UNIFORM);
    options.SetFVarLinearInterpolation(linear_where(cage.uv_smoothing));
    return options;
}

Sdc::SchemeType scheme_of(const SubdivisionCage& cage) {
    return cage.scheme == SubdivisionScheme::Bilinear ? Sdc::SCHEME_BILINEAR : Sdc::SCHEME_CATMARK;
}

std::vector<float> limited_sharpness(std::span<const float> values) {
    std::vector<float> result(values.begin(), values.end());
    for (float& value : result) value = std::min(value, kInfiniteSharpness);
    return result;
}

/// The distinct texture coordinates of a map, and the index of each corner's.
struct UvValues {
    std::vector<Vec3d> values;
    std::vector<int> of_corner;
};

/// Whether a face's corners go round counterclockwise on the map.
bool is_counterclockwise(const CornerAttribute& map, size_t first, size_t size) {
    const auto uv = [&](size_t i) {
        const float* at = &map.values[(first + i % size) * static_cast<size_t>(map.channels)];
        return Vec2d(at[0], at[1]);
    };
    double area = 0.0;
    for (size_t i = 0; i < size; ++i) area += uv(i).cross(uv(i + 1));
    return area > 0.0;
}

/// Corners of a vertex are joined where the map has them at one place and their faces go round alike. So a map that is
/// folded, as of a mesh that was mirrored, has a border where it is (as in Blender).
UvValues merged_uv(const SubdivisionCage& cage, const CornerAttribute& map) {
    struct Known {
        int index;
        bool counterclockwise;
    };
    UvValues result;
    result.of_corner.reserve(cage.corners.size());
    std::vector<std::vector<Known>> of_vertex(cage.vertices.size() / 3);  // so far
    for (const int32_t face_size : cage.face_sizes) {
        const auto size = static_cast<size_t>(face_size);
        const size_t first = result.of_corner.size();
        const bool counterclockwise = is_counterclockwise(map, first, size);
        for (size_t corner = first; corner < first + size; ++corner) {
            const float* uv = &map.values[corner * static_cast<size_t>(map.channels)];
            std::vector<Known>& known = of_vertex[static_cast<size_t>(cage.corners[corner])];
            const auto found = std::ranges::find_if(known, [&](const Known& each) {
                const Vec3d& other = result.values[static_cast<size_t>(each.index)];
                return each.counterclockwise == counterclockwise && std::abs(other.x - uv[0]) < kSameUv &&
                       std::abs(other.y - uv[1]) < kSameUv;
            });
            if (found != known.end()) {
                result.of_corner.push_back(found->index);
                continue;
            }
            known.push_back({static_cast<int>(result.values.size()), counterclockwise});
            result.of_corner.push_back(known.back().index);
            result.values.emplace_back(uv[0], uv[1], 0.0);
        }
    }
    return result;
}

/// Creases on edges of faces only: OpenSubdiv reports others on the error stream.
struct Creases {
    std::vector<int> vertices;
    std::vector<float> sharpness;

    explicit Creases(const SubdivisionCage& cage) {
        if (cage.crease_sharpness.empty()) return;
        const auto key = [](int a, int b) { return std::pair(std::min(a, b), std::max(a, b)); };
        std::map<std::pair<int, int>, float> wanted;
        const std::vector<float> limited = limited_sharpness(cage.crease_sharpness);
        for (size_t i = 0; i < limited.size(); ++i)
            wanted[key(cage.crease_edges[2 * i], cage.crease_edges[2 * i + 1])] = limited[i];
        size_t first = 0;
        for (const int32_t size : cage.face_sizes) {
            for (int32_t i = 0; i < size; ++i) {
                const auto found = wanted.find(key(cage.corners[first + static_cast<size_t>(i)],
                                                   cage.corners[first + static_cast<size_t>((i + 1) % size)]));
                if (found == wanted.end()) continue;
                vertices.push_back(found->first.first);
                vertices.push_back(found->first.second);
                sharpness.push_back(found->second);
                wanted.erase(found);
            }
            first += static_cast<size_t>(size);
        }
    }
};

}  // namespace

struct LimitFaces::Faces {
    std::vector<FaceLimit> faces;
};

LimitFaces::LimitFaces() = default;
LimitFaces::~LimitFaces() = default;
LimitFaces::LimitFaces(LimitFaces&&) noexcept = default;
LimitFaces& LimitFaces::operator=(LimitFaces&&) noexcept = default;

bool LimitFaces::is_regular(uint32_t face) const {
    return faces_->faces[face].is_regular();
}

PatchPoint LimitFaces::evaluate(uint32_t face, const Vec2d& parameters) const {
    return faces_->faces[face].evaluate(parameters);
}

Vec3d LimitFaces::position(uint32_t face, const Vec2d& parameters) const {
    return faces_->faces[face].position(parameters);
}

void LimitFaces::positions(uint32_t face, std::span<const Vec2d> parameters, Vec3d* positions) const {
    faces_->faces[face].positions(parameters, positions);
}

void LimitFaces::forget(uint32_t face) {
    faces_->faces[face] = {};
}

size_t LimitFaces::bytes() const {
    size_t total =
        sizeof(*this) + sizeof(Faces) + (faces_->faces.capacity() - faces_->faces.size()) * sizeof(FaceLimit);
    for (const FaceLimit& face : faces_->faces) total += face.bytes();
    return total;
}

struct CageTopology::Refiner {
    std::string name;
    std::unique_ptr<Far::TopologyRefiner> refiner;
    std::vector<std::vector<Vec3d>> uv_values;  ///< by map

    const Far::TopologyLevel& cage() const { return refiner->GetLevel(0); }
    /// Of vertices, or of a face-varying channel.
    LimitFaces limit_of(const std::vector<Vec3d>& values, int channel) const;
};

LimitFaces CageTopology::Refiner::limit_of(const std::vector<Vec3d>& values, int channel) const {
    LimitFaces result;
    result.faces_ = std::make_unique<LimitFaces::Faces>();
    std::vector<FaceLimit>& faces = result.faces_->faces;
    faces.resize(static_cast<size_t>(cage().GetNumFaces()));
    const FaceLimitMaker maker(*refiner, channel, values);
    tbb::parallel_for(size_t{0}, faces.size(), [&](size_t i) {
        std::optional<FaceLimit> face = maker(static_cast<int>(i));
        if (!face)
            throw InputError(name, "face " + std::to_string(i), "one without a limit surface", "another topology");
        faces[i] = std::move(*face);
    });
    return result;
}

CageTopology::CageTopology(const SubdivisionCage& cage) : refiner_(std::make_unique<Refiner>()) {
    refiner_->name = cage.name;
    Descriptor descriptor;
    descriptor.numVertices = static_cast<int>(cage.vertices.size() / 3);
    descriptor.numFaces = static_cast<int>(cage.face_sizes.size());
    descriptor.numVertsPerFace = cage.face_sizes.data();
    descriptor.vertIndicesPerFace = cage.corners.data();
    const Creases creases(cage);
    descriptor.numCreases = static_cast<int>(creases.sharpness.size());
    descriptor.creaseVertexIndexPairs = creases.vertices.data();
    descriptor.creaseWeights = creases.sharpness.data();
    const std::vector<float> sharpness = limited_sharpness(cage.vertex_sharpness);
    descriptor.numCorners = static_cast<int>(sharpness.size());
    descriptor.cornerVertexIndices = cage.crease_vertices.data();
    descriptor.cornerWeights = sharpness.data();

    std::vector<UvValues> maps;
    std::vector<Descriptor::FVarChannel> channels;
    for (const CornerAttribute& map : cage.uv_maps) maps.push_back(merged_uv(cage, map));
    for (UvValues& map : maps) {
        Descriptor::FVarChannel channel;
        channel.numValues = static_cast<int>(map.values.size());
        channel.valueIndices = map.of_corner.data();
        channels.push_back(channel);
        refiner_->uv_values.push_back(std::move(map.values));
    }
    descriptor.numFVarChannels = static_cast<int>(channels.size());
    descriptor.fvarChannels = channels.data();

    using RefinerFactory = Far::TopologyRefinerFactory<Descriptor>;
    refiner_->refiner.reset(
        RefinerFactory::Create(descriptor, RefinerFactory::Options(scheme_of(cage), options_of(cage))));
    if (!refiner_->refiner)
        throw InputError(cage.name, "corners", "faces that OpenSubdiv cannot connect", "another topology");
}

CageTopology::~CageTopology() = default;

uint32_t CageTopology::edge_count() const {
    return static_cast<uint32_t>(refiner_->cage().GetNumEdges());
}

std::array<uint32_t, 2> CageTopology::edge_vertices(uint32_t edge) const {
    const Far::ConstIndexArray vertices = refiner_->cage().GetEdgeVertices(static_cast<int>(edge));
    return {static_cast<uint32_t>(vertices[0]), static_cast<uint32_t>(vertices[1])};
}

uint32_t CageTopology::face_edge(uint32_t face, uint32_t corner) const {
    return static_cast<uint32_t>(refiner_->cage().GetFaceEdges(static_cast<int>(face))[static_cast<int>(corner)]);
}

std::vector<uint32_t> CageTopology::edge_faces(uint32_t edge) const {
    const Far::ConstIndexArray faces = refiner_->cage().GetEdgeFaces(static_cast<int>(edge));
    return {faces.begin(), faces.end()};
}

LimitFaces CageTopology::limit(const std::vector<Vec3d>& vertices) const {
    return refiner_->limit_of(vertices, kOfVertices);
}

LimitFaces CageTopology::uv_limit(size_t map) const {
    return refiner_->limit_of(refiner_->uv_values[map], static_cast<int>(map));
}

FaceSquare CageTopology::corner_square(int face_size, int corner) {
    const Bfr::Parameterization parameters(Sdc::SCHEME_CATMARK, face_size);  // the bilinear scheme has the same
    const auto vertex = [&](int index) {
        double uv[2];
        parameters.GetVertexCoord(index % face_size, uv);
        return Vec2d(uv[0], uv[1]);
    };
    FaceSquare square;
    square.origin = vertex(corner);
    if (parameters.HasSubFaces()) {
        square.next = Vec2d(0.5, 0.0);
        square.previous = Vec2d(0.0, 0.5);
    } else {
        square.next = (vertex(corner + 1) - square.origin) * 0.5;
        square.previous = (vertex(corner + face_size - 1) - square.origin) * 0.5;
    }
    return square;
}

}  // namespace rayleaf
