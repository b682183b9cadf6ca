"""A stand-in for rayleaf._core that records what the exporter sends, and renders pictures that say where each value belongs.

Scripts inside Blender use it to look at the export alone: `core = recording_core.install()` before the first render.
"""

import os
import sys
import time
import types

import numpy as np

CLOSURES = {
    *("diffuse", "translucent", "velvet", "toon", "glossy", "refraction", "glass", "transparent"),
    *("emission", "background", "holdout", "principled"),
    *("volume_absorption", "volume_scatter", "volume_principled"),
}


class InputError(ValueError):
    """As the core's."""


class Program:
    """Keeps constants and operations; `lines` tells them in words."""

    def __init__(self, name, bump_shadow="CUBIC", clearing="ALL"):
        self.name, self.bump_shadow, self.clearing, self.registers, self.lines = name, bump_shadow, clearing, [], []
        self.bump_width = 1.0

    def constant(self, x, y, z, w):
        self.registers.append((x, y, z, w))
        return len(self.registers) - 1

    def operation(self, identifier, operands=(), ints=(), floats=(), text=""):
        result = -1
        if identifier not in CLOSURES:
            self.registers.append(f"%{len(self.registers)}")
            result = len(self.registers) - 1
        numbers = [float(each) for each in floats]
        self.lines.append(
            dict(op=identifier, operands=list(operands), ints=list(ints), floats=numbers, text=text, result=result)
        )
        return result

    def line(self, identifier):
        """The only operation of that name."""
        (found,) = [line for line in self.lines if line["op"] == identifier]
        return found

    def operands(self, line):
        """Of a line: constants as tuples, computed values as the operation that made them, None for unconnected."""
        made = {each["result"]: each for each in self.lines}
        values = [None if r < 0 else self.registers[r] for r in line["operands"]]
        return [
            made[register] if isinstance(value, str) else value
            for register, value in zip(line["operands"], values, strict=True)
        ]


class NurbsSpline:
    def __init__(self, points, order_u, order_v, **flags):
        self.points, self.order_u, self.order_v, self.flags = points, order_u, order_v, flags

    def problem(self):
        return None


class Strands:
    def __init__(self, name, points, radii, offsets, **more):
        self.arguments = dict(name=name, points=points, radii=radii, offsets=offsets, **more)


class SubdivisionSurface:
    def __init__(self, name, vertices, face_sizes, corners, **more):
        self.arguments = dict(name=name, vertices=vertices, face_sizes=face_sizes, corners=corners, **more)


class CurveSplines:
    def __init__(self, kind, counts, points, **more):
        self.kind, self.counts, self.points, self.more = kind, counts, points, more


class SweptCurve:
    def __init__(self, name, splines, **settings):
        self.name, self.splines, self.settings = name, splines, settings

    def begin(self):
        pass

    def borders_cross(self):
        return self.name == "Crossed"


class NurbsCurve:
    """As long as Blender draws it, and as straight as its control polygon."""

    def __init__(self, points, order, *flags):
        self.points = points

    def problem(self):
        return None

    def to_bezier(self):
        return self

    def positions(self, t):
        place = t * (len(self.points) - 1)
        return np.stack([np.interp(place, np.arange(len(self.points)), self.points[:, i]) for i in range(3)], axis=1)


