#include "geometry/face_cage.h"

#include "base/assert.h"

#include <algorithm>
#include <map>

#include <opensubdiv/far/primvarRefiner.h>
#include <opensubdiv/far/topologyDescriptor.h>
#include <opensubdiv/far/topologyRefinerFactory.h>

namespace rayleaf {
namespace {

namespace Far = OpenSubdiv::Far;
using FaceDescriptor = Far::TopologyDescriptor;
using Level = FaceCage::Level;

/// A value in the form that OpenSubdiv interpolates.
struct WeightedValue {
    Vec3d value{0, 0, 0};

    void Clear() { value = Vec3d(0.0); }
    void AddWithWeight(const WeightedValue& other, double weight) { value += other.value * weight; }
};

/// Maps the numbers of a larger mesh to consecutive ones, in the order of their first use.
class Numbers {
  public:
    int operator[](int old) {
        const auto [found, is_new] = of_.try_emplace(old, static_cast<int>(of_.size()));
        if (is_new) olds_.push_back(old);
        return found->second;
    }
    const std::vector<int>& olds() const { return olds_; }

  private:
    std::map<int, int> of_;
    std::vector<int> olds_;
};

/// The face first, then all others that have one of its corners.
std::vector<int> faces_around(const Level& level, int face) {
    std::vector<int> result{face};
    for (const int vertex : level.GetFaceVertices(face))
        for (const int other : level.GetVertexFaces(vertex))
            if (std::find(result.begin(), result.end(), other) == result.end()) result.push_back(other);
    return result;
}

/// Some faces of a level, renumbered, in the form that OpenSubdiv reads.
struct Cut {
    std::vector<int> face_sizes, corners, creases, sharp_vertices, value_numbers;
    std::vector<float> crease_sharpness, vertex_sharpness;
    std::vector<int> values;  ///< their numbers in the level

    Cut(const Level& level, const std::vector<int>& faces, int channel);
    std::shared_ptr<const FaceCage::Refiner> refiner(const FaceCage::Refiner& like) const;

