// The extension module rayleaf_rivals: what tests and benchmarks measure Rayleaf against. It takes shapes and ray
// caches of rayleaf._core, and is part of no package.
#include "python/tree_bindings.h"
#include "rivals/bindings.h"
#include "rivals/reference_tree.h"

PYBIND11_MODULE(rayleaf_rivals, module) {
    using rayleaf::ReferenceTree;
    module.doc() = "What Rayleaf is measured against: the published tree, Embree's facets, image planes.";
    pybind11::module_::import("rayleaf._core");  // its types are bases and arguments here
    rayleaf::bind_tree<ReferenceTree>(module, "ReferenceTree",
                                      "The ray interpolant tree as published. One thread at a time.");
    rayleaf::bind_baseline(module);
    rayleaf::bind_rivals(module);
}
