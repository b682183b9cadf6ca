"""The one place where Blender's interface differs from version to version (3.4 to 5.x); what its renderer makes of a scene is in
cycles_versions.py."""

import math
from collections.abc import Iterable
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from .names import name_of, text_of

Floats = NDArray[np.float32]

# Since 5.0 passes have names without abbreviations.
_FULL_PASS_NAMES = {
    "IndexOB": "Object Index",
    "IndexMA": "Material Index",
    "DiffDir": "Diffuse Direct",
    "DiffInd": "Diffuse Indirect",
    "DiffCol": "Diffuse Color",
    "GlossDir": "Glossy Direct",
    "GlossInd": "Glossy Indirect",
    "GlossCol": "Glossy Color",
    "TransDir": "Transmission Direct",
    "TransInd": "Transmission Indirect",
    "TransCol": "Transmission Color",
    "Emit": "Emission",
    "Env": "Environment",
    "AO": "Ambient Occlusion",
    "VolumeDir": "Volume Direct",
    "VolumeInd": "Volume Indirect",
}


def pass_name(name: str) -> str:
    """What this Blender calls a pass, for its name before 5.0."""
    return _FULL_PASS_NAMES.get(name, name) if bpy.app.version >= (5, 0, 0) else name


def uv_map(layer: Any, corners: int) -> Floats:
    """(corners, 2): the coordinates of a UV map."""
    values = np.empty(corners * 2, np.float32)
    if hasattr(layer, "uv"):  # 3.5
        layer.uv.foreach_get("vector", values)
    else:
        layer.data.foreach_get("uv", values)
    return values.reshape(-1, 2)


def absolute_path(path: str, block: Any) -> str:
    """Of a path that a data block holds, by slashes of either kind."""
    is_share = path.startswith("\\\\")  # of Windows
    return str(bpy.path.abspath(path if is_share else path.replace("\\", "/"), library=block.library))


def creases(mesh: Any) -> tuple[Floats | None, Floats | None]:
    """The creases of edges and of vertices, 0 to 1; None where there are none."""

    def read(data: Any) -> Floats:
        values = np.empty(len(data), np.float32)
        data.foreach_get("value", values)
        return values

    if bpy.app.version >= (4, 0, 0):
        found = (mesh.attributes.get("crease_edge"), mesh.attributes.get("crease_vert"))
    else:
        of_edges, of_vertices = mesh.edge_creases, mesh.vertex_creases
        found = (of_edges[0] if of_edges else None, of_vertices[0] if of_vertices else None)
    edges, vertices = (None if layer is None else read(layer.data) for layer in found)
    return edges, vertices


def write_passes(layer: Any, pixels: dict[str, Floats]) -> None:
    """Fill the passes of a render layer; `pixels` by Blender's pass name, (height, width, channels). Others stay black."""
    if bpy.app.version >= (4, 0, 0):
        for entry in layer.passes:
            if entry.name in pixels:
                entry.rect.foreach_set(np.ascontiguousarray(pixels[entry.name], np.float32).ravel())
        return
    # 3.x: the passes of a layer are set together; a pass of several channels cannot be set alone.
    height, width = next(iter(pixels.values())).shape[:2]
    parts = []
    for entry in layer.passes:
        values = pixels.get(entry.name)
        parts.append(np.zeros(height * width * entry.channels, np.float32) if values is None else values.ravel())
    layer.passes.foreach_set("rect", np.concatenate(parts))


def cycles_setting(owner: Any, name: str, default: Any) -> Any:
    """A setting that Blender's Cycles add-on keeps with a data block; without the add-on, what the file holds of it."""
    if hasattr(owner, "cycles"):
        return getattr(owner.cycles, name, default)
    kept = owner.get("cycles")
    return default if kept is None else kept.get(name, default)


_SHADOW_TERMINATOR = "shadow_terminator_geometry_offset"


def shadow_terminator(owner: Any) -> float:
    """An object's Geometry Offset of the shadow terminator, 0 to 1. Later versions hold it for all engines."""
    offset = getattr(owner, _SHADOW_TERMINATOR, None)
    value = float(cycles_setting(owner, _SHADOW_TERMINATOR, 0.1) if offset is None else offset)
    return min(max(value, 0.0), 1.0)


def shadow_terminator_shading(owner: Any) -> float:
    """An object's Shading Offset of the shadow terminator."""
    offset = getattr(owner, "shadow_terminator_shading_offset", None)
    return float(cycles_setting(owner, "shadow_terminator_offset", 0.0) if offset is None else offset)


def light_collections(owner: Any) -> tuple[Any, Any]:
    """The collections of objects that a light shines on, and that cast its shadows; None: all. Since 4.0."""
    linking = getattr(owner, "light_linking", None)
    return (None, None) if linking is None else (linking.receiver_collection, linking.blocker_collection)


def linked_objects(collection: Any) -> Iterable[tuple[Any, bool]]:
    """The objects of such a collection, and whether they are included; else they are excluded. Some may come twice."""
    for entry, child in zip(collection.collection_children, collection.children, strict=True):
        for item in child.all_objects:
            yield item, entry.light_linking.link_state == "INCLUDE"
    for entry, item in zip(collection.collection_objects, collection.objects, strict=True):
        yield item, entry.light_linking.link_state == "INCLUDE"


_PANORAMAS = {  # as files hold Cycles' choice where its add-on is not enabled
    0: "EQUIRECTANGULAR",
    1: "FISHEYE_EQUIDISTANT",
    2: "FISHEYE_EQUISOLID",
    3: "MIRRORBALL",
    4: "FISHEYE_LENS_POLYNOMIAL",
    5: "EQUIANGULAR_CUBEMAP_FACE",
}


