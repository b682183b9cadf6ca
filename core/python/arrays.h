// Checks that turn NumPy arguments into spans and maps, with messages that name object and argument.
#pragma once

#include "base/error.h"
#include "base/vector.h"
#include "python/bindings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string>

namespace rayleaf {

/// Three numbers of Python, and back.
using Vector = std::array<float, 3>;
inline Vec3f vec(const Vector& v) {
    return {v[0], v[1], v[2]};
}
inline Vector tuple(const Vec3f& v) {
    return {v.x, v.y, v.z};
}

/// A contiguous array of T, made of what Python gave: other real numbers are converted, without a copy where the type
/// already fits. Anything else is refused by `check_numbers` or `check_shape`, which know the argument's name; until
/// then the array is empty.
template <typename T>
class Array : public py::array_t<T, py::array::c_style | py::array::forcecast> {
  public:
    using Base = py::array_t<T, py::array::c_style | py::array::forcecast>;
    using Base::Base;
    Array() = default;
    Array(const Base& array) : Base(array) {}  // NOLINT(google-explicit-constructor): an array like any other

    static Array read(const py::handle& given);
    /// What came instead of numbers; empty if numbers did.
    const std::string& problem() const { return problem_; }

  private:
    std::string problem_;
};

/// "float32" for messages.
template <typename T>
std::string number_kind() {
    return py::str(py::dtype::of<T>());
}

/// What `given` is in place of an array that can become one of T; empty if it can.
std::string array_problem(const py::handle& given, const py::dtype& wanted, py::array& array);

template <typename T>
Array<T> Array<T>::read(const py::handle& given) {
    Array result;
    py::array array;
    result.problem_ = array_problem(given, py::dtype::of<T>(), array);
    if (!result.problem_.empty()) return result;
    auto converted = Base::ensure(array);
    if (!converted) throw py::error_already_set();
    static_cast<Base&>(result) = std::move(converted);
    return result;
}

/// "(3, 4)" for messages.
inline std::string shape_text(const py::array& array) {
    std::string text = "(";
    for (py::ssize_t i = 0; i < array.ndim(); ++i) text += (i ? ", " : "") + std::to_string(array.shape(i));
    return text + ")";
}

template <typename T>
void check_numbers(const std::string& object, const char* argument, const Array<T>& array) {
    if (array.problem().empty()) return;
    throw InputError(object, argument, array.problem(), "an array of " + number_kind<T>());
}

/// Checks an array's shape; -1 in `wanted` allows any length there.
template <typename T>
void check_shape(const std::string& object, const char* argument, const Array<T>& array,
                 std::initializer_list<py::ssize_t> wanted) {
    check_numbers(object, argument, array);
    bool fits = array.ndim() == static_cast<py::ssize_t>(wanted.size());
    std::string text = "(";
    py::ssize_t axis = 0;
    for (const py::ssize_t length : wanted) {
        fits = fits && (length < 0 || array.shape(axis) == length);
        text += (axis ? ", " : "") + (length < 0 ? std::string("n") : std::to_string(length));
        ++axis;
    }
    if (!fits) throw InputError(object, argument, "an array of shape " + shape_text(array), "shape " + text + ")");
}

/// Of an array that has been checked.
template <typename T>
std::span<const T> span_of(const Array<T>& array) {
    return {array.data(), static_cast<size_t>(array.size())};
}

/// What the last row of an affine matrix may be off by: products of matrices of floats are rounded, there too.
constexpr double kMostRounding = 1e-4;

/// A 4x4 matrix of doubles, row by row, as an affine map.
inline Affine3d affine_of(const std::string& object, const double* m) {
    const double off = std::max({std::abs(m[12]), std::abs(m[13]), std::abs(m[14]), std::abs(m[15] - 1.0)});
    if (!(off <= kMostRounding))
        throw InputError(object, "matrix",
                         "one whose last row is (" + number_text(m[12]) + ", " + number_text(m[13]) + ", " +
                             number_text(m[14]) + ", " + number_text(m[15]) + ")",
                         "(0, 0, 0, 1) there");
    return {{m[0], m[4], m[8]}, {m[1], m[5], m[9]}, {m[2], m[6], m[10]}, {m[3], m[7], m[11]}};
}

inline Affine3d affine_of(const std::string& object, const Array<double>& matrix) {
    check_shape(object, "matrix", matrix, {4, 4});
    return affine_of(object, matrix.data());
}

/// The value of a name among those there are.
template <typename Value, size_t N>
Value named(const std::string& object, const char* argument, const std::string& name,
            const std::pair<const char*, Value> (&values)[N]) {
    std::string wanted;
    for (const auto& [text, value] : values) {
        if (name == text) return value;
        wanted += (wanted.empty() ? "" : ", ") + std::string(text);
    }
    throw InputError(object, argument, "'" + name + "'", "one of " + wanted);
}

}  // namespace rayleaf

namespace pybind11::detail {

/// Takes anything: what is no array of numbers is told apart later.
template <typename T>
struct pyobject_caster<rayleaf::Array<T>> {
    using type = rayleaf::Array<T>;

    bool load(handle given, bool /*convert*/) {
        value = type::read(given);
        return true;
    }
    static handle cast(const handle& array, return_value_policy /*policy*/, handle /*parent*/) {
        return array.inc_ref();
    }
    PYBIND11_TYPE_CASTER(type, handle_type_name<array_t<T>>::name);
};

}  // namespace pybind11::detail
