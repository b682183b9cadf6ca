// Interference in a transparent film on a surface: Belcour, Barla, "A Practical Extension to Microfacet Theory for the
// Modeling of Varying Iridescence", SIGGRAPH 2017. Light that crosses the film there and back once, twice, ... is
// behind by a multiple of one optical path. Each of Airy's terms is a cosine over wavelengths, and what the eye makes
// of it is the Fourier transform of its sensitivities (section 4.2), so that no spectrum is sampled.
//
// Departures, which are Cycles': three terms; films below a nanometre fade; metals that are given by colours have the
// index that Gulbrandsen, "Artist Friendly Metallic Fresnel", JCGT 3(4), 2014, gives them, for the phase; seen from
// within glass, wavelengths are those of a vacuum.
#pragma once

#include "base/vector.h"
#include "shading/closures.h"

namespace rayleaf {

/// Reflectances seen under `cosine` through a film, on a dielectric (`ior` over that on the viewer's side), on a
/// conductor, and on a metal as of metal_fresnel (shading/fresnel.h).
Color film_on_dielectric(const ThinFilm& film, float ior, float cosine);
Color film_on_conductor(const ThinFilm& film, const Color& index, const Color& extinction, float cosine);
Color film_on_metal(const ThinFilm& film, const Color& fresnel_0, const Color& dip, float cosine);

}  // namespace rayleaf
