#include "base/error.h"

#include <charconv>

namespace rayleaf {
namespace {

/// The most bytes of a quoted text: longer than any name in Blender.
constexpr size_t kLongestQuote = 300;

template <typename Number>
std::string shortest_text(Number value) {
    char text[64];
    const std::to_chars_result end = std::to_chars(text, text + sizeof(text), value);
    return {text, end.ptr};
}

}  // namespace

std::string number_text(double value) {
    return shortest_text(value);
}
std::string number_text(float value) {
    return shortest_text(value);
}

std::string quotable(std::string_view text) {
    if (text.size() <= kLongestQuote) return std::string(text);
    constexpr unsigned char kContinued = 0x80, kContinuedMask = 0xc0;  // bytes of UTF-8 within a character
    size_t end = kLongestQuote;
    while (end > 0 && (static_cast<unsigned char>(text[end]) & kContinuedMask) == kContinued) --end;
    return std::string(text.substr(0, end)) + "... (" + std::to_string(text.size()) + " bytes)";
}

InputError::InputError(const std::string& object, const std::string& argument, const std::string& got,
                       const std::string& wanted)
    : std::runtime_error("object '" + quotable(object) + "': " + quotable(argument) + " is " + quotable(got) +
                         ", expected " + quotable(wanted)) {}

}  // namespace rayleaf
