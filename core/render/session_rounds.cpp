// Samples in rounds, as far as noise, error and time ask for them.
#include "render/session.h"
#include "render/tiles.h"

#include <cmath>
#include <limits>

namespace rayleaf {

void Session::render_round(int count) {
    if (error_) {
        constexpr int kMostSamples = 1 << 24;
        std::vector<WindowGroup> groups = next_to_goal(kMostSamples);
        for (WindowGroup& group : groups)
            for (WindowSamples& each : group) each.samples.count = count;
        render_groups(groups, 1);
        if (!cancel_.cancelled()) error_->decide();
        return;
    }
    render_tiles({sample_range(settings_).first + samples_taken_, count}, 1);
    if (cancel_.cancelled()) return;
    samples_taken_ += count;
}

void Session::render_rounds() {
    const int most = sample_range(settings_).count;
    film_.hold_means();
    if (error_) render_to_goal();
    while (!error_ && !cancel_.cancelled() && samples_taken_ < most) {
        const int count = std::min(next_round(seconds_left()), most - samples_taken_);
        if (count == 0) break;
        render_round(count);
    }
}

void Session::render_to_goal() {
    const int most = sample_range(settings_).count;
    planned_paths_ = static_cast<uint64_t>(std::max(error_->samples_missing(most), 1.0));
    for (auto groups = next_to_goal(most); !groups.empty(); groups = next_to_goal(most)) {
        render_groups(groups, 1);
        if (cancel_.cancelled()) break;
        error_->decide();
        planned_paths_ = finished_paths_ + static_cast<uint64_t>(error_->samples_missing(most));
    }
}

/// Where time is short, half as many as fit into it.
std::vector<Session::WindowGroup> Session::next_to_goal(int most) const {
    const Window whole = part(settings_);
    std::vector<WindowGroup> groups = error_->next(most);
    uint64_t paths = 0;
    for (const WindowGroup& group : groups)
        for (const WindowSamples& each : group) paths += each.paths();
    double share = 1.0;
    if (settings_.time_limit > 0.0 && finished_paths_ > 0) {
        const double seconds = settings_.time_limit - build_seconds_ - seconds_left();
        share = seconds_left() * static_cast<double>(finished_paths_) / seconds / static_cast<double>(paths) / 2.0;
    }
    for (WindowGroup& group : groups) {
        for (WindowSamples& each : group) {
            each.window.x += whole.x;
            each.window.y += whole.y;
            each.samples.first += sample_range(settings_).first;
            if (share < 1.0) each.samples.count = static_cast<int>(share * each.samples.count);
        }
        std::erase_if(group, [](const WindowSamples& each) { return each.samples.count <= 0; });
    }
    std::erase_if(groups, [](const WindowGroup& group) { return group.empty(); });
    return groups;
}

double Session::seconds_left() const {
    if (settings_.time_limit == 0.0) return std::numeric_limits<double>::infinity();
    return settings_.time_limit - std::chrono::duration<double>(std::chrono::steady_clock::now() - began_).count();
}

/// Rounds of a quarter more samples each. Of what fits into the time that is left half, so that the last rounds are
/// small.
int Session::next_round(double seconds_left) const {
    constexpr int kShare = 4, kLeast = 8;
    if (samples_taken_ == 0) return 1;
    const int count = std::max(samples_taken_ / kShare, kLeast);
    const double seconds_each = (settings_.time_limit - build_seconds_ - seconds_left) / samples_taken_;
    const double fit = seconds_left / seconds_each;
    if (fit < 1.0) return 0;
    return static_cast<int>(std::clamp(fit / 2.0, 1.0, static_cast<double>(count)));
}

}  // namespace rayleaf
