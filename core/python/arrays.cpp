#include "python/arrays.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rayleaf {
namespace {

bool is_whole(char kind) {
    return kind == 'i' || kind == 'u';
}

bool is_real(char kind) {
    return kind == 'f' || is_whole(kind) || kind == 'b';
}

/// The lowest and the highest number of a whole type.
template <typename Wide>
std::pair<Wide, Wide> range_of(const py::dtype& type) {
    const auto bits = static_cast<int>(8 * type.itemsize());
    if (type.kind() == 'b') return {Wide{0}, Wide{1}};
    constexpr int kWideBits = 8 * sizeof(Wide);
    using Limits = std::numeric_limits<Wide>;
    if (type.kind() == 'u') {
        if (bits >= kWideBits) return {Wide{0}, Limits::max()};
        return {Wide{0}, static_cast<Wide>((Wide{1} << bits) - 1)};
    }
    const Wide highest = bits >= kWideBits ? Limits::max() : static_cast<Wide>((Wide{1} << (bits - 1)) - 1);
    return {std::is_signed_v<Wide> ? static_cast<Wide>(-highest - 1) : Wide{0}, highest};
}

/// The first number that the wanted type cannot hold; empty if it holds all. Wide holds all of the array's.
template <typename Wide>
std::string number_beyond(const py::array& array, const py::dtype& wanted) {
    const auto numbers = py::array_t<Wide, py::array::c_style | py::array::forcecast>::ensure(array);
    if (!numbers) throw py::error_already_set();
    const auto range = range_of<Wide>(wanted);
    const Wide least = range.first, most = range.second;
    const Wide* const end = numbers.data() + numbers.size();
    const Wide* const found =
        std::find_if(numbers.data(), end, [&](Wide number) { return number < least || number > most; });
    return found == end ? std::string() : std::to_string(*found);
}

/// The same of real numbers, for up to 32 bits: the first that is not whole counts too.
std::string fraction_or_beyond(const py::array& array, const py::dtype& wanted) {
    const auto numbers = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(array);
    if (!numbers) throw py::error_already_set();
    const auto [least, most] = range_of<int64_t>(wanted);
    for (const double* number = numbers.data(); number != numbers.data() + numbers.size(); ++number) {
        const bool holds = *number >= static_cast<double>(least) && *number <= static_cast<double>(most) &&
                           std::trunc(*number) == *number;
        if (!holds) return number_text(*number);
    }
    return {};
}

}  // namespace

std::string array_problem(const py::handle& given, const py::dtype& wanted, py::array& array) {
    if (given.is_none()) return "None";
    const std::string type = py::str(py::type::handle_of(given).attr("__name__"));
    if (py::isinstance<py::str>(given) || py::isinstance<py::bytes>(given)) return "a text (" + type + ")";
    array = py::array::ensure(given);  // clears the error where there is one
    if (!array) return "no array (" + type + ")";
    const char from = array.dtype().kind(), to = wanted.kind();
    if (!is_real(from)) return "an array of " + std::string(py::str(array.dtype()));
    if (to == 'f' || from == 'b') return {};
    const std::string wrong = from == 'f'   ? fraction_or_beyond(array, wanted)
                              : from == 'u' ? number_beyond<uint64_t>(array, wanted)
                                            : number_beyond<int64_t>(array, wanted);
    return wrong.empty() ? wrong : "an array with the number " + wrong;
}

}  // namespace rayleaf
