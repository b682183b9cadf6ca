"""The core's scene of a view layer, kept up to date by what Blender says has changed.

Materials, lamps, the world, and objects that only move are changed in a copy of the scene as it was. Whatever else is
exported anew, but for shapes and programs of what has not changed.
"""

from collections.abc import Callable
from dataclasses import dataclass
from types import ModuleType
from typing import Any

import numpy as np

from .. import versions
from ..export.camera import Frame
from ..export.instance_values import INSTANCER_ATTRIBUTE, PROPERTY_OF
from ..export.kept import KeptExport
from ..export.light_linking import LightLinks
from ..export.scene import SceneExporter
from ..messages import Messages
from ..names import name_of
from . import undo
from .changes import Changes, is_driven
from .values import look_of, values_of

# Textures that edits have added stay, with those that they replace, until so many make it worth to begin anew.
_MOST_ADDED = 64


def _circumstances(depsgraph: Any) -> tuple[Any, ...]:
    """What all geometry and all programs depend on, beside themselves."""
    scene, layer = depsgraph.scene, depsgraph.view_layer
    render = scene.render
    simplify = (render.use_simplify, render.simplify_subdivision, render.simplify_child_particles)
    outputs = tuple(name_of(output) for output in layer.aovs)
    own = values_of(scene.rayleaf)
    frame = (scene.frame_current, scene.frame_subframe)
    world = versions.world_of(scene, layer)
    of_layer = 0 if world is None else world.as_pointer()
    return (undo.count(), scene.as_pointer(), name_of(layer), simplify, outputs, own, frame, of_layer)


@dataclass(frozen=True)
class _View:
    frame: Frame
    camera: dict[str, Any]
    shows_uv: bool
    space: Any


class SceneSync:
    """Exports a view layer, again and again."""

    def __init__(self, core: ModuleType, messages: Callable[[], Messages]) -> None:
        """`messages` makes one for each export."""
        self._core, self._messages = core, messages
        self._parts = core.SceneParts()
        self._exporter: SceneExporter | None = None
        self._circumstances: tuple[Any, ...] = ()
        self._looks: dict[int, tuple[Any, ...]] = {}  # of data blocks that were said to look otherwise
        self._added = 0  # textures, by edits
        self.exports = {"edit": 0, "whole": 0, "same": 0}  # how often which way was taken

    def update(self, depsgraph: Any, frame: Frame, camera: dict[str, Any], shows_uv: bool, space: Any) -> Any:
        """The core's scene as it is now; the same object where nothing in it has changed. `space`: the 3-D view. Raises
        as exports do."""
        former, circumstances = self._exporter, (shows_uv, *_circumstances(depsgraph))
        view = _View(frame, camera, shows_uv, space)
        changes, textures = Changes.of(depsgraph.updates), 0 if former is None else former.textures
        self._exporter = None  # an export that fails leaves nothing
        exporter = former
        is_other = circumstances != self._circumstances or self._added > _MOST_ADDED
        if former is None or is_other or not former.reads_same_scene(depsgraph):
            exporter = self._exported(depsgraph, view, None)
            self._added = 0
        elif not (changes.is_simple and self._are_known(changes.reshaded) and _edit(former, depsgraph, changes)):
            left = former.left.without(changes.pointers, changes.images)
            exporter = self._exported(depsgraph, view, left)
            self._looks = {pointer: look_of(block) for pointer, block in changes.reshaded.items()}
            self._added += exporter.textures
            if former.scene.shows_same_as(exporter.scene):
                exporter.scene = former.scene
                self.exports["same"] += 1
        else:
            self._added += former.textures - textures
            self.exports["edit"] += 1
        assert exporter is not None
        self._exporter, self._circumstances = exporter, circumstances
        return exporter.scene

    def _are_known(self, reshaded: dict[int, Any]) -> bool:
        """Whether data blocks that are said to look otherwise are set as when that was said before: then they do for a
        material of theirs, which is told too."""
        return all(self._looks.get(pointer) == look_of(block) for pointer, block in reshaded.items())

    def _exported(self, depsgraph: Any, view: "_View", left: KeptExport | None) -> SceneExporter:
        self.exports["whole"] += 1
        self._looks = {}
        exporter = SceneExporter(
            self._core, depsgraph, self._messages(), parts=self._parts, former=left, space=view.space
        )
        exporter.export(view.frame, needs_uv=view.shows_uv, camera_arguments=view.camera)
        return exporter


