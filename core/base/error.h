// The user's mistakes. Ours are assertions (base/assert.h); absence is std::optional.
#pragma once

#include <stdexcept>
#include <string>

namespace rayleaf {

/// Input that cannot be rendered. The message reads: object 'NAME': ARGUMENT is GOT, expected WANTED.
class InputError : public std::runtime_error {
  public:
    InputError(const std::string& object, const std::string& argument, const std::string& got,
               const std::string& wanted)
        : std::runtime_error("object '" + object + "': " + argument + " is " + got + ", expected " + wanted) {}
};

}  // namespace rayleaf
