"""Blender's lamps to the core's; what lights the scene of an export, lamps and world."""

import math
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import cycles_versions, versions
from ..messages import Messages, Subject
from ..names import bytes_of_name, name_of
from ..passes import Slots
from . import CancelCheck, instances, world
from .instances import VISIBLE_CAMERA, Instances
from .light_linking import LightLinks
from .nodes.compiler import Compiler
from .nodes.resources import Resources
from .nodes.emitter import Emitter
from .nodes.lamps import LampOwner, constant_emission
from .nodes.trees import shader_tree
from .random_numbers import random_of_name
from .shapes import ExportReport

# How far light of a lamp may go where nobody has limited it.
_ANY_BOUNCES = 1024
# Width of the table by which a world made of nodes is importance sampled; a plain colour needs none.
_WORLD_TABLE_WIDTH = 1024


def is_portal(lamp: Any) -> bool:
    """Whether an area lamp only shows Cycles where the world's light comes in."""
    return lamp.type == "AREA" and bool(versions.cycles_setting(lamp, "is_portal", False))


def shines(lamp: Any, matrix: NDArray[np.float64]) -> bool:
    """Whether a lamp shines at its place: one that has no direction, or an area lamp without an area, does not in Cycles."""
    if lamp.type == "POINT":
        return True
    return bool(matrix[:3, 2].any()) and (lamp.type != "AREA" or min(_sides(lamp, matrix)) > 0.0)


def _sides(lamp: Any, matrix: NDArray[np.float64]) -> tuple[float, float]:
    """Width and height of an area lamp, world units."""
    width, height = np.linalg.norm(matrix[:3, :2], axis=0)
    uneven = lamp.shape in ("RECTANGLE", "ELLIPSE")
    return float(width) * lamp.size, float(height) * (lamp.size_y if uneven else lamp.size)


def _name_ignored(lamp: Any, subject: Subject, messages: Messages) -> None:
    if versions.cycles_setting(lamp, "max_bounces", _ANY_BOUNCES) < _ANY_BOUNCES:
        messages.warn(f"{subject}: a limit of bounces of its own is not supported; it has none", subject)


def _area(lamp: Any, matrix: NDArray[np.float64]) -> float:
    """What Cycles takes for the lamp's area where its power is by area, world units squared; 1 for one without a size."""
    if lamp.type == "AREA":
        area = math.prod(_sides(lamp, matrix)) * (math.pi / 4 if lamp.shape in ("DISK", "ELLIPSE") else 1.0)
    else:
        radius = math.tan(lamp.angle / 2) if lamp.type == "SUN" else lamp.shadow_soft_size
        area = math.pi * radius * radius
    return area or 1.0


def _emission(core: ModuleType, owner: LampOwner, subject: Subject, resources: Resources, messages: Messages) -> Any:
    """What the lamp's nodes make of its light: a colour, or a program where that is not the same everywhere."""
    emitter = Emitter(core, subject.name)
    compiler = Compiler(emitter, subject, resources, messages)
    compiler.lamp_owner = owner
    with shader_tree(owner.object.data) as tree:
        if tree is None:
            return np.ones(3)
        constant = constant_emission(compiler, tree)
        if constant is not None:
            return constant
        return emitter.program if compiler.compile_tree(tree) else np.zeros(3)


