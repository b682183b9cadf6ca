"""The report's comparison of primitives: complete, and what should be exact is."""

import pytest
from rayleaf.report import curve_primitives


@pytest.mark.slow
def test_every_primitive_is_rendered_and_ours_is_nearest_to_the_exact_tube():
    # So many pixels that the facets of ours are finer than the triangles.
    results = {each.name: (each, error, outline) for each, error, outline in curve_primitives.measured(192, 2, 1)}
    assert list(results) == list(curve_primitives.primitives())
    assert results["exact tube"][1].maximum == 0.0
    errors = {name: error.mean_rgb for name, (_, error, _) in results.items()}
    # A ribbon has one normal across; facets are coarser than the patch, whose facets follow from the picture's pixels.
    assert errors["swept patch"] < errors["tube of triangles"] < errors["ribbon"], errors
    memory = {name: each.memory for name, (each, _, _) in results.items()}
    assert memory["swept patch"] < memory["tube of quads"] <= memory["tube of triangles"], memory
    assert all(each.build > 0 and each.render > 0 for each, _, _ in results.values())


@pytest.mark.slow
def test_the_section_names_every_primitive_and_shows_its_picture():
    text = curve_primitives.section(32, 1, 1)
    assert all(f"<figcaption>{name}</figcaption>" in text for name in ("exact tube", "ribbon", "swept patch"))
    assert "55 min 8 s" in text and text.count("data:image/png") == len(curve_primitives.primitives())
