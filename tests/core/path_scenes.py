"""What the tests of the integrators share: renders, materials and scenes."""

from scenes import CUBE_TRIANGLES, CUBE_VERTICES, emission, look_down, matrix, quad, sphere_spline

LIGHT_PASSES = [f"{kind}_{part}" for kind in ("diffuse", "glossy", "transmission") for part in ("direct", "indirect")]
COLOR_PASSES = ["diffuse_color", "glossy_color", "transmission_color"]
SURFACE_PASSES = ["depth", "position", "normal", "uv", "object_index", "material_index"]
ALL_PASSES = ["combined", "emission", "environment", *LIGHT_PASSES, *COLOR_PASSES, *SURFACE_PASSES]


def render(core, scene, size=8, samples=64, **settings):
    values = dict(width=size, height=size, samples=samples, clamp_indirect=0.0, filter="BOX", filter_width=1.0)
    session = core.Session(scene, core.Settings(**{**values, **settings}))
    assert session.render()
    return session


def picture(core, scene, **settings):
    return render(core, scene, **settings).pass_pixels("combined")[..., :3]


def material(core, scene, *closures, name="material", bump_shadow="CUBIC", clearing="ALL"):
    """A material of the sum of closures (operation, arguments…, keyword text), as a list for an instance."""
    program = core.Program(name, bump_shadow, clearing)
    for operation, *arguments in closures:
        text = arguments.pop() if isinstance(arguments[-1], str) else ""
        operands = [program.constant(*(a if isinstance(a, tuple) else (a,) * 3), 1) for a in arguments]
        program.operation(operation, operands, text=text)
    return scene.add_material_list([scene.add_material(name, program)])


def lit_plane(core, albedo=0.5, size=20.0):
    scene = core.SceneDescription()
    scene.add_instance("plane", quad(scene, "plane", size), matrix(), material(core, scene, ("diffuse", 1.0, albedo)))
    look_down(scene, half=0.05)
    return scene


def uneven_world(core, strength=1.0):
    program = core.Program("world")
    one, scale = program.constant(1, 1, 1, 1), program.constant(*[1.5] * 4)
    bright, dark = (program.constant(*[strength * part] * 3, 1) for part in (20.0, 0.1))
    program.operation(
        "background", [one, program.operation("checker", [program.operation("generated"), bright, dark, scale]), one]
    )
    return program


def veil(core, scene, transparency, *more, name="veil"):
    return material(core, scene, ("transparent", 1.0, transparency), *more, name=name)


def varied_scene(core):
    """Every kind of lobe, a veil, an emitter, lamps of two kinds and an uneven world."""
    scene = core.SceneDescription()
    floor = material(core, scene, ("diffuse", 0.6, (0.8, 0.5, 0.3)), ("glossy", 0.4, 0.9, 0.3, "GGX"), name="floor")
    scene.add_instance("floor", quad(scene, "floor", 4), matrix(), floor, object_index=3)
    glass = material(core, scene, ("glass", 1.0, (0.9, 1.0, 0.9), 0.0, 1.45, "SHARP"), name="glass")
    scene.add_instance("ball", scene.add_surface("ball", [sphere_spline(core)]), matrix((0.4, 0.1, 1), 0.5), glass)
    hazy = veil(core, scene, 0.4, ("translucent", 0.3, 0.8), ("diffuse", 0.3, (0.2, 0.4, 0.8)))
    scene.add_instance("veil", quad(scene, "veil", 0.5), matrix((-0.5, -0.3, 0.8)), hazy)
    glow = scene.add_material_list([scene.add_material("glow", emission(core, color=(1, 0.6, 0.3), strength=4.0))])
    scene.add_instance(
        "glow", scene.add_mesh("cube", CUBE_VERTICES, CUBE_TRIANGLES), matrix((-0.4, 0.6, 0.4), 0.2), glow
    )
    scene.add_lamp("key", "RECTANGLE", matrix((1, 1, 3)), (60, 60, 50))
    scene.add_lamp("fill", "POINT", matrix((-1, -1, 2)), (10, 10, 20), radius=0.2)
    scene.set_world(uneven_world(core), 32)
    look_down(scene, height=4, half=0.35)
    return scene


def nasty_scene(core, rng):
    """Random materials and lamps with numbers that are zero, tiny or huge."""

    def nasty():
        return float(rng.choice([0.0, 1e-30, 1e-9, 1e-3, 0.5, 1.0, 3.0, 1e6, 1e20, 1e30]))

    scene = core.SceneDescription()
    closures = [
        ("diffuse", nasty(), nasty(), nasty()),
        ("glossy", nasty(), nasty(), nasty(), "GGX"),
        ("glass", nasty(), nasty(), nasty(), nasty(), "BECKMANN"),
        ("transparent", nasty(), nasty()),
        ("emission", nasty(), nasty(), nasty()),
    ]
    for i in range(4):
        chosen = [closures[j] for j in rng.choice(len(closures), 2, replace=False)]
        slots = material(core, scene, *chosen, name=f"material {i}")
        place = matrix(rng.uniform(-1, 1, 3), float(rng.choice([1e-6, 0.5, 1.0])))
        shape = scene.add_surface("ball", [sphere_spline(core)]) if i % 2 else quad(scene, "quad", 1.0)
        scene.add_instance(f"thing {i}", shape, place, slots)
    for kind in ("POINT", "SUN", "SPOT", "RECTANGLE", "DISK"):
        scene.add_lamp(
            kind,
            kind,
            matrix(rng.uniform(-1, 1, 3)),
            (nasty(), nasty(), nasty()),
            radius=nasty(),
            angle=min(nasty(), 3.0),
            size_x=nasty(),
            size_y=nasty(),
            spread=min(nasty(), 3.0),
            spot_size=min(nasty(), 3.0),
        )
    scene.set_world(uneven_world(core), 16)
    look_down(scene, height=3)
    return scene