def describe(
    core: ModuleType,
    lamp_object: Any,
    matrix: NDArray[np.float64],
    visibility: int,
    resources: Resources,
    messages: Messages,
    random: float = 0.0,
) -> dict[str, Any]:
    """The arguments of the core's `add_lamp`. `random`: the instance's number, 0..1."""
    lamp, subject = lamp_object.data, Subject("Light", name_of(lamp_object))
    _name_ignored(lamp, subject, messages)
    factor = np.full(3, cycles_versions.lamp_factor(lamp))
    if not getattr(lamp, "normalize", True):  # 4.5
        factor *= _area(lamp, matrix)
    emission = _emission(core, LampOwner(lamp_object, random), subject, resources, messages)
    program = None if isinstance(emission, np.ndarray) else emission
    if program is None:
        factor *= emission
    arguments: dict[str, Any] = dict(
        name=subject.name,
        kind=lamp.type,
        matrix=matrix,
        strength=[float(channel) for channel in np.array(versions.lamp_color(lamp)) * lamp.energy * factor],
        casts_shadow=bool(lamp.use_shadow and versions.cycles_setting(lamp, "cast_shadow", True)),
        visibility=visibility & ~VISIBLE_CAMERA,  # Cycles never shows lamps to the camera
        emission=program,
    )
    if lamp.type in ("POINT", "SPOT"):
        arguments.update(radius=lamp.shadow_soft_size, soft_falloff=cycles_versions.has_soft_falloff(lamp))
    if lamp.type == "SPOT":
        arguments.update(
            spot_size=lamp.spot_size, spot_blend=lamp.spot_blend, spot_profile=cycles_versions.spot_profile()
        )
    if lamp.type == "SUN":
        arguments["angle"] = lamp.angle
    if lamp.type == "AREA":
        round_shape = lamp.shape in ("DISK", "ELLIPSE")
        uneven = lamp.shape in ("RECTANGLE", "ELLIPSE")
        arguments.update(
            kind="DISK" if round_shape else "RECTANGLE",
            size_x=lamp.size,
            size_y=lamp.size_y if uneven else lamp.size,
            spread=lamp.spread,
        )
    return arguments


def _reason(error: Exception) -> str:
    """What is wrong with nodes that could not be compiled, or with what came of them."""
    return "its chain of nodes is too long" if isinstance(error, RecursionError) else str(error)


class LightExporter:
    """Sends the world and the lamps of a view layer."""

    scene: Any  # the core's SceneDescription
    report: ExportReport
    links: LightLinks
    lamps: list[Any] | None  # original objects; None: some are instanced
    _core: ModuleType
    _depsgraph: Any
    _blender_scene: Any
    _view_layer: Any
    _messages: Messages
    _check_cancel: CancelCheck
    _resources: Resources
    _named: Slots

    def _leave_out(self, name: str, reason: str) -> None:
        """Say that an object is not rendered."""
        raise NotImplementedError

    def export_world(self) -> None:
        """The world's program."""
        blender_world = versions.world_of(self._blender_scene, self._depsgraph.view_layer_eval)
        if blender_world is None or not self._view_layer.use_sky:
            self.scene.set_world(None)
            return
        try:
            arguments = (self._core, blender_world, self._resources, self._messages)
            program, medium = world.compile_world(*arguments), world.compile_medium(*arguments)
            width = _WORLD_TABLE_WIDTH if world.uses_nodes(blender_world) else 0
            self.scene.set_world(
                program,
                sampling_resolution=width,
                medium=medium,
                light_group=self._light_group(blender_world),
                visibility=world.visibility(blender_world),
                lit_by=self.links.lit_by_of_world,
            )
        except (self._core.InputError, RecursionError) as error:
            self.scene.set_world(None)  # views go on with a copy, in which the world is as it was
            subject = Subject("World", name_of(blender_world))
            self._messages.warn(f"{subject}: {_reason(error)}; rendered black", subject)

    def _light_group(self, owner: Any) -> int:
        """The slot of the group that an object or world shines in; -1 for none."""
        return self._named.light_groups.get(getattr(owner, "lightgroup", ""), -1)

    def _export_lamps(self, listed: Instances) -> None:
        for lamp_object, place in listed.lamps:
            self._check_cancel()
            self.export_lamp(lamp_object, listed.matrices[place], float(listed.randoms[place]))
        self.lamps = None if listed.instanced_lamps else [lamp_object.original for lamp_object, _ in listed.lamps]

    def export_lamp(self, lamp_object: Any, matrix: Any, random: float | None = None) -> None:
        """An evaluated lamp object at its place. `random`: the instance's number; None: the object stands for itself."""
        if is_portal(lamp_object.data):
            subject = Subject("Light", name_of(lamp_object))
            self._messages.note(f"{subject}: a portal does not shine; the world's light is found without", subject)
            return
        if not shines(lamp_object.data, matrix):
            return
        visibility = instances.visibility(lamp_object, self._view_layer)
        try:
            number = random_of_name(bytes_of_name(lamp_object)) if random is None else random
            arguments = (self._core, lamp_object, matrix, visibility, self._resources, self._messages, number)
            links = dict(light_group=self._light_group(lamp_object), link=self.links.light(lamp_object))
            self.scene.add_lamp(**links, **describe(*arguments))
            self.report.lamps += 1
        except (self._core.InputError, RecursionError) as error:
            self._leave_out(name_of(lamp_object), _reason(error))
