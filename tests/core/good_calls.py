"""A call that holds for every function that the stub lists; core/bad_arguments.py spoils them."""

import os
import struct

import numpy as np
import pyopenvdb
from core import fake_denoiser, shapes
from core.good_arguments import (
    ROWS,
    UP,
    CAGE,
    CAMERA,
    MOTION,
    CUBE,
    CURVE,
    Call,
    HAIR,
    INSTANCES,
    NUMBERS,
    PAIRS,
    PATCH,
    RAYS,
    SPLINES,
    T,
    TRIANGLE,
    chain,
    ctor,
    in_temporary,
    later,
    method,
    net,
    program,
    scene,
    session,
    settings,
    splines,
    strands,
    swept,
)
from rayleaf import _core


# A bitmap of one pixel, as a file holds it.
ONE_PIXEL = (
    struct.pack("<2sIHHIIiiHHIIiiII", b"BM", 58, 0, 0, 54, 40, 1, 1, 1, 24, 0, 4, 0, 0, 0, 0) + b"\x10\x20\x30\0"
)


def built():
    """A session whose scene is built."""
    made = session()
    assert made.build()
    return made


def film_sums():
    """Of a picture without samples yet."""
    return _core.FilmSums(2, 2, ["combined"])


def grid():
    """A grid of one voxel."""
    return _core.VoxelGrid("cloud", "density", np.ones((1, 1, 1, 1)), np.eye(4))


def vdb_file():
    """A file of one grid."""
    path = in_temporary(f"rayleaf-good-call-{os.getpid()}.vdb")
    made = pyopenvdb.FloatGrid()
    made.name = "density"
    made.copyFromArray(np.ones((2, 2, 2), np.float32))
    pyopenvdb.write(path, [made])
    return path