class SceneDescription:
    """Keeps the arguments of every call by kind."""

    def __init__(self, parts=None):
        self.meshes, self.surfaces, self.curves, self.materials, self.material_lists = [], [], [], [], []
        self.instances, self.lamps, self.images = None, [], []
        self.ray_interpolations, self.strands, self.cages = [], [], []
        self.world = self.camera = None
        self.attributes, self.texture_memory, self.shapes = {}, 0, []
        RECORDED.append(self)

    def attribute(self, name):
        return self.attributes.setdefault(name, len(self.attributes))

    def _shape(self, kind, arguments):
        self.shapes.append((kind, arguments))
        return len(self.shapes) - 1

    def add_mesh(self, name, vertices, triangles, **more):
        self.meshes.append(dict(name=name, vertices=vertices, triangles=triangles, **more))
        return self._shape("mesh", self.meshes[-1])

    def add_surface(self, name, splines, moved_splines=()):
        self.surfaces.append(dict(name=name, splines=splines, moved_splines=moved_splines))
        return self._shape("surface", self.surfaces[-1])

    def set_texture_space(self, shape, low, high):
        pass

    def shape(self, index):
        return self.shapes[index]

    def add_shape(self, shape):
        if isinstance(shape, SubdivisionSurface):
            self.cages.append(shape.arguments)
            return self._shape("cage", shape.arguments)
        self.strands.append(shape.arguments)
        return self._shape("strands", shape.arguments)

    def add_curve(self, curve):
        self.curves.append(curve)
        return self._shape("curve", curve)

    def add_material(
        self, name, surface, pass_index=0, volume=None, displacement=None, medium=None, transparent_shadow=True
    ):
        made = dict(name=name, surface=surface, pass_index=pass_index, volume=volume, displacement=displacement)
        made["medium"], made["transparent_shadow"] = medium, transparent_shadow
        self.materials.append(made)
        return len(self.materials) - 1

    def add_material_list(self, materials):
        self.material_lists.append(list(materials))
        return len(self.material_lists) - 1

    def add_ray_interpolation(self, object, interpolation):
        self.ray_interpolations.append((object, interpolation))
        return len(self.ray_interpolations) - 1

    def add_instances(
        self,
        names,
        shapes,
        matrices,
        material_lists,
        object_indices,
        randoms,
        visibilities,
        ray_interpolations,
        attributes,
        light_groups,
        assets,
        motions,
        shadow_terminators,
        linkings=None,
    ):
        part = dict(
            names=list(names),
            shapes=shapes.tolist(),
            matrices=list(matrices),
            material_lists=material_lists.tolist(),
            object_indices=object_indices.tolist(),
            randoms=randoms.tolist(),
            visibilities=visibilities.tolist(),
            ray_interpolations=ray_interpolations.tolist(),
            light_groups=light_groups.tolist(),
            assets=list(assets),
            shadow_terminators=shadow_terminators.tolist(),
            linkings=[None] * len(names) if linkings is None else linkings.tolist(),
            motions=[None if motions is None else motions.get(i) for i in range(len(names))],
            attributes=[{key: rows[i].tolist() for key, rows in attributes.items()} for i in range(len(names))],
        )
        self.instances = {key: self.instances[key] + part[key] for key in part} if self.instances else part
        return []

    def add_lamp(self, **arguments):
        self.lamps.append(arguments)
        return len(self.lamps) - 1

    def set_world(self, world, sampling_resolution=1024, medium=None, light_group=-1, visibility=63, lit_by=None):
        self.world, self.world_medium, self.world_light_group = world, medium, light_group

    def matte_attributes(self, kind, layer):
        return {f"cryptomatte/{kind}/name": layer}

    def set_camera(self, **arguments):
        self.camera = arguments

    def add_image_file(self, name, path, color_space, config="", picture=0, alpha="OPACITY"):
        row = dict(name=name, path=os.fsdecode(path), color_space=color_space, config=config, picture=picture)
        row["alpha"] = alpha
        self.images.append(row)
        return len(self.images) - 1

    def leave_out_unreadable_images(self):
        return []

    def add_packed_image(self, name, content, color_space, config="", alpha="OPACITY"):
        self.images.append(dict(name=name, content=content, color_space=color_space, config=config, alpha=alpha))
        return len(self.images) - 1

    def add_image_pixels(self, name, pixels, color_space, config="", alpha="OPACITY"):
        self.images.append(dict(name=name, pixels=pixels, color_space=color_space, config=config, alpha=alpha))
        return len(self.images) - 1


