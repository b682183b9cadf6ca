"""The panel of panoramic cameras, whose settings Cycles keeps."""

from typing import Any

import bpy

from .ui import _Panel

_FISHEYE = {"FISHEYE_EQUIDISTANT": ("fisheye_fov",), "FISHEYE_EQUISOLID": ("fisheye_lens", "fisheye_fov")}
_ANGLES = ("latitude_min", "latitude_max", "longitude_min", "longitude_max")


class RAYLEAF_PT_panorama(_Panel, bpy.types.Panel):
    """What a panoramic camera shows."""

    bl_label = "Panorama"
    bl_context = "data"

    @classmethod
    def poll(cls, context: Any) -> bool:
        camera = context.camera
        return camera is not None and camera.type == "PANO" and hasattr(camera, "cycles") and super().poll(context)

    def draw(self, context: Any) -> None:
        from . import versions  # loads NumPy, for which enabling the add-on need not wait

        column, settings = self._column(), context.camera.cycles
        column.prop(settings, "panorama_type")
        kind = versions.panorama(context.camera)["panorama_type"]
        for name in _ANGLES if kind == "EQUIRECTANGULAR" else _FISHEYE.get(kind, ()):
            column.prop(settings, name)


register, unregister = bpy.utils.register_classes_factory((RAYLEAF_PT_panorama,))
