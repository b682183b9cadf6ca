"""Cryptomatte: what a pixel shows, and how much of it; the same bits however it is rendered."""

import json
import struct

import numpy as np
import pytest
from path_scenes import material, render, varied_scene, veil
from scenes import look_down, matrix, quad

KINDS = ("object", "material", "asset")
PAIRS = [f"crypto_{kind}_{pair:02d}" for kind in KINDS for pair in range(3)]


def id_of(name):
    """The float of a name, by the definition of MurmurHash3 (32 bits, seed 0) and of Cryptomatte's floats."""
    rotate = lambda x, by: (x << by | x >> (32 - by)) & 0xFFFFFFFF
    text, value = name.encode(), 0
    for start in range(0, len(text), 4):
        block = text[start : start + 4]
        k = rotate(int.from_bytes(block, "little") * 0xCC9E2D51 & 0xFFFFFFFF, 15) * 0x1B873593 & 0xFFFFFFFF
        value ^= k
        if len(block) == 4:
            value = (rotate(value, 13) * 5 + 0xE6546B64) & 0xFFFFFFFF
    value ^= len(text)
    for shift, factor in ((16, 0x85EBCA6B), (13, 0xC2B2AE35)):
        value = (value ^ value >> shift) * factor & 0xFFFFFFFF
    value ^= value >> 16
    exponent = min(max(value >> 23 & 255, 1), 254)
    bits = value & ~(255 << 23) | exponent << 23
    return np.float32(struct.unpack("<f", struct.pack("<I", bits))[0]), value


def shares(session, kind, pairs=3):
    """By id: the share of each pixel."""
    found = {}
    for pair in range(pairs):
        pixels = session.pass_pixels(f"crypto_{kind}_{pair:02d}")
        for rank in (0, 1):
            ids, weights = pixels[..., 2 * rank], pixels[..., 2 * rank + 1]
            for value in np.unique(ids[weights > 0]):
                share = found.setdefault(value, np.zeros(ids.shape))
                share += np.where(ids == value, weights, 0)
    return found


def two_halves(core):
    """A quad over the left half of the picture, another below all of it; names of a group, of several bytes."""
    scene = core.SceneDescription()
    floor = material(core, scene, ("diffuse", 1.0, 0.5), name="Floor")
    scene.add_instance("Plane", quad(scene, "floor", 20), matrix(), floor, asset="Räume")
    scene.add_instance("Plane.001", quad(scene, "left", 20), matrix((-20, 0, 1)), -1)
    look_down(scene, height=5, half=0.4)
    return scene


def test_ids_are_cryptomattes_hashes_of_names_and_shares_cover_the_picture(core):
    session = render(core, two_halves(core), size=16, passes=["combined", *PAIRS])
    wanted = {
        "object": ("Plane", "Plane.001"),
        "material": ("Floor", "default_surface"),
        "asset": ("Räume", "Plane.001"),
    }
    for kind, names in wanted.items():
        found = shares(session, kind)
        assert set(found) == {id_of(name)[0] for name in names}
        np.testing.assert_allclose(sum(found.values()), 1.0, atol=1e-6)
        left = found[id_of(names[1])[0]]
        assert np.all(left[:, :6] == 1) and np.all(left[:, 10:] == 0)


def test_the_manifest_names_every_id(core):
    scene = two_halves(core)
    scene.add_instance('a "b" \\ c', quad(scene, "odd", 1), matrix((0, 0, -3)))
    attributes = scene.matte_attributes("OBJECT", "ViewLayer.CryptoObject")
    key = f"cryptomatte/{id_of('ViewLayer.CryptoObject')[1]:08x}"[: len("cryptomatte/") + 7]
    assert attributes[f"{key}/name"] == "ViewLayer.CryptoObject"
    assert attributes[f"{key}/hash"] == "MurmurHash3_32" and attributes[f"{key}/conversion"] == "uint32_to_float32"
    names = json.loads(attributes[f"{key}/manifest"])
    assert names == {name: f"{id_of(name)[1]:08x}" for name in ("Plane", "Plane.001", 'a "b" \\ c')}


