"""Every node that Rayleaf supports is compared with Cycles, in every mode and by every socket, or named here with a reason."""

from pathlib import Path

import pytest
from measured_nodes import keep_node

pytestmark = pytest.mark.nodes

SCRIPT = Path(__file__).parent / "node_inventory.py"
# What no comparison has: node -> modes, "input NAME" and "output NAME", each with the reason.
NOT_COMPARED = {
    "ShaderNodeAttribute": dict.fromkeys(
        ("attribute_type=INSTANCER", "attribute_type=VIEW_LAYER"), "compared by test_instancer_attributes_oracle.py"
    ),
    "ShaderNodeBump": {"input Filter Width": "compared by test_bent_normals_oracle.py"},
    "ShaderNodeMixRGB": {"use_alpha=True": "of the compositor's node, which shares the definition"},
    "ShaderNodeBsdfPrincipled": {
        "input Transmission Dispersion Scale": "named by a message where it is not 0",
        "input Transmission Dispersion Abbe Number": "named with the scale",
    },
    "ShaderNodeBsdfGlass": {
        "input Anisotropy": "named by a message where it is not 0",
        **dict.fromkeys(("input Rotation", "input Tangent"), "named with the anisotropy"),
    },
}


# What else holds that a node is right.
ELSEWHERE = {
    "ShaderNodeOutputAOV": "its passes are compared by test_passes_oracle.py",
    **dict.fromkeys(("ShaderNodeGroup", "NodeGroupInput", "NodeGroupOutput", "NodeReroute"), "test_export_nodes.py"),
    **{f"ShaderNodeOutput{kind}": "part of every comparison" for kind in ("Material", "World", "Light")},
    "ShaderNodeOutputLineStyle": "Freestyle's, which draws lines of its own",
    "NodeFrame": "has no sockets",
}


def gaps(node, comparisons):
    """The modes and sockets of a supported node that no case has. A mode that a message names is none."""
    wanted = {f"{path}={value}" for path, values in node["modes"].items() for value in values} - set(node["told_of"])
    wanted |= {f"input {name}" for name in node["inputs"]} | {f"output {name}" for name in node["outputs"]}
    for case in comparisons:
        wanted -= {f"{path}={value}" for path, value in case["modes"].items()}
        wanted -= {f"input {name}" for name in case["inputs"]}
        wanted.discard(f"output {case['output']}")
    return wanted


def test_every_supported_node_is_compared_with_cycles_and_others_are_named(run_blender):
    run = run_blender(SCRIPT).report
    by_node = {}
    for cases in run["compared"].values():
        for case in (case for each in cases.values() for case in each):
            by_node.setdefault(case["node"], []).append(case)
    assert sum(node["use"] == "supported" for node in run["nodes"]) > 80
    missing, silent = {}, []
    for node in run["nodes"]:
        known = NOT_COMPARED.get(node["node"], {})
        keep_node({**node, "not_compared": known, "elsewhere": ELSEWHERE.get(node["node"], "")})
        if node["use"] == "supported" and (found := gaps(node, by_node.get(node["node"], ())) - set(known)):
            missing[node["node"]] = sorted(found)
        if node["use"] == "left out" and node["outputs"] and not node["told"]:
            silent.append(node["node"])
    assert (missing, silent) == ({}, [])