  private:
    int vertices_ = 0;
};

Cut::Cut(const Level& level, const std::vector<int>& faces, int channel) {
    Numbers vertices, numbers, edges;
    for (const int face : faces) {
        const Far::ConstIndexArray of_face = level.GetFaceVertices(face);
        face_sizes.push_back(of_face.size());
        for (const int vertex : of_face) corners.push_back(vertices[vertex]);
        for (const int edge : level.GetFaceEdges(face)) edges[edge];
        if (channel != kOfVertices)
            for (const int value : level.GetFaceFVarValues(face, channel)) value_numbers.push_back(numbers[value]);
    }
    for (const int edge : edges.olds()) {
        if (level.GetEdgeSharpness(edge) <= 0.0f) continue;
        crease_sharpness.push_back(level.GetEdgeSharpness(edge));
        for (const int vertex : level.GetEdgeVertices(edge)) creases.push_back(vertices[vertex]);
    }
    for (const int vertex : vertices.olds()) {
        if (level.GetVertexSharpness(vertex) <= 0.0f) continue;
        vertex_sharpness.push_back(level.GetVertexSharpness(vertex));
        sharp_vertices.push_back(vertices[vertex]);
    }
    vertices_ = static_cast<int>(vertices.olds().size());
    values = channel == kOfVertices ? vertices.olds() : numbers.olds();
}

std::shared_ptr<const FaceCage::Refiner> Cut::refiner(const FaceCage::Refiner& like) const {
    FaceDescriptor descriptor;
    descriptor.numVertices = vertices_;
    descriptor.numFaces = static_cast<int>(face_sizes.size());
    descriptor.numVertsPerFace = face_sizes.data();
    descriptor.vertIndicesPerFace = corners.data();
    descriptor.numCreases = static_cast<int>(crease_sharpness.size());
    descriptor.creaseVertexIndexPairs = creases.data();
    descriptor.creaseWeights = crease_sharpness.data();
    descriptor.numCorners = static_cast<int>(vertex_sharpness.size());
    descriptor.cornerVertexIndices = sharp_vertices.data();
    descriptor.cornerWeights = vertex_sharpness.data();
    FaceDescriptor::FVarChannel numbered;
    numbered.numValues = static_cast<int>(values.size());
    numbered.valueIndices = value_numbers.data();
    descriptor.numFVarChannels = value_numbers.empty() ? 0 : 1;
    descriptor.fvarChannels = &numbered;
    using Factory = Far::TopologyRefinerFactory<FaceDescriptor>;
    std::unique_ptr<FaceCage::Refiner> result(
        Factory::Create(descriptor, Factory::Options(like.GetSchemeType(), like.GetSchemeOptions())));
    if (!result) throw InternalError("OpenSubdiv cannot connect a part of what it could connect");
    FaceCage::Refiner::UniformOptions once(1);
    once.fullTopologyInLastLevel = true;
    result->RefineUniform(once);
    return result;
}

}  // namespace

FaceCage::FaceCage(const Refiner& mesh, int level, int face, int channel, std::span<const Vec3d> values) {
    const Level of_mesh = mesh.GetLevel(level);
    const Cut cut(of_mesh, faces_around(of_mesh, face), channel);
    refiner_ = cut.refiner(mesh);
    for (const int number : cut.values) values_.push_back(values[static_cast<size_t>(number)]);
    if (channel != kOfVertices) channel_ = 0;
}

const Vec3d& FaceCage::value(int corner) const {
    const Level level = refiner_->GetLevel(0);
    const Far::ConstIndexArray numbers =
        channel_ == kOfVertices ? level.GetFaceVertices(0) : level.GetFaceFVarValues(0, channel_);
    return values_[static_cast<size_t>(numbers[corner])];
}

std::vector<FaceCage> FaceCage::refined() const {
    const Level finer = refiner_->GetLevel(1);
    const int count = channel_ == kOfVertices ? finer.GetNumVertices() : finer.GetNumFVarValues(channel_);
    std::vector<WeightedValue> coarse, fine(static_cast<size_t>(count));
    for (const Vec3d& value : values_) coarse.push_back({value});
    const Far::PrimvarRefinerReal<double> step(*refiner_);
    if (channel_ == kOfVertices)
        step.Interpolate(1, coarse, fine);
    else
        step.InterpolateFaceVarying(1, coarse, fine, channel_);
    std::vector<Vec3d> values;
    for (const WeightedValue& each : fine) values.push_back(each.value);
    std::vector<FaceCage> result;
    for (const int child : refiner_->GetLevel(0).GetFaceChildFaces(0))
        result.emplace_back(*refiner_, 1, child, channel_, values);
    return result;
}

bool is_between_two_faces(const Level& level, int face, int corner) {
    const Far::ConstIndexArray edges = level.GetFaceEdges(face);
    const int sides[] = {edges[corner], edges[(corner + edges.size() - 1) % edges.size()]};
    int others[2];
    for (int i = 0; i < 2; ++i) {
        const Far::ConstIndexArray faces = level.GetEdgeFaces(sides[i]);
        if (faces.size() != 2 || level.IsEdgeNonManifold(sides[i])) return false;
        others[i] = faces[0] == face ? faces[1] : faces[0];
    }
    return others[0] == others[1];
}

bool ends_crease_between_two_faces(const Level& level, int face, int corner, int channel) {
    if (!is_between_two_faces(level, face, corner)) return false;
    const Far::ConstIndexArray edges = level.GetFaceEdges(face);
    const auto is_sharp = [&](int edge) {
        return level.IsEdgeInfSharp(edge) ||
               (channel != kOfVertices && !level.DoesEdgeFVarTopologyMatch(edge, channel));
    };
    return is_sharp(edges[corner]) != is_sharp(edges[(corner + edges.size() - 1) % edges.size()]);
}

}  // namespace rayleaf
