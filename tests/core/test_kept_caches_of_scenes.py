"""Ray caches that are shared by several scenes, which are rendered in turn, frame by frame."""

from cached_scenes import ball_scene, render, used, world
from path_scenes import material
from scenes import look_down, matrix, sphere_spline


def samples_of(core, view, scene):
    """Samples that a render took."""
    (cache,) = used(render(core, scene, caches=view, threads=1))
    return cache["samples_taken"]


def taken(core, view, scene):
    """The same of a scene's next frame."""
    view.next_frame()
    return samples_of(core, view, scene)


def test_scenes_rendered_in_turn_keep_what_each_would_keep_alone(core):
    store, kinds = core.RayCacheStore(), ("mirror", "glass")
    in_turn = [[taken(core, store.of_scene(kind), ball_scene(core, kind)) for kind in kinds] for _ in range(3)]
    assert store.count() == 2 and in_turn[1][0] < 0.5 * in_turn[0][0]
    for kind, counts in zip(kinds, zip(*in_turn)):
        alone = core.RayCacheStore()
        assert counts == tuple(taken(core, alone, ball_scene(core, kind)) for _ in range(3)), kind


def test_objects_of_one_name_and_several_shapes_keep_a_cache_in_each_scene(core):
    def scene(radius):
        made = core.SceneDescription()
        shape = made.add_surface("ball", [sphere_spline(core, radius=radius)])
        made.add_instance("ball", shape, matrix(), material(core, made, ("glossy", 1.0, 0.9, 0.0, "SHARP")))
        made.set_world(world(core), 32)
        look_down(made, 6.0, 0.3)
        return made

    store = core.RayCacheStore()
    counts = [[taken(core, store.of_scene(str(radius)), scene(radius)) for radius in (1.0, 0.9)] for _ in range(2)]
    assert store.count() == 2
    assert all(0 <= again < 0.4 * first for first, again in zip(*counts)), counts
    # Within one scene, the cache of the old shape is dropped.
    taken(core, store.of_scene("1.0"), scene(0.8))
    assert store.count() == 2


def test_scenes_share_what_is_equal_until_the_last_lets_it_go(core):
    store = core.RayCacheStore()
    first, second = store.of_scene("first"), store.of_scene("second")
    assert taken(core, first, ball_scene(core, "mirror")) > 0
    assert samples_of(core, second, ball_scene(core, "mirror")) == 0 and store.count() == 1
    for view, left in ((first, 1), (second, 0)):
        view.next_frame()
        view.next_frame()
        assert store.count() == left
