#include "geometry/vdb_file.h"
#include "geometry/volume_grids.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "scene/cell_detail.h"

#include <map>

namespace rayleaf {
namespace {

constexpr std::pair<const char*, DensityUnit> kDensityUnits[] = {{"WORLD", DensityUnit::World},
                                                                 {"OBJECT", DensityUnit::Object}};

constexpr std::pair<const char*, VolumeBody> kVolumeBodies[] = {
    {"BLOCKS", VolumeBody::Blocks}, {"BOX", VolumeBody::Box}, {"NARROW_BOX", VolumeBody::NarrowBox}};
constexpr std::pair<const char*, ValuePlace> kValuePlaces[] = {{"MIDDLE", ValuePlace::Middle},
                                                               {"CORNER", ValuePlace::Corner}};
constexpr std::pair<const char*, ValueMixing> kValueMixings[] = {{"TRILINEAR", ValueMixing::Trilinear},
                                                                 {"STOCHASTIC", ValueMixing::Stochastic}};

/// Python sees nothing that could change a grid.
using SharedGrid = std::shared_ptr<VoxelGrid>;

SharedGrid make_dense(const std::string& object, const std::string& name, const Array<float>& values,
                      const Array<double>& to_object, float least, const std::string& mixing) {
    check_shape(object, "values", values, {-1, -1, -1, -1});
    DenseVoxels voxels;
    voxels.name = name;
    const auto length = [&](py::ssize_t axis) { return static_cast<int>(values.shape(axis)); };
    voxels.size = {length(2), length(1), length(0)};
    voxels.channels = length(3);
    voxels.values = span_of(values);
    voxels.to_object = affine_of(object, to_object);
    voxels.least = least;
    voxels.rules.mixing = named(object, "mixing", mixing, kValueMixings);
    return dense_grid(object, voxels);
}

/// Reading a large file takes seconds; Python goes on meanwhile.
std::map<std::string, SharedGrid> read_file(const std::string& object, const std::string& path,
                                            const std::vector<std::string>& names, const std::string& value_place,
                                            const std::string& mixing, float least) {
    const VdbReading reading{
        {named(object, "place of values", value_place, kValuePlaces), named(object, "mixing", mixing, kValueMixings)},
        least};
    const py::gil_scoped_release released;
    std::map<std::string, SharedGrid> grids;
    for (const auto& [name, grid] : read_vdb(object, path, names, reading))
        grids[name] = std::const_pointer_cast<VoxelGrid>(grid);
    return grids;
}

std::shared_ptr<Shape> make_volume(const std::string& name, const std::map<int, SharedGrid>& grids,
                                   const std::string& unit, const std::string& body) {
    VolumeGrids volume{
        {}, named(name, "density unit", unit, kDensityUnits), named(name, "body", body, kVolumeBodies), {}};
    for (const auto& [id, grid] : grids) {
        if (!grid) throw InputError(name, "grids", "None", "grids of voxels");
        volume.grids.push_back({id, grid});
    }
    return volume_box(name, std::move(volume));
}

py::array_t<float> values_at(const VoxelGrid& grid, const Array<double>& points) {
    check_shape(grid.name(), "points", points, {-1, 3});
    py::array_t<float> values({points.shape(0), py::ssize_t{4}});
    for (py::ssize_t i = 0; i < points.shape(0); ++i) {
        const double* p = points.data() + 3 * i;
        const Vec4f value = grid.at(Vec3d(p[0], p[1], p[2]));
        for (int k = 0; k < 4; ++k) values.mutable_at(i, k) = value[k];
    }
    return values;
}

std::pair<std::array<double, 3>, std::array<double, 3>> ends_of(const VoxelGrid& grid) {
    const Box3d box = grid.bounds();
    return {{box.min.x, box.min.y, box.min.z}, {box.max.x, box.max.y, box.max.z}};
}

/// None where the cell has no detail.
py::object densities_along(const Array<float>& densities, const Array<double>& begin, const Array<double>& step) {
    check_shape("cell", "densities", densities, {CellDetail::kPoints});
    check_shape("cell", "begin", begin, {3});
    check_shape("cell", "step", step, {3});
    std::array<FoundDensity, CellDetail::kPoints> found;
    for (size_t i = 0; i < found.size(); ++i) {
        const float density = densities.data()[i];
        if (!(density >= 0.0f))
            throw InputError("cell", "densities", number_text(density), "numbers that are not negative");
        found[i] = {Color(density), 0.0f, true};
    }
    const DensityBounds cell = bounds_of(found, found, 1.0f);
    const CellDetail detail(found, cell);
    if (detail.is_none()) return py::none();
    PiecesOfCell pieces;
    for (size_t axis = 0; axis < 3; ++axis) {
        pieces.begin[axis] = static_cast<float>(begin.data()[axis]);
        pieces.step[axis] = static_cast<float>(step.data()[axis]);
    }
    detail.look_up(pieces);
    py::array_t<float> rows({static_cast<py::ssize_t>(kMostPieces), py::ssize_t{4}});
    for (size_t i = 0; i < kMostPieces; ++i) {
        const DensityBounds bounds = detail.bounds(cell, pieces.shares[i]);
        float* row = rows.mutable_data(static_cast<py::ssize_t>(i));
        row[0] = bounds.mean.x;
        row[1] = bounds.majorant;
        row[2] = bounds.certain;
        row[3] = bounds.residual;
    }
    return rows;
}

}  // namespace

void bind_volumes(py::module_& module) {
    using namespace py::literals;
    py::class_<VoxelGrid, SharedGrid>(module, "VoxelGrid", "Numbers, vectors or colours at the points of a lattice.")
        .def(py::init(&make_dense), "object"_a, "name"_a, "values"_a, "to_object"_a, "least"_a = 0.0f,
             "mixing"_a = "TRILINEAR")
        .def("values", &values_at, "points"_a)
        .def("bounds", &ends_of)
        .def_property_readonly("bad_numbers", &VoxelGrid::bad_numbers)
        .def_property_readonly("bytes", &VoxelGrid::bytes);
    module.def("read_vdb", &read_file, "object"_a, "path"_a, "names"_a, "value_place"_a = "MIDDLE",
               "mixing"_a = "TRILINEAR", "least"_a = 0.0f);
    module.def("densities_along", &densities_along, "densities"_a, "begin"_a, "step"_a);
    module.def("volume", &make_volume, "name"_a, "grids"_a, "density_unit"_a = "WORLD", "body"_a = "BLOCKS");
}

}  // namespace rayleaf
