// As std::optional, for large objects: an empty one writes nothing but that it is empty. GCC clears all bytes of an
// empty std::optional, which takes long where one is made for each ray.
#pragma once

#include <new>
#include <optional>
#include <type_traits>
#include <utility>

namespace rayleaf {

template <typename T>
class Maybe {
    static_assert(std::is_trivially_destructible_v<T>);

  public:
    Maybe() {}
    Maybe(std::nullopt_t) {}
    Maybe(const T& value) { emplace(value); }
    Maybe(const Maybe& other) { *this = other; }
    Maybe& operator=(const Maybe& other) {
        if (other)
            emplace(*other);
        else
            reset();
        return *this;
    }

    template <typename... Arguments>
    T& emplace(Arguments&&... arguments) {
        has_value_ = true;
        return *new (&value_) T{std::forward<Arguments>(arguments)...};
    }
    void reset() { has_value_ = false; }

    explicit operator bool() const { return has_value_; }
    bool has_value() const { return has_value_; }
    T& operator*() { return value_; }
    const T& operator*() const { return value_; }
    T* operator->() { return &value_; }
    const T* operator->() const { return &value_; }

  private:
    bool has_value_ = false;  ///< beside what is read first of the value
    union {
        T value_;
    };
};

}  // namespace rayleaf
