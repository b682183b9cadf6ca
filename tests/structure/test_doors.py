"""One door for each third party: its headers and calls appear in the named folders alone."""

import pytest
from structure.sources import CORE, core_files, matches

DOORS = {
    "Embree": (r"<embree\d*/|\brtc[A-Z]\w+\s*\(", {"trace"}),
    "OpenImageIO": (r"<OpenImageIO/|\bOIIO(_NAMESPACE)?::", {"textures", "film"}),
    "OpenSubdiv": (r"<opensubdiv/|\bOpenSubdiv::", {"geometry"}),
    "OpenVDB": (r"<openvdb/|\bopenvdb::", {"geometry"}),
    "Open Image Denoise": (r"\bdlopen\s*\(|\"oidn[A-Z]", {"render"}),
    "pybind11": (r"<pybind11/|\bpybind11::|\bpy::|<Python\.h>", {"python"}),
}


@pytest.mark.parametrize("library", DOORS)
def test_a_library_is_met_at_its_door_only(library):
    pattern, folders = DOORS[library]
    outside = [path for path in core_files() if path.relative_to(CORE).parts[0] not in folders]
    assert matches(outside, pattern) == []
