"""What people are told where the compiled core cannot be loaded, as far as that needs no Blender."""

import pytest
from rayleaf import core_module


@pytest.fixture
def raised(monkeypatch):
    """The sentence for an import that fails."""

    def sentence(error):
        def fail(_name):
            raise error

        monkeypatch.setattr(core_module.importlib, "import_module", fail)
        with pytest.raises(core_module.CoreError) as caught:
            core_module.load()
        return str(caught.value)

    return sentence


@pytest.mark.parametrize(
    ("error", "sentence"),
    [
        ("Rayleaf's core needs NumPy: No module named 'numpy'", "Install it; in Debian, the package python3-numpy."),
        ("/x.so: version `GLIBC_2.99' not found (required by y)", "its C library (glibc) lacks GLIBC_2.99"),
        ("/x.so: version `GLIBCXX_3.9' not found (required by y)", "its C++ library (libstdc++) lacks GLIBCXX_3.9"),
        ("libtbb.so.12: cannot open shared object file: No such file", "library libtbb.so.12 is missing"),
        ("/x.so: file too short", "damaged. Install Rayleaf's zip again"),
        ("what nobody foresaw", "cannot be loaded: what nobody foresaw"),
    ],
)
def test_each_reason_has_its_sentence(raised, error, sentence):
    assert sentence in raised(ImportError(error))


def test_a_processor_that_is_too_old_is_told_of_before_it_meets_an_instruction_it_lacks(monkeypatch):
    monkeypatch.setattr(core_module, "_processor_flags", lambda: {"fpu", "sse2", "ssse3"})
    with pytest.raises(core_module.CoreError, match="too old for Rayleaf, which needs SSE4.2"):
        core_module.load()


@pytest.mark.parametrize("machine", [("Darwin", "arm64"), ("Windows", "AMD64"), ("Linux", "aarch64")])
def test_another_machine_is_told_what_the_package_is_for(monkeypatch, machine):
    for name, value in zip(("system", "machine"), machine):
        monkeypatch.setattr(core_module.platform, name, lambda value=value: value)
    with pytest.raises(core_module.CoreError, match=f"for Linux on x86-64, and this is {machine[0]} on {machine[1]}"):
        core_module.load()


def test_a_processor_without_avx2_renders_the_same_bits(core, any_target):
    """Kernels are chosen at run time; the least needs what is asked for at loading, and no more."""
    import numpy as np
    import scenes

    scene = scenes.small_scene(core)
    pictures = []
    for target in ("SSE4", ""):
        core.trace.use_simd_target(target)
        pictures.append(scenes.render(core, scene)["combined"])
    assert np.array_equal(*pictures)
