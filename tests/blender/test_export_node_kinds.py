"""Every kind of node in every mode, against the core's own table of operations; the nodes of later versions of Blender."""

import pytest

EVERY_NODE = """
import itertools
from rayleaf import _core
from rayleaf.export.nodes import compiler, load_nodes
from rayleaf.export.nodes.emitter import Emitter
from rayleaf.messages import Messages, Subject

load_nodes()
scene = scenes.empty_scene()
image = bpy.data.images.new("Picture", 4, 4)

class Images:
    def texture(self, image, user, frame):
        return 0

def variants(node):
    "The node with each value of each of its own enumerations in turn."
    yield ""
    base = {p.identifier for p in bpy.types.ShaderNode.bl_rna.properties}
    for prop in node.bl_rna.properties:
        if prop.identifier in base or prop.type != "ENUM" or prop.is_readonly:
            continue
        for choice in prop.enum_items:
            try:
                setattr(node, prop.identifier, choice.identifier)
            except TypeError:  # for geometry nodes alone
                continue
            yield f"{prop.identifier}={choice.identifier}"
        setattr(node, prop.identifier, prop.default)

def is_known(kind):
    "Old nodes leave Blender: HSV in 5.0, Musgrave in 4.1."
    return hasattr(bpy.types, kind)

failures, count = [], 0
kinds = {*compiler.VALUE_NODES, *compiler.CLOSURE_NODES, "ShaderNodeMixShader", "ShaderNodeAddShader"}
for kind in sorted(filter(is_known, kinds)):
    material, tree, output = scenes.material()
    node = tree.nodes.new(kind)
    if hasattr(node, "image"):
        node.image = image
    for variant in variants(node):
        for socket in [s for s in node.outputs if s.enabled]:
            tree.links.new(socket, output.inputs["Surface"])
            messages = Messages()
            try:
                emitter = Emitter(_core, "Material")
                resources = compiler.Resources(lambda name: 3, Images(), 1)
                compiler.Compiler(emitter, Subject("Material", "Material"), resources, messages).compile_tree(tree)
                if any("a mode of it" in text for text in messages.texts):
                    failures.append(f"{kind} {variant} {socket.identifier}: {messages.texts}")
            except Exception as error:
                failures.append(f"{kind} {variant} {socket.identifier}: {type(error).__name__}: {error}")
            count += 1
report(failures=failures, count=count)
"""


def test_the_core_accepts_what_every_node_compiles_to_in_every_mode(run_blender):
    run = run_blender("import bpy, scenes\n" + EVERY_NODE).report
    assert run["failures"] == []
    assert run["count"] > 250


PRINCIPLED_OF_4 = """
from types import SimpleNamespace
from rayleaf.export.nodes import compiler, load_nodes
from rayleaf.export.nodes.emitter import UNCONNECTED, Emitter

load_nodes()

class View:
    "A Principled node with the sockets of Blender 4, none linked."
    sockets = {
        "Base Color": (0.8, 0.8, 0.8, 1), "Metallic": 0, "Roughness": 0.5, "IOR": 2, "Alpha": 1, "Subsurface Weight": 0,
        "Specular IOR Level": 0.5, "Specular Tint": (1, 1, 1, 1), "Anisotropic": 0, "Anisotropic Rotation": 0,
        "Transmission Weight": 0.125, "Coat Weight": 0.25, "Coat Roughness": 0.375, "Coat IOR": 1.5,
        "Coat Tint": (0.75, 1, 1, 1), "Sheen Weight": 0.625, "Sheen Roughness": 0.875, "Sheen Tint": (1, 1, 1, 1),
        "Emission Color": (1, 0.5, 0.25, 1), "Emission Strength": 3, "Thin Film Thickness": 200, "Thin Film IOR": 1.25,
    }
    node = SimpleNamespace(distribution="GGX")

    def __init__(self, core):
        self.emitter, self.texts = Emitter(core, "Material"), []
        self.resources = SimpleNamespace(active_uv=lambda: -1)

    def socket(self, *names):
        found = next((self.sockets[name] for name in names if name in self.sockets), None)
        return None if found is None else SimpleNamespace(type="RGBA" if isinstance(found, tuple) else "VALUE", value=found)

    def input(self, *names, default=0.0):
        socket = self.socket(*names)
        value = default if socket is None else socket.value
        return self.emitter.constant(*value) if isinstance(value, tuple) else self.emitter.scalar(value)

    def linked(self, *names):
        return UNCONNECTED

    def normal(self, *names):
        return UNCONNECTED

    def warn(self, text):
        self.texts.append(text)

view = View(recording_core.install())
compiler.CLOSURE_NODES["ShaderNodeBsdfPrincipled"](view, view.emitter.scalar(1))
program = view.emitter.program
line = program.line("principled_layers")
report(operands=program.operands(line), ints=line["ints"], texts=view.texts)
"""


def test_principled_of_blender_4_becomes_layers(run_blender):
    run = run_blender("import recording_core\n" + PRINCIPLED_OF_4).report
    operands = [None if value is None else value[0] for value in run["operands"]]
    body, sheen, coat = [1, 0.8, 0, 0.5, 1, 0.5, 0, 0], [0.625, 0.875, 1], [0.25, 0.375, 1.5, 0.75]
    no_subsurface, film = [None] * 4, [200, 1.25]
    assert operands == pytest.approx(
        [*body, *sheen, *coat, 1, 3, 1, 2, 0.125, None, None, None, 0, *no_subsurface, *film]
    )
    assert run["texts"] == []
