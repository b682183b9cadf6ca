// Assertions for our own mistakes; they show both values. Compiled in by the presets `dev` and `asan`.
#pragma once

#include <sstream>
#include <stdexcept>

namespace rayleaf {

/// A broken promise of the core itself. Never the user's fault, never caught inside the core.
class InternalError : public std::logic_error {
    using std::logic_error::logic_error;
};

template <typename A, typename B>
[[noreturn]] void assertion_failed(const char* expression, const A& a, const B& b, const char* file, int line) {
    std::ostringstream text;
    text << "internal error: " << expression << " failed with " << a << " and " << b << " (" << file << ":" << line
         << ")";
    throw InternalError(text.str());
}

}  // namespace rayleaf

#ifdef RAYLEAF_ASSERTIONS
#define RAYLEAF_ASSERT_OP(a, op, b)                                                                   \
    do {                                                                                              \
        const auto& rayleaf_a = (a);                                                                  \
        const auto& rayleaf_b = (b);                                                                  \
        if (!(rayleaf_a op rayleaf_b))                                                                \
            ::rayleaf::assertion_failed(#a " " #op " " #b, rayleaf_a, rayleaf_b, __FILE__, __LINE__); \
    } while (false)
#else
#define RAYLEAF_ASSERT_OP(a, op, b) static_cast<void>(0)
#endif
#define RAYLEAF_ASSERT_LT(a, b) RAYLEAF_ASSERT_OP(a, <, b)
#define RAYLEAF_ASSERT_LE(a, b) RAYLEAF_ASSERT_OP(a, <=, b)
#define RAYLEAF_ASSERT_GT(a, b) RAYLEAF_ASSERT_OP(a, >, b)
#define RAYLEAF_ASSERT_GE(a, b) RAYLEAF_ASSERT_OP(a, >=, b)
#define RAYLEAF_ASSERT_EQ(a, b) RAYLEAF_ASSERT_OP(a, ==, b)
