#include "integrators/material_bins.h"

namespace rayleaf {

void MaterialBins::clear() {
    used_ = last_ = 0;
    bin_of_.clear();
}

void MaterialBins::add(const Program& program, uint32_t path) {
    if (used_ == 0 || bins_[last_].program != &program) {
        const auto [entry, is_new] = bin_of_.try_emplace(&program, used_);
        last_ = entry->second;
        if (is_new) {
            if (used_ == bins_.size()) bins_.emplace_back();
            bins_[used_].program = &program;
            bins_[used_++].paths.clear();
        }
    }
    bins_[last_].paths.push_back(path);
}

}  // namespace rayleaf
