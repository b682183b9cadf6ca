// The user's mistakes. Ours are assertions (base/assert.h); absence is std::optional.
#pragma once

#include <concepts>
#include <stdexcept>
#include <string>
#include <string_view>

namespace rayleaf {

/// Input that cannot be rendered. The message reads: object 'NAME': ARGUMENT is GOT, expected WANTED.
class InputError : public std::runtime_error {
  public:
    InputError(const std::string& object, const std::string& argument, const std::string& got,
               const std::string& wanted);
};

/// A number for a message: the shortest text that identifies it.
std::string number_text(double value);
std::string number_text(float value);
std::string number_text(std::integral auto value) {
    return std::to_string(value);
}
/// Text from outside for a message: only its beginning if it is long.
std::string quotable(std::string_view text);

}  // namespace rayleaf