def test_what_is_seen_through_shares_a_pixel_with_what_lies_behind(core):
    scene = core.SceneDescription()
    scene.add_instance("behind", quad(scene, "behind", 20), matrix(), material(core, scene, ("diffuse", 1.0, 0.5)))
    half = veil(core, scene, 0.75, ("diffuse", 0.25, 0.5))
    scene.add_instance("veil", quad(scene, "veil", 20), matrix((0, 0, 1)), half)
    look_down(scene, height=5)
    session = render(core, scene, samples=1024, passes=["combined", *PAIRS])
    found = shares(session, "object")
    assert found[id_of("veil")[0]].mean() == pytest.approx(0.25, abs=1e-6)
    assert found[id_of("behind")[0]].mean() == pytest.approx(0.75, abs=0.01)


@pytest.mark.parametrize("integrator", ["PATH", "DISTRIBUTION"])
def test_mattes_have_the_same_bits_for_any_threads_tiles_streams_and_rounds(core, integrator):
    def pixels(**settings):
        settings = dict(size=20, samples=12, integrator=integrator, passes=["combined", *PAIRS]) | settings
        session = render(core, varied_scene(core), **settings)
        return [session.pass_pixels(name).tobytes() for name in PAIRS]

    first = pixels(threads=1)
    assert pixels(threads=7, tile_size=8) == first
    assert pixels(stream_paths=0) == first
    assert pixels(time_limit=1e6) == first  # in rounds


def test_parts_put_together_have_the_mattes_of_the_whole(core):
    passes = ["combined", *PAIRS]
    whole = render(core, varied_scene(core), size=12, samples=10, passes=passes)
    merged = core.FilmSums(12, 12, passes)
    for first, count in ((4, 6), (0, 4)):
        part = render(core, varied_scene(core), size=12, samples=10, passes=passes, keep_sums=True,
                      first_sample=first, sample_count=count)  # fmt: skip
        merged.add(0, 0, count, part.sums())
    for name in passes:
        assert np.array_equal(merged.pass_pixels(name), whole.pass_pixels(name)), name


def test_bad_sums_of_mattes_are_rejected(core):
    part = render(core, two_halves(core), size=4, samples=1, passes=["combined", "crypto_object_00"], keep_sums=True)
    merged = core.FilmSums(4, 4, ["combined", "crypto_object_00"])
    sums = dict(part.sums())
    mattes = sums.pop("mattes_object")
    with pytest.raises(core.InputError, match="mattes_object"):
        merged.add(0, 0, 1, sums)
    for bad in (-1.0, 0.5, np.nan, 1e30):
        spoiled = mattes.copy()
        spoiled[1, 2, 0, 1] = bad
        with pytest.raises(core.InputError, match="mattes_object"):
            merged.add(0, 0, 1, {**sums, "mattes_object": spoiled})
    merged.add(0, 0, 1, {**sums, "mattes_object": mattes})


def test_many_objects_in_a_pixel_are_ranked_by_their_shares(core):
    scene = core.SceneDescription()
    shape = quad(scene, "strip", 1.0)
    widths = [0.5, 0.25, 0.125, 0.0625, 0.0625]
    start = -0.5
    for number, width in enumerate(widths):
        place = np.diag([width / 2, 10.0, 1.0, 1.0]).copy()
        place[0, 3] = start + width / 2
        scene.add_instance(f"strip {number}", shape, place)
        start += width
    look_down(scene, height=1, half=0.5)
    session = render(core, scene, size=1, samples=4096, passes=["combined", *PAIRS])
    ranked = np.concatenate([session.pass_pixels(f"crypto_object_{i:02d}")[0, 0] for i in range(3)]).reshape(-1, 2)
    assert np.all(np.diff(ranked[:, 1]) <= 0)
    assert list(ranked[:3, 0]) == [id_of(f"strip {i}")[0] for i in range(3)]
    np.testing.assert_allclose(ranked[:5, 1], widths, atol=0.01)
    assert np.array_equal(ranked[5], [0, 0])