def panorama(camera: Any) -> dict[str, Any]:
    """What a panoramic camera shows: Cycles' settings, with their defaults."""
    defaults: dict[str, Any] = dict(panorama_type="FISHEYE_EQUISOLID", fisheye_fov=math.pi, fisheye_lens=10.5)
    defaults |= dict(latitude_min=-math.pi / 2, latitude_max=math.pi / 2, longitude_min=-math.pi, longitude_max=math.pi)
    if hasattr(camera, "panorama_type"):  # 5.0
        return {name: getattr(camera, name) for name in defaults}
    found = {name: cycles_setting(camera, name, default) for name, default in defaults.items()}
    kind = found["panorama_type"]
    return found | {"panorama_type": _PANORAMAS.get(kind, "") if isinstance(kind, int) else str(kind)}


_SHUTTER_POSITIONS = ("START", "CENTER", "END")  # as files hold Cycles' choices where its add-on is not enabled
_ROLLING_SHUTTERS = ("NONE", "TOP")


def shutter_position(scene: Any) -> str:
    """Which moment of the shutter's time is the frame: START, CENTER or END."""
    if hasattr(scene.render, "motion_blur_position"):  # 4.2
        return str(scene.render.motion_blur_position)
    found = cycles_setting(scene, "motion_blur_position", "CENTER")
    return _SHUTTER_POSITIONS[found] if isinstance(found, int) else str(found)


def rolling_shutter(scene: Any) -> float | None:
    """For which share of the shutter's time a rolling shutter exposes a row; None: it does not roll."""
    kind = cycles_setting(scene, "rolling_shutter_type", "NONE")
    kind = _ROLLING_SHUTTERS[kind] if isinstance(kind, int) else kind
    return float(cycles_setting(scene, "rolling_shutter_duration", 0.1)) if kind == "TOP" else None


def transparent_shadow(material: Any) -> bool:
    """Whether shadows of a material respect its transparency, as Cycles is told."""
    if hasattr(material, "use_transparent_shadow"):  # 4.2
        return bool(material.use_transparent_shadow)
    return bool(cycles_setting(material, "use_transparent_shadow", True))


_DISPLACEMENT_METHODS = ("BUMP", "DISPLACEMENT", "BOTH")


def displacement_method(material: Any) -> str:
    """What a material's Displacement output does: BUMP bends normals, DISPLACEMENT moves points, BOTH does both."""
    if hasattr(material, "displacement_method"):  # 4.1
        return str(material.displacement_method)
    method = cycles_setting(material, "displacement_method", "BUMP")
    return _DISPLACEMENT_METHODS[method] if isinstance(method, int) else str(method)


def world_visibility(world: Any, kinds: Iterable[str]) -> dict[str, bool]:
    """Which kinds of rays see the world, as Cycles is told."""
    if hasattr(world, "cycles_visibility"):
        return {kind: bool(getattr(world.cycles_visibility, kind, True)) for kind in kinds}
    kept = world.get("cycles_visibility") or {}  # without Blender's Cycles add-on
    return {kind: bool(kept.get(kind, True)) for kind in kinds}


def lamp_color(lamp: Any) -> tuple[float, float, float]:
    """Its colour; since 4.5 times that of its temperature, where it has one."""
    red, green, blue = lamp.color
    if not getattr(lamp, "use_temperature", False):
        return red, green, blue
    warm = lamp.temperature_color
    return red * warm[0], green * warm[1], blue * warm[2]


def choose_file_format(image_settings: Any, file_format: str) -> None:
    """Have the Render Result saved in a format of still pictures."""
    if hasattr(image_settings, "media_type"):  # 5.0
        image_settings.media_type = "MULTI_LAYER_IMAGE" if file_format == "OPEN_EXR_MULTILAYER" else "IMAGE"
    image_settings.file_format = file_format


def compositor(scene: Any) -> Any:
    """The node tree of a scene's compositor; None where it has none."""
    if hasattr(scene, "compositing_node_group"):  # 5.0
        return scene.compositing_node_group
    return scene.node_tree if scene.use_nodes else None


def animation_curves(owner: Any) -> Any:
    """The curves of an animated data block's action."""
    action = owner.animation_data.action
    if hasattr(action, "fcurves"):
        return action.fcurves
    return action.layers[0].strips[0].channelbag(owner.animation_data.action_slot).fcurves  # 5.0


def aov_name(node: Any) -> str:
    """Which AOV an AOV Output node writes to; before 4.2, that of its own name."""
    return text_of(node, "aov_name") if hasattr(node, "aov_name") else name_of(node)


def shows_geometry() -> bool:
    """Whether Blender shows the instances that geometry nodes make, with their attributes. Since 4.5."""
    return bpy.app.version >= (4, 5, 0)


def evaluated_geometry(owner: Any) -> Any:
    """All geometry of an evaluated object, a GeometrySet; None where Blender does not show it, and where there is none."""
    return owner.evaluated_geometry() if shows_geometry() and owner.data is not None else None


def closed_twist() -> str:
    """What a closed curve's minimum twist does where it does not meet itself: until 3.4 it jumps, then it is spread."""
    return "JUMP" if bpy.app.version < (3, 5, 0) else "SPREAD"


def world_of(scene: Any, view_layer: Any) -> Any:
    """The world that a view layer shows, None without one. Since 5.0 it may have one of its own."""
    return getattr(view_layer, "world_override", None) or scene.world
