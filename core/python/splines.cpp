#include "python/arrays.h"
#include "python/bindings.h"
#include "splines/bernstein.h"
#include "splines/bezier_spline.h"
#include "splines/bounds.h"
#include "splines/closest_point.h"
#include "splines/limit_normal.h"
#include "splines/nurbs.h"

#include <algorithm>
#include <array>
#include <tuple>

namespace rayleaf {
namespace {

using Vector = std::array<double, 3>;
using Problem = std::optional<std::tuple<std::string, std::string, std::string, std::string>>;

Vec3d vec(const Vector& v) {
    return {v[0], v[1], v[2]};
}

/// Points with weights as they come: x, y, z, weight.
std::vector<Vec4d> weighted_points(const Array<double>& array) {
    std::vector<Vec4d> points(static_cast<size_t>(array.size()) / 4);
    const double* p = array.data();
    for (Vec4d& point : points) {
        point = {p[0], p[1], p[2], p[3]};
        p += 4;
    }
    return points;
}

/// The same multiplied out; whether weights differ from 1 is returned.
bool make_homogeneous(std::vector<Vec4d>& points) {
    bool rational = false;
    for (Vec4d& p : points) {
        rational = rational || p.w != 1.0;
        p = homogeneous(spatial_part(p), p.w);
    }
    return rational;
}

py::array_t<double> points_array(const std::vector<Vec4d>& points, std::vector<py::ssize_t> shape) {
    shape.push_back(4);
    py::array_t<double> out(std::move(shape));
    double* to = out.mutable_data();
    for (const Vec4d& point : points) to = std::copy_n(&point.x, 4, to);
    return out;
}

/// An array (count, vectors, 3) filled row by row.
template <size_t Vectors, typename Evaluate>
py::array_t<double> table(size_t count, const Evaluate& evaluate) {
    py::array_t<double> out({count, Vectors, size_t{3}});
    double* to = out.mutable_data();
    for (size_t i = 0; i < count; ++i)
        for (const Vec3d& v : evaluate(i)) to = std::copy_n(v.getValue(), 3, to);
    return out;
}

/// An array (count, 3).
template <typename Evaluate>
py::array_t<double> position_table(size_t count, const Evaluate& evaluate) {
    py::array_t<double> out({count, size_t{3}});
    double* to = out.mutable_data();
    for (size_t i = 0; i < count; ++i) to = std::copy_n(Vec3d(evaluate(i)).getValue(), 3, to);
    return out;
}

void check_pair(const char* object, const Array<double>& u, const Array<double>& v) {
    check_shape(object, "u", u, {-1});
    check_shape(object, "v", v, {u.shape(0)});
}

template <typename T, typename Box>
py::array_t<T> box_array(const Box& box) {
    py::array_t<T> out({2, 3});
    std::copy_n(box.min.getValue(), 3, out.mutable_data());
    std::copy_n(box.max.getValue(), 3, out.mutable_data() + 3);
    return out;
}

const char* kind_name(SplineProblemKind kind) {
    switch (kind) {
        case SplineProblemKind::DrawsNothing:
            return "DRAWS_NOTHING";
        case SplineProblemKind::DrawsControlPolygon:
            return "DRAWS_CONTROL_POLYGON";
        default:
            return "BAD_DATA";
    }
}

template <typename Spline>
Problem problem_of(const Spline& spline) {
    const std::optional<SplineProblem> problem = find_problem(spline);
    if (!problem) return std::nullopt;
    return std::tuple(std::string(kind_name(problem->kind)), problem->argument, problem->got, problem->wanted);
}

template <typename Spline>
auto converted(const char* kind, const Spline& spline) {
    if (const auto problem = find_problem(spline))
        throw InputError(kind, problem->argument, problem->got, problem->wanted);
    return to_bezier(spline);
}

py::array_t<double> ranges(const SplineAxis& axis) {
    py::array_t<double> out({axis.spans.size(), size_t{2}});
    double* to = out.mutable_data();
    for (const SplineSpan& span : axis.spans) {
        *to++ = span.begin;
        *to++ = span.end;
    }
    return out;
}

std::vector<int> continuity(const SplineAxis& axis) {
    std::vector<int> out;
    for (const SplineSpan& span : axis.spans) out.push_back(span.continuity_after);
    return out;
}

size_t checked_index(size_t index, const SplineAxis& axis, const char* argument) {
    if (index >= axis.spans.size())
        throw py::index_error(std::string(argument) + " is " + std::to_string(index) + ", of " +
                              std::to_string(axis.spans.size()) + " spans");
    return index;
}

PatchDirection direction_of(const std::string& name) {
    if (name == "U") return PatchDirection::U;
    if (name == "V") return PatchDirection::V;
    throw InputError("BezierPatch", "direction", "'" + name + "'", "'U' or 'V'");
}

const char* stage_name(NormalStage stage) {
    constexpr std::array<const char*, kNormalStageCount> names{"REGULAR", "SECOND_ORDER", "INSET", "NEIGHBOUR",
                                                               "GEOMETRIC"};
    return names[static_cast<size_t>(stage)];
}

/// Shape, finiteness and weights of control points that become a curve or patch without further ado.
std::vector<Vec4d> checked_control_points(const char* object, const Array<double>& array) {
    std::vector<Vec4d> points = weighted_points(array);
    if (points.empty()) throw InputError(object, "points", "empty", "at least one point");
    for (const Vec4d& p : points)
        if (!is_finite(spatial_part(p)) || !std::isfinite(p.w) || !(p.w > 0.0))
            throw InputError(object, "points", "not finite or without a positive weight",
                             "finite coordinates and weights > 0");
    return points;
}

BezierCurve make_curve(const Array<double>& points) {
    check_shape("BezierCurve", "points", points, {-1, 4});
    BezierCurve curve{static_cast<int>(points.shape(0)) - 1, false, checked_control_points("BezierCurve", points)};
    curve.rational = make_homogeneous(curve.points);
    return curve;
}

BezierPatch make_patch(const Array<double>& points) {
    check_shape("BezierPatch", "points", points, {-1, -1, 4});
    BezierPatch patch{static_cast<int>(points.shape(1)) - 1, static_cast<int>(points.shape(0)) - 1, false,
                      checked_control_points("BezierPatch", points)};
    patch.rational = make_homogeneous(patch.points);
    return patch;
}

auto patch_normals(const BezierPatch& patch, const Array<double>& u, const Array<double>& v,
                   const std::optional<Vector>& neighbour, const Vector& geometric) {
    check_pair("BezierPatch", u, v);
    NormalFallback fallback;
    fallback.geometric = vec(geometric);
    if (neighbour) fallback.neighbour = [&] { return std::optional(vec(*neighbour)); };
    std::vector<std::string> stages;
    py::array_t<double> normals = table<3>(static_cast<size_t>(u.size()), [&](size_t i) {
        const LimitNormal n = limit_normal(patch.view(), u.data()[i], v.data()[i], fallback);
        stages.emplace_back(stage_name(n.stage));
        return std::array{n.normal, n.dn_du, n.dn_dv};
    });
    return std::pair(normals, stages);
}

void bind_bezier_curve(py::module_& module) {
    using namespace py::literals;
    py::class_<BezierCurve>(module, "BezierCurve")
        .def(py::init(&make_curve), "points"_a)
        .def_readonly("degree", &BezierCurve::degree)
        .def_readonly("rational", &BezierCurve::rational)
        .def_property_readonly("points", [](const BezierCurve& c) { return points_array(c.points, {c.degree + 1}); })
        .def(
            "evaluate",
            [](const BezierCurve& curve, const Array<double>& t) {
                check_shape("BezierCurve", "t", t, {-1});
                return table<3>(static_cast<size_t>(t.size()), [&](size_t i) {
                    const CurvePoint p = curve.evaluate(t.data()[i]);
                    return std::array{p.position, p.first, p.second};
                });
            },
            "t"_a)
        .def(
            "de_casteljau",
            [](const BezierCurve& curve, const Array<double>& t) {
                check_shape("BezierCurve", "t", t, {-1});
                return position_table(static_cast<size_t>(t.size()),
                                      [&](size_t i) { return curve.position_by_de_casteljau(t.data()[i]); });
            },
            "t"_a)
        .def("split", &BezierCurve::split, "t"_a)
        .def("restricted", &BezierCurve::restricted, "begin"_a, "end"_a)
        .def("elevated", &BezierCurve::elevated)
        .def("bounds", [](const BezierCurve& curve) { return box_array<double>(hull_bounds(curve)); });
}

void bind_bezier_patch(py::module_& module) {
    using namespace py::literals;
    py::class_<BezierPatch>(module, "BezierPatch")
        .def(py::init(&make_patch), "points"_a)
        .def_readonly("degree_u", &BezierPatch::degree_u)
        .def_readonly("degree_v", &BezierPatch::degree_v)
        .def_readonly("rational", &BezierPatch::rational)
        .def_property_readonly("points",
                               [](const BezierPatch& p) {
                                   return points_array(p.points, {p.degree_v + 1, p.degree_u + 1});
                               })
        .def(
            "evaluate",
            [](const BezierPatch& patch, const Array<double>& u, const Array<double>& v) {
                check_pair("BezierPatch", u, v);
                return table<6>(static_cast<size_t>(u.size()), [&](size_t i) {
                    const PatchPoint p = patch.evaluate(u.data()[i], v.data()[i]);
                    return std::array{p.position, p.du, p.dv, p.duu, p.duv, p.dvv};
                });
            },
            "u"_a, "v"_a)
        .def("normals", &patch_normals, "u"_a, "v"_a, "neighbour"_a = py::none(), "geometric"_a = Vector{0, 0, 1})
        .def(
            "split",
            [](const BezierPatch& patch, const std::string& direction, double t) {
                return patch.split(direction_of(direction), t);
            },
            "direction"_a, "t"_a)
        .def("restricted", &BezierPatch::restricted, "u_begin"_a, "u_end"_a, "v_begin"_a, "v_end"_a)
        .def(
            "elevated",
            [](const BezierPatch& patch, const std::string& direction) {
                return patch.elevated(direction_of(direction));
            },
            "direction"_a)
        .def("bounds", [](const BezierPatch& patch) { return box_array<double>(hull_bounds(patch.view())); })
        .def("float_bounds",
             [](const BezierPatch& patch) { return box_array<float>(outward_float(hull_bounds(patch.view()))); })
        .def(
            "facet_distance_bound",
            [](const BezierPatch& patch, int cells_u, int cells_v) {
                return facet_distance_bound(curvature_bounds(patch.view()), cells_u, cells_v);
            },
            "cells_u"_a, "cells_v"_a)
        .def(
            "closest_point",
            [](const BezierPatch& patch, const Vector& target) {
                const ClosestPoint p = closest_point(patch.view(), vec(target));
                return std::tuple(p.u, p.v, p.distance);
            },
            "target"_a);
}

void bind_bezier_form(py::module_& module) {
    using namespace py::literals;
    py::class_<BezierChain>(module, "BezierChain")
        .def_readonly("rational", &BezierChain::rational)
        .def_property_readonly("closed", [](const BezierChain& c) { return c.axis.closed; })
        .def_property_readonly("ranges", [](const BezierChain& c) { return ranges(c.axis); })
        .def_property_readonly("continuity", [](const BezierChain& c) { return continuity(c.axis); })
        .def_property_readonly("points",
                               [](const BezierChain& c) { return points_array(c.points, {c.axis.point_count}); })
        .def(
            "positions",
            [](const BezierChain& chain, const Array<double>& t) {
                check_shape("BezierChain", "t", t, {-1});
                return position_table(static_cast<size_t>(t.size()),
                                      [&](size_t i) { return chain.position(t.data()[i]); });
            },
            "t"_a)
        .def(
            "segment",
            [](const BezierChain& c, size_t index) { return c.segment(checked_index(index, c.axis, "index")); },
            "index"_a);
    py::class_<BezierNet>(module, "BezierNet")
        .def_readonly("rational", &BezierNet::rational)
        .def_property_readonly("closed_u", [](const BezierNet& n) { return n.u.closed; })
        .def_property_readonly("closed_v", [](const BezierNet& n) { return n.v.closed; })
        .def_property_readonly("ranges_u", [](const BezierNet& n) { return ranges(n.u); })
        .def_property_readonly("ranges_v", [](const BezierNet& n) { return ranges(n.v); })
        .def_property_readonly("continuity_u", [](const BezierNet& n) { return continuity(n.u); })
        .def_property_readonly("continuity_v", [](const BezierNet& n) { return continuity(n.v); })
        .def_property_readonly("points",
                               [](const BezierNet& n) {
                                   return points_array(n.points, {n.v.point_count, n.u.point_count});
                               })
        .def(
            "positions",
            [](const BezierNet& net, const Array<double>& u, const Array<double>& v) {
                check_pair("BezierNet", u, v);
                return position_table(static_cast<size_t>(u.size()),
                                      [&](size_t i) { return net.position(u.data()[i], v.data()[i]); });
            },
            "u"_a, "v"_a)
        .def(
            "patch",
            [](const BezierNet& n, size_t span_u, size_t span_v) {
                return n.patch(checked_index(span_u, n.u, "span_u"), checked_index(span_v, n.v, "span_v"));
            },
            "span_u"_a, "span_v"_a);
}

void bind_nurbs(py::module_& module) {
    using namespace py::literals;
    py::class_<NurbsSpline>(module, "NurbsSpline")
        .def(py::init([](const Array<double>& points, int order_u, int order_v, bool cyclic_u, bool cyclic_v,
                         bool endpoint_u, bool endpoint_v, bool bezier_u, bool bezier_v, int material_slot,
                         bool smooth) {
                 check_shape("NurbsSpline", "points", points, {-1, -1, 4});
                 const NurbsDirection u{order_u, cyclic_u, endpoint_u, bezier_u};
                 const NurbsDirection v{order_v, cyclic_v, endpoint_v, bezier_v};
                 return NurbsSpline{{static_cast<int>(points.shape(1)), static_cast<int>(points.shape(0)),
                                     weighted_points(points), u, v},
                                    material_slot,
                                    smooth};
             }),
             "points"_a, "order_u"_a, "order_v"_a, "cyclic_u"_a = false, "cyclic_v"_a = false, "endpoint_u"_a = false,
             "endpoint_v"_a = false, "bezier_u"_a = false, "bezier_v"_a = false, "material_slot"_a = 0,
             "smooth"_a = true)
        .def_readonly("material_slot", &NurbsSpline::material_slot)
        .def_readonly("smooth", &NurbsSpline::smooth)
        .def("problem", [](const NurbsSpline& spline) { return problem_of(spline.surface); })
        .def("to_bezier", [](const NurbsSpline& spline) { return converted("NurbsSpline", spline.surface); });
    py::class_<NurbsCurve>(module, "NurbsCurve")
        .def(py::init([](const Array<double>& points, int order, bool cyclic, bool endpoint, bool bezier) {
                 check_shape("NurbsCurve", "points", points, {-1, 4});
                 return NurbsCurve{weighted_points(points), {order, cyclic, endpoint, bezier}};
             }),
             "points"_a, "order"_a, "cyclic"_a = false, "endpoint"_a = false, "bezier"_a = false)
        .def("problem", [](const NurbsCurve& curve) { return problem_of(curve); })
        .def("to_bezier", [](const NurbsCurve& curve) { return converted("NurbsCurve", curve); });
    py::class_<BezierSpline>(module, "BezierSpline")
        .def(py::init([](const Array<double>& knots, bool cyclic) {
                 check_shape("BezierSpline", "knots", knots, {-1, 3, 3});
                 BezierSpline spline{std::vector<BezierKnot>(static_cast<size_t>(knots.shape(0))), cyclic};
                 const double* p = knots.data();
                 for (BezierKnot& knot : spline.knots) {
                     knot = {{p[0], p[1], p[2]}, {p[3], p[4], p[5]}, {p[6], p[7], p[8]}};
                     p += 9;
                 }
                 return spline;
             }),
             "knots"_a, "cyclic"_a = false)
        .def("problem", [](const BezierSpline& spline) { return problem_of(spline); })
        .def("to_bezier", [](const BezierSpline& spline) { return converted("BezierSpline", spline); });
    module.def(
        "implied_knots",
        [](int count, int order, bool cyclic, bool endpoint, bool bezier) {
            NurbsCurve curve{std::vector<Vec4d>(static_cast<size_t>(std::max(count, 0)), Vec4d(0, 0, 0, 1)),
                             {order, cyclic, endpoint, bezier}};
            if (const auto problem = find_problem(curve))
                throw InputError("implied_knots", problem->argument, problem->got, problem->wanted);
            const std::vector<double> knots = implied_knots(count, curve.direction);
            return py::array_t<double>(static_cast<py::ssize_t>(knots.size()), knots.data());
        },
        "count"_a, "order"_a, "cyclic"_a = false, "endpoint"_a = false, "bezier"_a = false);
}

}  // namespace

void bind_splines(py::module_& module) {
    bind_bezier_curve(module);
    bind_bezier_patch(module);
    bind_bezier_form(module);
    bind_nurbs(module);
}

}  // namespace rayleaf