CALLS: dict[str, Call] = {
    "Program": ctor(_core.Program, name="material"),
    "Program.constant": method(program, "constant", x=1.0, y=2.0, z=3.0, w=4.0),
    "Program.operation": method(program, "operation", identifier="diffuse", operands=[0, 1], ints=[], floats=[]),
    "NurbsSpline": ctor(_core.NurbsSpline, points=PATCH, order_u=2, order_v=2),
    "NurbsSpline.problem": method(lambda: _core.NurbsSpline(PATCH, 2, 2), "problem"),
    "NurbsSpline.to_bezier": method(lambda: _core.NurbsSpline(PATCH, 2, 2), "to_bezier"),
    "BezierCurve": ctor(_core.BezierCurve, points=CURVE),
    "BezierCurve.evaluate": method(lambda: _core.BezierCurve(CURVE), "evaluate", t=T),
    "BezierCurve.de_casteljau": method(lambda: _core.BezierCurve(CURVE), "de_casteljau", t=T),
    "BezierCurve.split": method(lambda: _core.BezierCurve(CURVE), "split", t=0.5),
    "BezierCurve.restricted": method(lambda: _core.BezierCurve(CURVE), "restricted", begin=0.1, end=0.5),
    "BezierCurve.elevated": method(lambda: _core.BezierCurve(CURVE), "elevated"),
    "BezierCurve.bounds": method(lambda: _core.BezierCurve(CURVE), "bounds"),
    "BezierPatch": ctor(_core.BezierPatch, points=PATCH),
    "BezierPatch.evaluate": method(lambda: _core.BezierPatch(PATCH), "evaluate", u=T, v=T),
    "BezierPatch.normals": method(lambda: _core.BezierPatch(PATCH), "normals", u=T, v=T, neighbour=UP, geometric=UP),
    "BezierPatch.split": method(lambda: _core.BezierPatch(PATCH), "split", direction="U", t=0.5),
    "BezierPatch.restricted": method(
        lambda: _core.BezierPatch(PATCH), "restricted", u_begin=0.1, u_end=0.5, v_begin=0.1, v_end=0.5
    ),
    "BezierPatch.elevated": method(lambda: _core.BezierPatch(PATCH), "elevated", direction="U"),
    "BezierPatch.bounds": method(lambda: _core.BezierPatch(PATCH), "bounds"),
    "BezierPatch.float_bounds": method(lambda: _core.BezierPatch(PATCH), "float_bounds"),
    "BezierPatch.facet_distance_bound": method(
        lambda: _core.BezierPatch(PATCH), "facet_distance_bound", cells_u=2, cells_v=3
    ),
    "BezierPatch.closest_point": method(lambda: _core.BezierPatch(PATCH), "closest_point", target=UP),
    "BezierChain.positions": method(chain, "positions", t=T),
    "BezierChain.segment": method(chain, "segment", index=0),
    "BezierNet.positions": method(net, "positions", u=T, v=T),
    "BezierNet.patch": method(net, "patch", span_u=0, span_v=0),
    "NurbsCurve": ctor(_core.NurbsCurve, points=CURVE, order=3),
    "NurbsCurve.problem": method(lambda: _core.NurbsCurve(CURVE, 3), "problem"),
    "NurbsCurve.to_bezier": method(lambda: _core.NurbsCurve(CURVE, 3), "to_bezier"),
    "BezierSpline": ctor(_core.BezierSpline, knots=np.zeros((2, 3, 3))),
    "BezierSpline.problem": method(lambda: _core.BezierSpline(np.zeros((2, 3, 3))), "problem"),
    "BezierSpline.to_bezier": method(lambda: _core.BezierSpline(np.zeros((2, 3, 3))), "to_bezier"),
    "vertex_normals": ctor(
        _core.vertex_normals, vertices=np.eye(3, dtype=np.float32), face_sizes=np.array([3]), corners=np.arange(3)
    ),
    "implied_knots": ctor(_core.implied_knots, count=5, order=3),
    "CurveSplines": ctor(_core.CurveSplines, **SPLINES),
    "CurveSplines.__len__": method(splines, "__len__"),
    "SweptCurve": later(
        _core.SweptCurve,
        name=lambda: "curve",
        splines=lambda: [splines()],
        dimensions=lambda: "2D",
        fill_materials=lambda: [0],
        profile=lambda: [splines()],
        taper=splines,
    ),
    "SweptCurve.begin": method(swept, "begin"),
    "SweptCurve.borders_cross": method(swept, "borders_cross"),
    "RayInterpolation": ctor(_core.RayInterpolation, mode="ON"),
    "VolumeVisualisation": ctor(_core.VolumeVisualisation, kind="EMISSION", density=1.0, color=(1.0, 1.0, 1.0)),
    "RayCacheStore": ctor(_core.RayCacheStore),
    "RayCacheStore.of_scene": method(_core.RayCacheStore, "of_scene", name="scene"),
    "RayCacheStore.next_frame": method(_core.RayCacheStore, "next_frame"),
    "RayCacheStore.count": method(_core.RayCacheStore, "count"),
    "RayCacheStore.bytes": method(_core.RayCacheStore, "bytes"),
    "Strands": ctor(_core.Strands, **HAIR, moved_points=np.zeros((2, len(HAIR["points"]), 4))),
    "strand_tubes": later(_core.strand_tubes, strands=strands, rings=lambda: 3, sides=lambda: 4),
    "strands_along": later(_core.strands_along, curve=swept),
    "VoxelGrid": ctor(
        _core.VoxelGrid, object="cloud", name="density", values=np.ones((2, 2, 2, 1)), to_object=np.eye(4)
    ),
    "VoxelGrid.values": method(grid, "values", points=np.zeros((2, 3))),
    "VoxelGrid.bounds": method(grid, "bounds"),
    "densities_along": later(
        _core.densities_along,
        densities=lambda: np.arange(64, dtype=np.float32) % 7,
        begin=lambda: np.zeros(3),
        step=lambda: np.ones(3) * 0.3,
    ),
    "read_vdb": later(_core.read_vdb, object=lambda: "cloud", path=vdb_file, names=lambda: ["density"]),
    "volume": later(_core.volume, name=lambda: "cloud", grids=lambda: {0: grid()}),
    "SubdivisionSurface": ctor(_core.SubdivisionSurface, **CAGE),
    "SubdivisionSurface.points": method(
        CUBE.surface, "points", elements=np.zeros(2, np.int32), parameters=np.zeros((2, 2))
    ),
    "SubdivisionSurface.values": method(
        CUBE.surface, "values", attribute=0, elements=np.zeros(2, np.int32), parameters=np.zeros((2, 2))
    ),
    "displaced": later(_core.displaced, shape=CUBE.surface, program=program, object=lambda: 0, world=lambda: -1),
    "Denoiser": ctor(_core.Denoiser, paths=[fake_denoiser.library()], threads=1),
    "Denoiser.denoised": method(
        lambda: _core.Denoiser([fake_denoiser.library()]),
        "denoised",
        color=np.ones((2, 3, 3), np.float32),
        albedo=np.ones((2, 3, 3), np.float32),
        normal=np.ones((2, 3, 3), np.float32),
        prefilter="FAST",
    ),
    "Panorama": ctor(
        _core.Panorama,
        kind="FISHEYE_EQUISOLID",
        longitudes=(-1.0, 1.0),
        latitudes=(-1.0, 1.0),
        field_of_view=3.0,
        lens=10.0,
        sensor=(36.0, 24.0),
        eye_offset=0.03,
        convergence=2.0,
        pole_merge=(1.0, 1.3),
    ),
    "FilmSums": ctor(_core.FilmSums, width=2, height=2, passes=["combined"]),
    "FilmSums.add": method(film_sums, "add", x=0, y=0, samples=1, sums={"combined": np.ones((2, 2, 4, 1), np.float64)}),
    "FilmSums.samples": method(film_sums, "samples"),
    "FilmSums.pass_pixels": method(film_sums, "pass_pixels", name="combined"),
    "SceneParts": ctor(_core.SceneParts),
    "SceneDescription": ctor(_core.SceneDescription, parts=_core.SceneParts()),
    "SceneDescription.attribute": method(scene, "attribute", name="UVMap"),
    "SceneDescription.add_mesh": method(
        scene,
        "add_mesh",
        name="mesh",
        **TRIANGLE,
        corner_normals=np.ones((1, 3, 3), np.float32),
        material_slots=np.zeros(1, np.int32),
        attributes={0: np.zeros((1, 3, 2), np.float32)},
        moved_vertices=np.stack([TRIANGLE["vertices"], 2 * TRIANGLE["vertices"]]),
        moved_normals=np.ones((2, 1, 3, 3), np.float32),
    ),
    "SceneDescription.add_shape": method(scene, "add_shape", shape=shapes.nurbs_sphere()),
    "SceneDescription.add_surface": method(
        scene,
        "add_surface",
        name="a",
        splines=[_core.NurbsSpline(PATCH, 2, 2)],
        moved_splines=[[_core.NurbsSpline(PATCH, 2, 2)], [_core.NurbsSpline(PATCH * (2, 2, 2, 1), 2, 2)]],
    ),
    "SceneDescription.add_curve": method(scene, "add_curve", curve=swept()),
    "SceneDescription.copy": method(scene, "copy"),
    "SceneDescription.emptied": method(scene, "emptied"),
    "SceneDescription.shows_same_as": method(scene, "shows_same_as", other=scene()),
    "SceneDescription.shape": method(scene, "shape", index=0),
    "SceneDescription.replace_shape": method(scene, "replace_shape", index=0, shape=shapes.nurbs_sphere()),
    "SceneDescription.replace_material": method(scene, "replace_material", index=0, name="material", surface=program()),
    "SceneDescription.place_instances": method(
        scene, "place_instances", indices=np.zeros(1, np.int32), matrices=np.eye(4)[None]
    ),
    "SceneDescription.clear_lamps": method(scene, "clear_lamps"),
    "SceneDescription.add_material": method(
        scene,
        "add_material",
        name="material",
        surface=program(),
        volume=_core.VolumeVisualisation(),
        displacement=(program(), 0, -1),
        medium=program(),
    ),
    "SceneDescription.add_material_list": method(scene, "add_material_list", materials=[0, -1]),
    "SceneDescription.add_instance": method(
        scene, "add_instance", name="a", shape=0, matrix=np.eye(4), motion=MOTION, linking=[1, 1, 0, -1]
    ),
    "SceneDescription.add_ray_interpolation": method(
        scene, "add_ray_interpolation", object="a", interpolation=_core.RayInterpolation()
    ),
    "SceneDescription.add_instances": method(scene, "add_instances", **INSTANCES),
    "SceneDescription.add_lamp": method(
        scene,
        "add_lamp",
        name="lamp",
        kind="POINT",
        matrix=np.eye(4),
        strength=(1.0, 1.0, 1.0),
        emission=program(),
        link=(0, -1),
    ),
    "SceneDescription.set_world": method(
        scene, "set_world", world=program(), medium=program(), light_group=1, visibility=31, lit_by=1
    ),
    "SceneDescription.matte_attributes": method(scene, "matte_attributes", kind="OBJECT", layer="CryptoObject"),
    "SceneDescription.set_texture_space": method(
        scene, "set_texture_space", shape=0, low=(0.0, 0.0, 0.0), high=(1.0, 2.0, 3.0)
    ),
    "SceneDescription.set_camera": method(scene, "set_camera", **CAMERA),
    "SceneDescription.add_image_file": method(
        scene, "add_image_file", name="a", path="nowhere", color_space="SRGB", config="", picture=0, alpha="OPACITY"
    ),
    "SceneDescription.leave_out_unreadable_images": method(scene, "leave_out_unreadable_images"),
    "SceneDescription.add_packed_image": method(
        scene, "add_packed_image", name="a", content=ONE_PIXEL, color_space="SRGB", config="", alpha="IGNORED"
    ),
    "SceneDescription.add_image_pixels": method(
        scene,
        "add_image_pixels",
        name="a",
        pixels=np.ones((2, 3, 4), np.float32),
        color_space="SRGB",
        config="",
        alpha="SEPARATE",
    ),
    "Settings": ctor(_core.Settings),
    "Session": later(_core.Session, scene=scene, settings=settings, ray_caches=_core.RayCacheStore),
    "Session.render": method(session, "render"),
    "Session.build": method(session, "build"),
    "Session.render_blocks": method(built, "render_blocks", size=2),
    "Session.render_more": method(built, "render_more", count=1),
    "Session.cancel": method(session, "cancel"),
    "Session.progress": method(session, "progress"),
    "Session.pass_pixels": method(lambda: session(True), "pass_pixels", name="combined"),
    "Session.statistics": method(session, "statistics"),
    "Session.sums": method(lambda: _core.Session(scene(), settings(keep_sums=True)), "sums"),
    "Session.write_exr": method(lambda: session(True), "write_exr", path=in_temporary("rayleaf_bad_arguments.exr")),
    "Session.write_ppm": method(lambda: session(True), "write_ppm", path=in_temporary("rayleaf_bad_arguments.ppm")),
    "sampler_pairs": ctor(_core.sampler_pairs, pixel=1, samples=4, dimension=2),
    "filter_offsets": ctor(_core.filter_offsets, kind=_core.PixelFilterKind.BOX, width=1.5, random=NUMBERS),
    "transferred_differential": ctor(_core.transferred_differential, incoming=ROWS, direction=UP, t=1.0, normal=UP),
    "reflected_differential": ctor(
        _core.reflected_differential, incoming=ROWS, direction=UP, normal=UP, dn_dx=UP, dn_dy=UP
    ),
    "refracted_differential": ctor(
        _core.refracted_differential, incoming=ROWS, direction=UP, normal=UP, dn_dx=UP, dn_dy=UP, eta=1.5
    ),
    "LightProbe": later(_core.LightProbe, scene=scene),
    "LightProbe.sample": method(
        lambda: _core.LightProbe(scene()), "sample", position=np.array(UP), random=PAIRS, lit_by=1, normal=np.array(UP)
    ),
    "LightProbe.look": method(
        lambda: _core.LightProbe(scene()),
        "look",
        position=np.array(UP),
        directions=RAYS["directions"],
        lit_by=1,
        normal=np.array(UP),
    ),
    "LightProbe.count": method(lambda: _core.LightProbe(scene()), "count"),
}
