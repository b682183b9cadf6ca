"""Walks a node tree from its output and writes the operations its nodes stand for."""

import math
from collections.abc import Callable
from dataclasses import replace
from functools import cached_property, partial
from typing import Any

from ... import versions
from ...messages import Messages, Subject
from ...names import name_of
from .emitter import UNCONNECTED, Emitter, Register
from ..mesh_derived import REST_PLACE
from .graph import Links, Path, Shader, is_group, key_of, output_of
from .resources import Resources
from .trees import name_in_file

_OF_BOTH = {"ShaderNodeEmission", "ShaderNodeBsdfPrincipled"}  # surfaces and volumes
_SCALARS = {"VALUE", "INT", "BOOLEAN"}


class NodeView:
    """A node as the functions that compile it see it: its inputs as registers."""

    def __init__(self, compiler: "Compiler", node: Any, path: Path) -> None:
        self.compiler, self.node, self._path = compiler, node, path
        self.emitter, self.resources = compiler.emitter, compiler.resources

    @cached_property
    def _sockets(self) -> tuple[dict[str, Any], dict[str, Any]]:
        """The inputs by identifier and by name; of those that share one, the first."""
        by_identifier: dict[str, Any] = {}
        by_name: dict[str, Any] = {}
        for socket in self.node.inputs:
            by_identifier.setdefault(socket.identifier, socket)
            by_name.setdefault(name_of(socket), socket)
        return by_identifier, by_name

    def socket(self, *names: str) -> Any:
        """The input of the first of these identifiers, or names, that the node has; None if it has none."""
        return next((sockets[name] for sockets in self._sockets for name in names if name in sockets), None)

    def input(self, *names: str, default: float = 0.0) -> Register:
        """An input's value; `default` where this version of the node has no such input."""
        socket = self.socket(*names)
        return self.emitter.scalar(default) if socket is None else self.compiler.input(socket, self._path)

    def linked(self, *names: str) -> Register:
        """A linked input's value; unconnected where nothing is linked."""
        socket = self.socket(*names)
        if socket is None or self.compiler.links.feeding(socket, self._path) is None:
            return UNCONNECTED
        return self.compiler.input(socket, self._path)

    def normal(self, *names: str) -> Register:
        """A linked normal; without a link the one that the material's displacement bends, if it does."""
        register = self.linked(*names)
        return self.compiler.bent_normal if register == UNCONNECTED else register

    def vector(self, *names: str) -> Register:
        """A linked vector; without a link the texture coordinate that Blender takes: Generated."""
        register = self.linked(*names)
        return self.compiler.generated() if register == UNCONNECTED else register

    def place(self, *names: str) -> Register:
        """A linked place; without a link the point that is shaded."""
        register = self.linked(*names)
        return self.emitter.operation("position") if register == UNCONNECTED else register

    def warn(self, text: str) -> None:
        """Tell about this node."""
        self.compiler.warn(self.node, text)


ValueFunction = Callable[[NodeView, str], Register]
ClosureFunction = Callable[[NodeView, Register], None]
VALUE_NODES: dict[str, ValueFunction] = {}
CLOSURE_NODES: dict[str, ClosureFunction] = {}
VOLUME_NODES: dict[str, ClosureFunction] = {}


def value_node(*identifiers: str) -> Callable[[ValueFunction], ValueFunction]:
    """Registers the function that compiles one output, by identifier, of these nodes."""

    def keep(function: ValueFunction) -> ValueFunction:
        for identifier in identifiers:
            VALUE_NODES[identifier] = function
        return function

    return keep


def _writer(table: dict[str, ClosureFunction], identifiers: tuple[str, ...]) -> Callable[..., ClosureFunction]:
    def keep(function: ClosureFunction) -> ClosureFunction:
        table.update(dict.fromkeys(identifiers, function))
        return function

    return keep