class RayInterpolation:
    # What a tolerance stands for, as a tick at Advanced asks.
    distance_threshold, angle_threshold, depth_limit, cache_bytes, rays_per_cell = 0.005, 0.35, 28, 100_000_000, 8.0

    def __init__(self, **values):
        self.values = values


class VolumeVisualisation(RayInterpolation):
    pass


class Panorama:
    def __init__(self, *values, **of_stereo):
        self.values = values
        self.of_stereo = of_stereo


class SceneParts:
    pass


class RayCacheStore:
    def __init__(self):
        self.frames = 0

    def of_scene(self, name):
        return self

    def next_frame(self):
        self.frames += 1


class Settings:
    def __init__(self, **values):
        self.__dict__.update(values)


class Session:
    """Takes `Session.seconds` to render; a pixel of channel c holds x + 1000 y + 10⁶ c, in pixels of the whole picture."""

    seconds = 0.0
    last = None

    def __init__(self, scene, settings, ray_caches=None):
        self.ray_caches = ray_caches
        self.scene, self.settings, self.cancelled, self.began = scene, settings, False, None
        Session.last = self

    def render(self):
        self.began = time.perf_counter()
        while time.perf_counter() - self.began < self.seconds and not self.cancelled:
            time.sleep(0.005)
        return not self.cancelled

    def cancel(self):
        self.cancelled = True

    def progress(self):
        return "rendering", 0.5

    def pass_pixels(self, name):
        from rayleaf import passes

        channels = next((len(entry.channels) for entry in passes.table() if entry.identifier == name), 4)
        s = self.settings
        x = np.arange(s.crop_x, s.crop_x + s.crop_width)[None, :, None]
        y = np.arange(s.crop_y, s.crop_y + s.crop_height)[:, None, None]
        return (x + 1000 * y + 1_000_000 * np.arange(channels)).astype(np.float32)

    def statistics(self):
        return {"stand-in": True, "memory": {"facets": 0}, "geometry_cache": {"levels": {}, "parts": {"lookups": 0}}}


RECORDED = []


def vertex_normals(vertices, face_sizes, corners):
    """As the core's, in the plainest way."""
    sums, begin = np.zeros((len(vertices), 3)), 0
    for size in face_sizes:
        face = corners[begin : begin + size]
        begin += size
        here = vertices[face].astype(float)
        before, after = np.roll(here, 1, axis=0), np.roll(here, -1, axis=0)
        edges = [(each - here) / np.linalg.norm(each - here, axis=1, keepdims=True) for each in (before, after)]
        area = np.cross(before, here).sum(axis=0)
        angles = np.arccos((edges[0] * edges[1]).sum(axis=1).clip(-1, 1))
        np.add.at(sums, face, angles[:, None] * area / np.linalg.norm(area))
    return (sums / np.linalg.norm(sums, axis=1, keepdims=True)).astype(np.float32)


def install():
    """Make the stand-in the core that the add-on loads."""
    module = types.ModuleType("rayleaf._core")
    items = (InputError, Program, NurbsSpline, Strands, SubdivisionSurface, SceneDescription, Settings, Session)
    curves = (CurveSplines, SweptCurve, NurbsCurve)
    for item in (*items, *curves, RayInterpolation, VolumeVisualisation, Panorama, RayCacheStore, SceneParts):
        setattr(module, item.__name__, item)
    module.vertex_normals = vertex_normals
    sys.modules["rayleaf._core"] = module
    import rayleaf

    module.__version__ = rayleaf.__version__
    rayleaf._core = module
    return module


def export():
    """Export the current scene; the recorded description, the exporter's report and the texts of its messages."""
    import bpy
    from rayleaf.export import camera, scene
    from rayleaf.messages import Messages

    messages = Messages()
    depsgraph = bpy.context.evaluated_depsgraph_get()
    exporter = scene.SceneExporter(install(), depsgraph, messages)
    exporter.export(camera.frame_of(bpy.context.scene), needs_uv=False)
    return exporter.scene, exporter.report, messages.texts
