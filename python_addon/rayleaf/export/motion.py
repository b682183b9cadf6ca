"""Where objects and the camera are while the shutter is open, by Blender's and Cycles' settings."""

import math
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import versions
from . import camera
from .deformation import POINTS, WITH_MESH_TWIN, Deformation, Form, Forms, Part
from .deformation import deformation_of, is_exact_surface, is_own_data, of_points

# Instances between two questions whether to stop: some 10 ms.
_CANCEL_STRIDE = 10_000
# At how many even times the shutter's curve is looked at, as Cycles does.
_CURVE_SIZE = 256
# By how much a curve's values differ that exposes all times alike.
_EVEN = 1e-5

# What tells an instance from others at all times: the object that is shown, the one that makes it, and which of its.
Key = tuple[int, int, tuple[int, ...]]
Matrix = tuple[float, ...]  # 16 numbers, row by row
Check = Callable[[], None]


@dataclass(frozen=True)
class Shutter:
    """When it is open, in frames."""

    middle: float
    length: float
    curve: NDArray[np.float32] | None  # None: open all the time alike
    rolling: float | None  # the share of the time for which a row is exposed; None: all rows together
    by_object: bool = True  # whether objects say how closely their motion is followed

    @staticmethod
    def of(scene: Any) -> "Shutter | None":
        """A scene's; None where its pictures are not blurred."""
        length = float(scene.render.motion_blur_shutter)
        if not scene.render.use_motion_blur or length <= 0.0:
            return None
        position, rolling = versions.shutter_position(scene), versions.rolling_shutter(scene)
        middle = _frame_of(scene) + {"START": 0.5, "END": -0.5}.get(position, 0.0) * length
        return Shutter(middle, length, _curve(scene.render.motion_blur_shutter_curve), rolling)

    @staticmethod
    def around(scene: Any) -> "Shutter":
        """From the frame before to the frame after, for the Vector pass."""
        return Shutter(_frame_of(scene), 2.0, None, None, by_object=False)

    def frame_at(self, time: float) -> float:
        """`time` from 0, when it opens, to 1."""
        return self.middle + (time - 0.5) * self.length


def _frame_of(scene: Any) -> float:
    return float(scene.frame_current + scene.frame_subframe)


def _curve(mapping: Any) -> NDArray[np.float32] | None:
    mapping.initialize()
    values = np.array(
        [mapping.evaluate(mapping.curves[0], i / (_CURVE_SIZE - 1)) for i in range(_CURVE_SIZE)], np.float32
    )
    return None if np.ptp(values) < _EVEN else values


@dataclass
class Motions:
    """What moves. Matrices are (steps, 4, 4), at even times from the first to the last moment."""

    instances: dict[Key, NDArray[np.float64]] = field(default_factory=dict)
    camera: dict[str, Any] = field(default_factory=dict)  # more arguments of the core's `set_camera`
    # What deforms, by object and part; a message in place of what cannot be followed.
    deformations: dict[tuple[int, Part], Deformation | str] = field(default_factory=dict)

    def of(self, instance: Any) -> NDArray[np.float64] | None:
        """An instance's of a depsgraph's list; None where it stands still."""
        return self.instances.get(_key_of(instance)) if self.instances else None

    def deformation(self, owner: Any, part: Part) -> Deformation | str | None:
        """An evaluated object's; None where it keeps its form, and why, where that cannot be followed."""
        return self.deformations.get((owner.original.as_pointer(), part)) if self.deformations else None


def _key_of(instance: Any) -> Key:
    if not instance.is_instance:
        return instance.object.original.as_pointer(), 0, ()
    shown, parent = instance.instance_object or instance.object, instance.parent
    maker = 0 if parent is None else parent.original.as_pointer()
    return shown.original.as_pointer(), maker, tuple(instance.persistent_id)


def _own_mesh(instance: Any) -> Any:
    """What an instance shows, where it is the mesh of its own object."""
    owner, shown = instance.instance_object or instance.object, instance.object
    return shown.data if shown.type == "MESH" and is_own_data(owner, shown.data) else None


def _is_beside_mesh(owner: Any, mesh: Any) -> bool:
    """Whether it is another instance that shows the mesh of an object."""
    return mesh is None and owner.type in WITH_MESH_TWIN and not is_exact_surface(owner)


def _own_steps(owner: Any) -> int:
    """The level of steps of an object; 0: it is not blurred."""
    if not versions.cycles_setting(owner, "use_motion_blur", True):
        return 0
    return max(int(versions.cycles_setting(owner, "motion_steps", 1)), 1)


def _times(levels: list[int]) -> int:
    """At how many times an object is looked at: an odd number, so that one is in the middle; those of two levels meet."""
    return 0 if 0 in levels else (2 << (max(levels) - 1)) + 1