def _edit(exporter: SceneExporter, depsgraph: Any, changes: Changes) -> bool:
    """Changes a copy of what was exported; False, and the export is as it was, where that is not enough."""
    rows = _rows_of(exporter, changes)
    if rows is None or (changes.lamps and exporter.lamps is None):
        return False
    if (exporter.links or changes.lamps or changes.reshaded) and LightLinks.of(depsgraph.objects) != exporter.links:
        return False  # lights shine on other objects now
    if any(exporter.materials.fills_volumes(pointer) for pointer in changes.materials):
        return False  # it may read other grids now
    shown = any(exporter.materials.index_of(pointer) is not None for pointer in changes.materials)
    if not (rows or shown or changes.world or changes.lamps):
        return True
    before, carried = exporter.scene, exporter.wanted_attributes
    exporter.edit(before.copy(), depsgraph)
    done = _replace_materials(exporter, depsgraph, changes)
    if done:
        _replace_lights(exporter, depsgraph, changes)
        # Programs that are made now add to what is wanted; shapes and instances carry what was wanted before.
        done = exporter.wanted_attributes <= carried and _place(exporter, depsgraph, rows)
    if done:
        exporter.leave_out_unreadable_images()
    else:
        exporter.edit(before, depsgraph)
    return done


def _replace_lights(exporter: SceneExporter, depsgraph: Any, changes: Changes) -> None:
    if changes.world:
        exporter.export_world()
    if changes.lamps:
        exporter.scene.clear_lamps()
        for lamp in exporter.lamps or ():
            evaluated = lamp.evaluated_get(depsgraph)
            exporter.export_lamp(evaluated, np.array(evaluated.matrix_world, np.float64))


def _place(exporter: SceneExporter, depsgraph: Any, rows: dict[int, Any]) -> bool:
    if not rows:
        return True
    matrices = [np.array(block.evaluated_get(depsgraph).matrix_world, np.float64) for block in rows.values()]
    try:
        exporter.scene.place_instances(np.array(list(rows), np.int32), np.array(matrices))
    except ValueError:  # the core's InputError: a whole export says which is left out
        return False
    return True


def _rows_of(exporter: SceneExporter, changes: Changes) -> dict[int, Any] | None:
    """The objects that have moved, by instance; None where more depends on where they are."""
    rows = {}
    # Attributes are looked up where objects are.
    reads_objects = any(name.startswith((PROPERTY_OF, INSTANCER_ATTRIBUTE)) for name in exporter.wanted_attributes)
    for pointer, block in changes.moved.items():
        if block.is_instancer or block.instance_type != "NONE" or len(block.particle_systems) > 0:
            return None
        if any(modifier.type == "NODES" for modifier in block.modifiers):
            return None
        if block.type in ("EMPTY", "ARMATURE", "LATTICE", "SPEAKER"):
            continue
        if reads_objects or is_driven(block) or exporter.rows is None or pointer not in exporter.rows:
            return None
        rows[exporter.rows[pointer]] = block
    return rows


def _replace_materials(exporter: SceneExporter, depsgraph: Any, changes: Changes) -> bool:
    library = exporter.materials
    for pointer, block in changes.materials.items():
        index = library.index_of(pointer)
        if index is None:
            continue
        former = library.compiled.get(pointer)
        if former is None:
            return False
        try:
            compiled = library.compile(block.evaluated_get(depsgraph))
        except (ValueError, RecursionError):
            return False
        if former.displaces or compiled.displaces:
            return False
        exporter.scene.replace_material(index, *compiled.arguments)
        library.compiled[pointer] = compiled
    return True