def closure_node(*identifiers: str) -> Callable[[ClosureFunction], ClosureFunction]:
    """Registers the function that writes these nodes' closures with a weight."""
    return _writer(CLOSURE_NODES, identifiers)


def volume_node(*identifiers: str) -> Callable[[ClosureFunction], ClosureFunction]:
    """Registers the function that writes what these nodes do inside a volume."""
    return _writer(VOLUME_NODES, identifiers)


def _warn(owner: Subject, messages: Messages, node: Any, text: str) -> None:
    subject = replace(owner, node=name_in_file(node))
    messages.warn(f"{subject}: {text}", subject)


class Compiler:
    """Compiles one material's or world's tree."""

    def __init__(
        self,
        emitter: Emitter,
        subject: Subject,
        resources: Resources,
        messages: Messages,
        is_world: bool = False,
        displaces: bool = False,
    ) -> None:
        """`subject` names the tree's owner in messages; `displaces`: the vector that is compiled moves points."""
        from . import load_nodes

        load_nodes()
        self.emitter, self.resources, self.is_world, self._displaces = emitter, resources, is_world, displaces
        self._is_volume, self.is_lamp = False, subject.kind == "Light"
        self.lamp_owner: Any = None  # lamps.LampOwner, of a lamp
        self.reads_grids = False  # what is compiled fills an object that grids are of
        # Tells about a node, once. No method: `links` keeps it, and a reference cycle would hold what was exported.
        self.warn: Callable[[Any, str], None] = partial(_warn, subject, messages)
        # What stands for the surface's normal, where displacement is bump only.
        self.bent_normal: Register = UNCONNECTED
        # What functions raise where a node is in a mode that they, or the core, do not know.
        self._unknown = (emitter.rejected, LookupError, ValueError, AttributeError)
        self.links = Links(self.warn)
        self._done: dict[Any, Register] = {}
        self._open: set[Any] = set()

    def bend_normal(self, normal: Register) -> None:
        """From now on this stands for the surface's normal."""
        self.bent_normal = normal
        self._done.clear()

    # --- values ------------------------------------------------------------------------------------------------------

    def input(self, socket: Any, path: Path) -> Register:
        """The value that arrives at an input, converted to its type."""
        link = self.links.feeding(socket, path)
        if link is None:
            return self._default(socket)
        return self._convert(self.output(link.from_socket, path), link.from_socket.type, socket.type)

    def output(self, socket: Any, path: Path) -> Register:
        """The value of an output."""
        node = socket.node
        key = key_of(socket, path)
        if key in self._done:
            return self._done[key]
        if key in self._open:
            self.warn(node, "nodes form a loop; the link that closes it is ignored")
            return self._neutral(socket)
        self._open.add(key)
        try:
            self._done[key] = self._compute(socket, path)
        finally:
            self._open.discard(key)
        return self._done[key]

    def _compute(self, socket: Any, path: Path) -> Register:
        forward = self.links.forward(socket, path)
        if forward is not None:
            return self._passed_on(socket, *forward)
        node = socket.node
        function = VALUE_NODES.get(node.bl_idname)
        if function is None:
            return self._stand_in(socket, path, f"{node.bl_label} nodes are not supported")
        try:
            return function(NodeView(self, node, path), socket.identifier)
        except self._unknown as error:
            return self._stand_in(socket, path, f"a mode of it is not supported ({error})")

    def _passed_on(self, socket: Any, source: Any, path: Path) -> Register:
        """The value of an output that passes on an input, or none."""
        if source is None:
            return self.emitter.scalar(0.0) if is_group(socket.node) else self._neutral(socket)
        if socket.node.mute and self.links.feeding(source, path) is None:
            return self.emitter.scalar(0.0)
        return self._convert(self.input(source, path), source.type, socket.type)

    def _default(self, socket: Any) -> Register:
        value = getattr(socket, "default_value", None)
        if value is None or isinstance(value, str):
            return self.emitter.scalar(0.0)
        numbers = [float(value)] * 4 if socket.type in _SCALARS else [float(number) for number in value]
        if not all(map(math.isfinite, numbers)):
            self.warn(socket.node, f"its input {name_of(socket)} is not a finite number; taken as 0")
            return self.emitter.scalar(0.0)
        return self.emitter.constant(*numbers, *[0.0] * (3 - len(numbers)))  # since 5.0 some vectors have two numbers

    def _stand_in(self, socket: Any, path: Path, why: str) -> Register:
        """For an output that cannot be computed: an input of its type, else something neutral."""
        source = self._like(socket)
        if source is None:
            self.warn(socket.node, f"{why}; a neutral value is used")
            return self._neutral(socket)
        self.warn(socket.node, f"{why}; its input {name_of(source)} is passed on")
        return self.input(source, path)

    def _like(self, socket: Any) -> Any:
        """The input that comes nearest to an output: linked, or a colour or vector that a user has written."""
        node = socket.node
        inputs = [each for each in node.inputs if each.type == socket.type and each.enabled]
        if socket.type == "VALUE" and node.bl_idname.startswith("ShaderNodeTex"):
            return None  # a scale or a detail
        linked = next((each for each in inputs if self.links.into(each) is not None), None)
        written = (each for each in inputs if each.type in ("RGBA", "VECTOR") and not each.hide_value)
        return next(written, None) if linked is None else linked

    def _neutral(self, socket: Any) -> Register:
        """The normal, a texture coordinate (for displacement: nowhere), grey, or the middle of 0..1."""
        if socket.type == "VECTOR" and "ormal" in name_of(socket):
            return self.emitter.operation("normal")
        if socket.type == "VECTOR":
            return self.emitter.scalar(0.0) if self._displaces else self.generated()
        return self.emitter.scalar(0.5)

    def generated(self) -> Register:
        """The place in the object's texture space; shapes that are deformed carry where they were before."""
        if not self.is_world and not self.is_lamp:
            self.resources.attribute(REST_PLACE)
        return self.emitter.operation("generated")

    def _convert(self, register: Register, from_type: str, to_type: str) -> Register:
        """Blender's implicit conversions. A number stands in all four floats, so it is a vector and a grey already."""
        if to_type in _SCALARS and from_type == "RGBA":
            return self.emitter.operation("luminance", [register])
        if to_type in _SCALARS and from_type == "VECTOR":
            return self.emitter.operation("average", [register])
        return register

    # --- closures ----------------------------------------------------------------------------------------------------

    def compile_tree(self, tree: Any) -> bool:
        """Write the closures of a tree's output; False where nothing is linked and there are none."""
        if self.resources.aovs and not self.is_lamp:
            self._write_aovs(tree, ())
        return self._compile_input(tree, "Surface")

    def compile_volume(self, tree: Any) -> bool:
        """Write what fills the space behind the surface; False where nothing does."""
        self._is_volume = True
        return self._compile_input(tree, "Volume")

    def _compile_input(self, tree: Any, name: str) -> bool:
        output = output_of(tree)
        socket = None if output is None else output.inputs.get(name)
        source = None if socket is None else self._shader_source(socket, ())
        if source is not None:
            self._write_closures(source)
        return source is not None

    def _write_aovs(self, tree: Any, path: Path) -> None:
        """Write what a tree, groups included, sends to the passes that a view layer asks for by name."""
        for node in tree.nodes:
            if node.mute:
                continue
            if node.bl_idname == "ShaderNodeOutputAOV" and (name := versions.aov_name(node)) in self.resources.aovs:
                slot, is_color = self.resources.aovs[name]
                value = NodeView(self, node, path).input("Color" if is_color else "Value")
                self.emitter.operation("aov", [value], [slot])
            elif is_group(node) and node.node_tree is not None:
                self._write_aovs(node.node_tree, (*path, node))

    def _shader_source(self, socket: Any, path: Path) -> tuple[Any, Path] | None:
        """The output that feeds a shader input, past everything that merely passes it on."""
        seen = set()
        while True:
            link = self.links.into(socket)
            if link is None:
                return None
            source = link.from_socket
            forward = self.links.forward(source, path)
            if forward is None or source.type != "SHADER":
                return source, path
            key = key_of(source, path)
            if key in seen:
                self.warn(source.node, "nodes form a loop; the link that closes it is ignored")
                return None
            seen.add(key)
            socket, path = forward
            if socket is None:
                return None

    def _write_closures(self, source: tuple[Any, Path]) -> None:
        """Give each shader node the sum of its weights over all ways that lead to it, and write it once."""
        order: list[Shader] = []
        root = self._sorted(source, {}, set(), order)
        if root is None:
            return
        weights = {root.key: self.emitter.scalar(1.0)}
        for shader in reversed(order):  # users come before what they use
            weight = weights[shader.key]
            known = self.emitter.value_of(weight)
            if known is not None and known[0] <= 0.0:
                weights.update({used.key: weights.get(used.key, weight) for used in shader.uses if used is not None})
                continue
            for used, share in zip(shader.uses, self._shares(shader), strict=True):
                if used is not None:
                    part = self.emitter.multiply(weight, share)
                    old = weights.get(used.key)
                    weights[used.key] = part if old is None else self.emitter.add(old, part)
            if not shader.uses:
                self._write_leaf(shader, weight)

    def _sorted(
        self, source: tuple[Any, Path], known: dict[Any, Shader], open_keys: set[Any], order: list[Shader]
    ) -> Shader | None:
        """Depth first; `order` receives each shader after what it uses. None where a loop closes."""
        socket, path = source
        key = key_of(socket, path)
        if key in open_keys:
            self.warn(socket.node, "nodes form a loop; the link that closes it is ignored")
            return None
        if key in known:
            return known[key]
        shader = known[key] = Shader(key, socket, path)
        open_keys.add(key)
        if socket.type == "SHADER" and socket.node.bl_idname in ("ShaderNodeMixShader", "ShaderNodeAddShader"):
            for shader_input in [s for s in socket.node.inputs if s.type == "SHADER"]:
                used = self._shader_source(shader_input, path)
                shader.uses.append(None if used is None else self._sorted(used, known, open_keys, order))
        open_keys.discard(key)
        order.append(shader)
        return shader

    def _shares(self, shader: Shader) -> list[Register]:
        """The factor on each shader that a Mix or Add Shader uses."""
        one = self.emitter.scalar(1.0)
        if shader.socket.node.bl_idname != "ShaderNodeMixShader":
            return [one] * len(shader.uses)
        factor = self.emitter.saturate(NodeView(self, shader.socket.node, shader.path).input("Fac", "Factor"))
        return [self.emitter.complement(factor), factor]

    def _write_leaf(self, shader: Shader, weight: Register) -> None:
        node = shader.socket.node
        if shader.socket.type != "SHADER":  # a value where a shader is wanted shines
            color = self._convert(self.output(shader.socket, shader.path), shader.socket.type, "RGBA")
            kind = "background" if self.is_world and not self._is_volume else "emission"
            self.emitter.operation(kind, [weight, color, self.emitter.scalar(1.0)])
            return
        view = NodeView(self, node, shader.path)
        if (node.bl_idname in VOLUME_NODES) != self._is_volume and node.bl_idname not in _OF_BOTH:
            return  # in Cycles, what is for surfaces does nothing inside, nor what is for volumes outside
        function = (VOLUME_NODES if self._is_volume else CLOSURE_NODES).get(node.bl_idname)
        why = f"{node.bl_label} nodes are not supported"
        if function is not None:
            try:
                function(view, weight)
                return
            except self._unknown as error:
                why = f"a mode of it is not supported ({error})"
        self.warn(node, f"{why}; rendered diffuse")
        color = view.input("Color", "Base Color", default=0.8)
        if not self.is_world:
            self.emitter.operation("diffuse", [weight, color])