class CloudNumbers:
    """Tells the point clouds of an object from one another at all times, by their order in a depsgraph's list."""

    def __init__(self) -> None:
        self._met: dict[int, list[int]] = {}  # by object: its clouds

    def of(self, owner: Any, cloud: Any) -> int:
        """The number of a cloud that is met in a walk over the list."""
        met, pointer = self._met.setdefault(owner.original.as_pointer(), []), cloud.as_pointer()
        if pointer not in met:
            met.append(pointer)
        return met.index(pointer)


def _step(number: int, most: int, count: int) -> int | None:
    """Which of `count` even times is the one of this number among `most`; None if it is between two."""
    step, rest = divmod(number * (count - 1), most - 1)
    return step if rest == 0 else None


@dataclass
class _Track:
    """Where one instance is, by time; None where it was not there."""

    places: list[Matrix | None]
    stays_if_missing: bool  # else it is rendered where it is, without motion

    def matrices(self) -> NDArray[np.float64] | None:
        """None where it stands still."""
        middle = self.places[len(self.places) // 2]
        if None in self.places and not self.stays_if_missing:
            return None
        filled = [middle if place is None else place for place in self.places]
        if all(place == middle for place in filled):
            return None
        return np.array(filled, np.float64).reshape(-1, 4, 4)


class _Gatherer:
    """Takes a scene to the shutter's times, one after the other."""

    def __init__(
        self,
        core: ModuleType,
        engine: Any,
        depsgraph: Any,
        shutter: Shutter,
        picture: camera.Frame,
        check: Check,
        eye: Callable[[], camera.Eye] | None = None,
    ) -> None:
        self._engine, self._depsgraph, self._shutter = engine, depsgraph, shutter
        self._picture, self._check = picture, check
        self._camera_object = depsgraph.scene_eval.camera
        self._eye = eye or self._own_eye
        self._tracks: dict[Key, _Track] = {}
        self._levels: dict[int, int] = {}
        self._views: list[tuple[Matrix, tuple[float, ...]]] = []
        self._forms = Forms(core, depsgraph, check)
        self._forms_of: dict[int, list[dict[Part, Form] | None]] = {}  # of objects that may deform, by time
        self._clouds_of: dict[tuple[int, Part], list[Form | None]] = {}  # of the point clouds of objects, by time

    def motions(self) -> Motions:
        """Ends in the shutter's middle."""
        self.go_to(self._shutter.middle)
        self._start()
        views = 0 if self._camera_object is None else _times([self._level(self._camera_object)])
        self._views = [self._view()] * views if views else []
        counts = [len(forms) for forms in self._forms_of.values()]
        counts += [len(forms) for forms in self._clouds_of.values()]
        counts += [len(track.places) for track in self._tracks.values()]
        most = max([views, *counts])
        for number in range(most):
            if 2 * number == most - 1:
                continue
            self.go_to(self._shutter.frame_at(number / (most - 1)))
            self._take(number, most)
        self.go_to(self._shutter.middle)
        return self._found()

    def go_to(self, frame: float) -> None:
        """Take the scene to a frame."""
        self._check()
        whole = math.floor(frame)
        self._engine.frame_set(whole, frame - whole)

    def _level(self, owner: Any) -> int:
        if not self._shutter.by_object:
            return 1
        pointer = owner.original.as_pointer()
        if pointer not in self._levels:
            self._levels[pointer] = _own_steps(owner)
        return self._levels[pointer]

    def _shown(self) -> Iterator[Any]:
        """The instances to be seen now. Blender frees what objects make only when the list has been walked to its end."""
        listed = iter(self._depsgraph.object_instances)
        try:
            for place, instance in enumerate(listed):
                if place % _CANCEL_STRIDE == 0:
                    self._check()
                if instance.show_self or instance.show_particles:
                    yield instance
        finally:
            deque(listed, maxlen=0)

    def _start(self) -> None:
        clouds = CloudNumbers()
        for instance in self._shown():
            owners = [instance.instance_object or instance.object]
            self._start_forms(instance, owners[0])
            self._start_cloud(instance, owners[0], clouds)
            if instance.is_instance and instance.parent is not None:
                owners.append(instance.parent)
            count = _times([self._level(owner) for owner in owners])
            if count:
                places: list[Matrix | None] = [None] * count
                places[count // 2] = _matrix(instance.matrix_world)
                is_particle = instance.is_instance and instance.particle_system is not None
                self._tracks[_key_of(instance)] = _Track(places, not is_particle)

    def _take(self, number: int, most: int) -> None:
        clouds = CloudNumbers()
        for instance in self._shown():
            track = self._tracks.get(_key_of(instance))
            step = None if track is None else _step(number, most, len(track.places))
            if track is not None and step is not None:
                track.places[step] = _matrix(instance.matrix_world)
            self._take_forms(instance, number, most)
            self._take_cloud(instance, clouds, number, most)
        step = _step(number, most, len(self._views)) if self._views else None
        if step is not None:
            self._views[step] = self._view()

    def _start_forms(self, instance: Any, owner: Any) -> None:
        pointer, count = owner.original.as_pointer(), _times([self._level(owner)])
        if not count or pointer in self._forms_of or not self._forms.may_deform(owner, self._shutter.by_object):
            return
        mesh = _own_mesh(instance)
        if _is_beside_mesh(owner, mesh):
            return
        self._forms_of[pointer] = [None] * count
        self._forms_of[pointer][count // 2] = self._forms.of(owner, mesh)

    def _take_forms(self, instance: Any, number: int, most: int) -> None:
        owner = instance.instance_object or instance.object
        forms = self._forms_of.get(owner.original.as_pointer()) if self._forms_of else None
        step = None if forms is None else _step(number, most, len(forms))
        if forms is None or step is None:
            return
        mesh = _own_mesh(instance)
        if forms[step] is None and not _is_beside_mesh(owner, mesh):
            forms[step] = self._forms.of(owner, mesh)

    def _start_cloud(self, instance: Any, owner: Any, clouds: "CloudNumbers") -> None:
        if not instance.show_self or instance.object.type != "POINTCLOUD":
            return
        pointer, part = owner.original.as_pointer(), (POINTS, clouds.of(owner, instance.object.data))
        count = _times([self._level(owner)])
        if count and (pointer, part) not in self._clouds_of and self._forms.is_wanted(owner, self._shutter.by_object):
            self._clouds_of[pointer, part] = [None] * count
            self._clouds_of[pointer, part][count // 2] = of_points(instance.object.data)

    def _take_cloud(self, instance: Any, clouds: "CloudNumbers", number: int, most: int) -> None:
        if not self._clouds_of or not instance.show_self or instance.object.type != "POINTCLOUD":
            return
        owner = instance.instance_object or instance.object
        part = POINTS, clouds.of(owner, instance.object.data)
        forms = self._clouds_of.get((owner.original.as_pointer(), part))
        step = None if forms is None else _step(number, most, len(forms))
        if forms is None or step is None:
            return
        forms[step] = forms[step] or of_points(instance.object.data)

    def _deformations(self) -> dict[tuple[int, Part], Deformation | str]:
        found: dict[tuple[int, Part], Deformation | str] = {}
        for pointer, forms in self._forms_of.items():
            for part in forms[len(forms) // 2] or {}:
                deformation = deformation_of([None if form is None else form.get(part) for form in forms])
                if deformation is not None:
                    found[pointer, part] = deformation
        for cloud, known in self._clouds_of.items():
            deformation = deformation_of(known)
            if deformation is not None:
                found[cloud] = deformation
        return found

    def _view(self) -> tuple[Matrix, tuple[float, ...]]:
        """The camera's matrix, and its window's corners."""
        eye = self._eye()
        now = eye.camera_object
        is_perspective = now.type == "CAMERA" and now.data.type == "PERSP"
        corners = camera.window(now.data, self._picture, eye.shift_x) if is_perspective else ()
        return _matrix(eye.matrix), tuple(number for corner in corners for number in corner)

    def _own_eye(self) -> camera.Eye:
        return camera.eye_of(self._camera_object.original.evaluated_get(self._depsgraph))

    def _found(self) -> Motions:
        moving = {key: track.matrices() for key, track in self._tracks.items()}
        found = Motions({key: matrices for key, matrices in moving.items() if matrices is not None})
        matrices, windows = [view[0] for view in self._views], [view[1] for view in self._views]
        if len(set(matrices)) > 1:
            found.camera["motion"] = np.array(matrices, np.float64).reshape(-1, 4, 4)
        if len(set(windows)) > 1:
            found.camera["windows"] = np.array(windows, np.float64)
        found.deformations = self._deformations()
        if found.instances or found.camera or found.deformations:
            found.camera |= dict(shutter_curve=self._shutter.curve, rolling_shutter=self._shutter.rolling)
        return found


def _matrix(matrix: Any) -> Matrix:
    return tuple(number for row in matrix for number in row)


@contextmanager
def shutter_open(
    core: ModuleType,
    engine: Any,
    depsgraph: Any,
    picture: camera.Frame,
    shows_vectors: bool,
    check: Check,
    eye: Callable[[], camera.Eye] | None = None,
) -> Iterator[Motions]:
    """What moves; the scene is in the middle of the shutter's time until the context ends. `shows_vectors`: a pass shows
    what moves from frame to frame. `eye`: where the scene's camera stands, if it is not itself."""
    scene = depsgraph.scene_eval
    shutter = Shutter.around(scene) if shows_vectors else Shutter.of(scene)
    if shutter is None:
        yield Motions()
        return
    frame, subframe = scene.frame_current, scene.frame_subframe
    try:
        yield _Gatherer(core, engine, depsgraph, shutter, picture, check, eye).motions()
    finally:
        engine.frame_set(frame, subframe)
