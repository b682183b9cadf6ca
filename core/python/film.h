// The film's numbers as NumPy arrays.
#pragma once

#include "film/film_sums.h"
#include "python/bindings.h"

namespace rayleaf {

/// A pass as an array that owns its numbers: (row, column, channel).
py::array_t<float> array_of(std::vector<float>&& pixels, int width, int height, Pass pass);

/// What `FilmSums.add` of the bindings takes: (row, column, channel, term).
py::array_t<double> sums_of(const FilmSums& film, Pass pass);

/// Adds the mattes of each kind to it, as `FilmSums.add` takes them: (row, column, entry, id and weight).
void add_mattes(const FilmSums& film, py::dict& sums);

}  // namespace rayleaf
