"""Views of stereoscopic pictures: how many there are, and where each is seen from."""

from collections.abc import Callable
from typing import Any

import numpy as np

from .export.camera import Eye


_SIDES = {"left": -1, "right": 1}  # by the names that Blender gives views of both eyes


def views(engine: Any, scene: Any) -> list[str]:
    """The names of the views that Blender wants; one without a name where pictures are not stereoscopic."""
    if not scene.render.use_multiview:
        return [""]
    return [view.name for view in engine.get_result().views]


def eye_in(engine: Any, depsgraph: Any, view: str) -> Callable[[], Eye] | None:
    """Tells where a view is seen from, whenever it is asked; None for that of the scene's camera itself. From now on the
    view is Blender's active one."""
    if not view:
        return None
    engine.active_view_set(view)

    def eye() -> Eye:
        # Views may have cameras of their own; or Blender puts the scene's to the left and to the right.
        camera = engine.camera_override or depsgraph.scene_eval.camera
        camera = camera.original.evaluated_get(depsgraph)
        turns = bool(engine.use_spherical_stereo(camera))
        matrix = np.array(engine.camera_model_matrix(camera, use_spherical_stereo=turns), np.float64)
        shift = float(engine.camera_shift_x(camera, use_spherical_stereo=turns))
        return Eye(camera, matrix, shift, _SIDES.get(view, 0) if turns else 0)

    return eye
