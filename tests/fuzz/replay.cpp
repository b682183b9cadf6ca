// Runs a fuzz target on kept cases and on mutations of them, the same each time, where libFuzzer is not at hand.
//
//     fuzz_TARGET FOLDER MUTATIONS         each case as it is, then mutations in all, spread over the cases
//     fuzz_TARGET FILE --mutation NUMBER   one of them again
#include <algorithm>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include <unistd.h>

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size);
/// A failure ends in SIGABRT, so that `name_input` is told.
extern "C" const char* __asan_default_options() {
    return "abort_on_error=1";
}
extern "C" const char* __ubsan_default_options() {
    return "abort_on_error=1";
}

namespace {

using Input = std::vector<uint8_t>;

/// What is being run, for the message if it fails.
char running[1024] = "";

extern "C" void name_input(int) {
    constexpr char kWords[] = "\nfails: ";
    if (write(2, kWords, sizeof kWords - 1) < 0 || write(2, running, std::char_traits<char>::length(running)) < 0)
        _exit(3);
    _exit(2);
}

/// Mutation 0 is the input itself. Bytes are set, repeated and cut.
Input mutated(const Input& input, int number) {
    constexpr size_t kLargest = 1500;
    Input changed = input;
    if (number == 0) return changed;
    std::mt19937 random(static_cast<uint32_t>(number));
    const auto below = [&random](size_t end) { return static_cast<size_t>(random()) % std::max<size_t>(end, 1); };
    for (size_t changes = 1 + below(8); changes > 0; --changes) {
        const size_t at = below(changed.size());
        const auto place = changed.begin() + static_cast<std::ptrdiff_t>(at);
        const size_t kind = below(8);
        if (changed.empty() || (kind == 0 && changed.size() < kLargest))
            changed.insert(place, 1 + below(16), static_cast<uint8_t>(random()));
        else if (kind == 1)
            changed.erase(place,
                          place + static_cast<std::ptrdiff_t>(1 + below(std::min<size_t>(changed.size() - at, 16))));
        else
            *place = static_cast<uint8_t>(random());
    }
    return changed;
}

Input read_file(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

void run(const std::filesystem::path& path, const Input& input, int number) {
    std::snprintf(running, sizeof running, "%s --mutation %d\n", path.c_str(), number);
    const Input changed = mutated(input, number);
    LLVMFuzzerTestOneInput(changed.data(), changed.size());
}

std::vector<std::filesystem::path> cases_in(const std::filesystem::path& folder) {
    std::vector<std::filesystem::path> paths;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) paths.push_back(entry.path());
    std::sort(paths.begin(), paths.end());
    return paths;
}

}  // namespace

int main(int count, char** arguments) {
    std::signal(SIGABRT, name_input);
    if (count == 4 && std::string(arguments[2]) == "--mutation") {
        run(arguments[1], read_file(arguments[1]), std::atoi(arguments[3]));
        return 0;
    }
    if (count != 3) {
        std::fprintf(stderr, "fuzz_TARGET FOLDER MUTATIONS | fuzz_TARGET FILE --mutation NUMBER\n");
        return 1;
    }
    const std::vector<std::filesystem::path> paths = cases_in(arguments[1]);
    const int each = std::atoi(arguments[2]) / std::max(1, static_cast<int>(paths.size()));
    for (const auto& path : paths) {
        const Input input = read_file(path);
        for (int number = 0; number <= each; ++number) run(path, input, number);
    }
    std::printf("%s: %zu cases, %d mutations of each\n", arguments[0], paths.size(), each);
    return 0;
}
