"""What the built module shows to the process it is loaded into."""

import subprocess


def test_the_module_exports_its_init_function_and_nothing_else(addons):
    (module,) = (addons / "rayleaf").glob("_core.*.so")
    listing = subprocess.run(
        ["nm", "-D", "--defined-only", str(module)], check=True, capture_output=True, text=True
    ).stdout
    assert [line.split()[-1] for line in listing.splitlines()] == ["PyInit__core"]
