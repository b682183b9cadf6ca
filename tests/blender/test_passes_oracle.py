"""Passes that are listed by name, mist, volumes and denoisers' guides against Cycles, of the same file."""

import json
from pathlib import Path

import numpy as np
import plain_exr

HERE = Path(__file__).resolve().parent
PREFIX = "ViewLayer."
# Of the largest value: noise of both engines. What scatters in fog is noisier.
CLOSE = {
    **{("Mist", "Z"): 0.01, ("Where", "RGBA"): 0.01, ("Facing", "X"): 0.01, ("Denoising Depth", "Z"): 0.02},
    **{("Combined_warm", "RGB"): 0.03, ("Combined_cold", "RGB"): 0.03, ("Denoising Normal", "XYZ"): 0.02},
    **{("VolumeDir", "RGB"): 0.04, ("VolumeInd", "RGB"): 0.04, ("Combined", "RGBA"): 0.03},
}
NOISY = ("VolumeDir", "VolumeInd")  # compared over larger parts
MATTES = ("CryptoObject", "CryptoMaterial", "CryptoAsset")


def parts(channel, side=4):
    """Means over parts of a picture of so many pixels along a side."""
    return channel.reshape(32 // side, side, 32 // side, side).mean((1, 3))


def of_pass(channels, name, letters):
    side = 16 if name in NOISY else 4
    return np.stack([parts(channels[f"{PREFIX}{name}.{letter}"], side) for letter in letters])


def mattes(channels, name):
    """By id: the share of each pixel."""
    found = {}
    for pair in range(3):
        for id_letter, share_letter in ("rg", "ba"):
            ids = channels[f"{PREFIX}{name}{pair:02d}.{id_letter}"]
            share = channels[f"{PREFIX}{name}{pair:02d}.{share_letter}"]
            for value in np.unique(ids[share > 0]):
                found.setdefault(value.tobytes(), np.zeros(ids.shape))[ids == value] += share[ids == value]
    return found


def key_of(texts, name):
    """How the fields of a kind of mattes begin."""
    return next(key[: -len("name")] for key, text in texts.items() if key.endswith("/name") and text == PREFIX + name)


def differing_passes(cycles, own):
    """Those that are not Cycles'."""
    for (name, letters), close in CLOSE.items():
        wanted, found = (of_pass(channels, name, letters) for channels in (cycles, own))
        assert np.abs(wanted).max() > 0 or name == "Facing"
        error = np.abs(found - wanted).max() / max(np.abs(wanted).max(), 1e-3)
        if error > close:
            yield f"{name}: {error:.4f}"


def check_albedo(cycles, own, close):
    """Of what shines Cycles writes the light, here it is 1 at most."""
    wanted, found = (of_pass(channels, "Denoising Albedo", "RGB") for channels in (cycles, own))
    assert np.abs(found - np.minimum(wanted, 1)).max(0)[wanted.max(0) < 1].max() < close
    assert 0 < (wanted.max(0) >= 1).sum() <= 4  # the glowing cube


def check_mattes(cycles, own):
    for name in MATTES:
        wanted, found = mattes(cycles, name), mattes(own, name)
        assert set(found) == set(wanted), name
        for value, share in found.items():
            assert np.abs(parts(share) - parts(wanted[value])).max() < 0.02, name


def check_manifests(cycles, own):
    for name in MATTES:
        keys = key_of(cycles, name), key_of(own, name)
        assert keys[0] == keys[1]
        for field in ("hash", "conversion"):
            assert cycles[keys[0] + field] == own[keys[1] + field]
        # Cycles writes quotes in names as they are, which is no JSON.
        for each, code in json.loads(own[keys[1] + "manifest"]).items():
            assert f'"{each}":"{code}"' in cycles[keys[0] + "manifest"], each


def check_picked(own, matte):
    """What Blender's Cryptomatte node made of an object's name."""
    found = next(iter(matte.values())) if len(matte) == 1 else matte["R"]
    shares = [share for share in mattes(own, "CryptoObject").values() if np.allclose(share, found, atol=1e-3)]
    assert len(shares) == 1 and 0.02 < found.mean() < 0.2


# 5.2's, for denoisers that Rayleaf does not have.
GUIDES_OF_LATER_DENOISERS = ("ViewLayer.Denoising Specular Albedo", "ViewLayer.Denoising Roughness")
# In fog 5.0 and later give denoisers the fog's own guides (its depth where nothing is, a normal that it dims), and what
# AOVs and albedo hold of what lies behind is less.
OF_OTHER_FOG = ("Denoising Depth", "Denoising Normal", "Where: 0.04")


def test_passes_are_those_of_cycles(run_blender, tmp_path):
    run = run_blender(HERE / "passes_oracle.py", tmp_path, timeout=900)
    of_other_fog = OF_OTHER_FOG if tuple(run.report["version"]) >= (5, 0, 0) else ()
    cycles, own = (plain_exr.read(tmp_path / f"{engine}.exr") for engine in ("CYCLES", "RAYLEAF"))
    assert set(own) == {name for name in cycles if not name.startswith(GUIDES_OF_LATER_DENOISERS)}
    assert [each for each in differing_passes(cycles, own) if not each.startswith(of_other_fog)] == []
    check_albedo(cycles, own, 0.12 if of_other_fog else 0.04)
    check_mattes(cycles, own)
    check_manifests(*(plain_exr.texts(tmp_path / f"{engine}.exr") for engine in ("CYCLES", "RAYLEAF")))
    check_picked(own, plain_exr.read(tmp_path / "matte.exr"))
