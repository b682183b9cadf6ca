#include "base/error.h"
#include "python/bindings.h"

#include <cstring>

namespace rayleaf {

void bind_errors(py::module_& module) {
    static py::handle type;
    type = py::register_exception<InputError>(module, "InputError", PyExc_ValueError);
    // The path of a file may hold bytes that are not UTF-8; pybind11's own translator fails on them.
    py::register_exception_translator([](std::exception_ptr thrown) {
        try {
            std::rethrow_exception(thrown);
        } catch (const InputError& error) {
            const char* text = error.what();
            const auto message = py::reinterpret_steal<py::object>(
                PyUnicode_DecodeUTF8(text, static_cast<Py_ssize_t>(std::strlen(text)), "backslashreplace"));
            PyErr_SetObject(type.ptr(), message.ptr());
        }
    });
}

}  // namespace rayleaf
