// Checks that turn NumPy arguments into spans and maps, with messages that name object and argument.
#pragma once

#include "base/error.h"
#include "base/vector.h"
#include "python/bindings.h"

#include <span>
#include <string>

namespace rayleaf {

/// A contiguous array of T; forcecast converts other number types, without a copy where the type already fits.
template <typename T>
using Array = py::array_t<T, py::array::c_style | py::array::forcecast>;

/// "(3, 4)" for messages.
inline std::string shape_text(const py::array& array) {
    std::string text = "(";
    for (py::ssize_t i = 0; i < array.ndim(); ++i) text += (i ? ", " : "") + std::to_string(array.shape(i));
    return text + ")";
}

/// Checks an array's shape; -1 in `wanted` allows any length there.
inline void check_shape(const std::string& object, const char* argument, const py::array& array,
                        std::initializer_list<py::ssize_t> wanted) {
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

template <typename T>
std::span<const T> span_of(const Array<T>& array) {
    return {array.data(), static_cast<size_t>(array.size())};
}

/// A 4x4 matrix of doubles, row by row, as an affine map. The last row is not read: Blender's is always 0 0 0 1.
inline Affine3d affine_of(const double* m) {
    return {{m[0], m[4], m[8]}, {m[1], m[5], m[9]}, {m[2], m[6], m[10]}, {m[3], m[7], m[11]}};
}

inline Affine3d affine_of(const std::string& object, const Array<double>& matrix) {
    check_shape(object, "matrix", matrix, {4, 4});
    return affine_of(matrix.data());
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
