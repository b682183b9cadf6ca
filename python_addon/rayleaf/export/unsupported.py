"""What is set in a scene and not rendered: each is named once, with what it belongs to."""

from collections.abc import Iterable
from typing import Any

from .. import passes, versions
from ..messages import Messages, Subject
from ..names import name_of

# Properties of a view layer that begin like passes and are none.
# (Cryptomatte always counts all samples, which its switch for accuracy asks of other engines.)
_NO_PASSES = {"use_pass_combined", "use_pass_cryptomatte_accurate"}
_MATTES = {f"use_pass_cryptomatte_{kind}" for kind in ("object", "material", "asset")}
# Passes that Blender's Cycles add-on keeps with a view layer.
_CYCLES_PASSES = {
    "pass_debug_sample_count": "Debug Sample Count",
}


def _warn(messages: Messages, subject: Subject, text: str) -> None:
    messages.warn(f"{subject}: {text}", subject)


def name_scene_settings(scene: Any, messages: Messages) -> None:
    """Those of the whole scene."""
    subject = Subject("Scene", name_of(scene))
    own = scene.rayleaf
    if scene.render.use_motion_blur and own.integrator == "DISTRIBUTION" and own.use_irradiance_cache:
        _warn(messages, subject, "the irradiance cache knows no motion; what moves is rendered without it")


def _requested(view_layer: Any) -> Iterable[str]:
    """The passes that a view layer asks for and does not get."""
    known = {entry.switch for entry in passes.table()} | _NO_PASSES | _MATTES
    for prop in view_layer.bl_rna.properties:
        if prop.identifier.startswith("use_pass_") and prop.identifier not in known:
            if getattr(view_layer, prop.identifier):
                yield name_of(prop)
    for name, label in _CYCLES_PASSES.items():
        if versions.cycles_setting(view_layer, name, False):
            yield label


def name_passes(scene: Any, view_layer: Any, messages: Messages) -> None:
    """Passes that the core has not, or not as they are set."""
    subject = Subject("View layer", name_of(view_layer))
    slots = passes.Slots.of(view_layer)
    for text in slots.left_out:
        _warn(messages, subject, f"{text}; left out")
    own = scene.rayleaf
    if slots.light_groups and own.integrator == "DISTRIBUTION" and own.use_irradiance_cache:
        _warn(messages, subject, "the irradiance cache knows no light groups; rendered without it")
    for label in _requested(view_layer):
        _warn(messages, subject, f"the pass {label} is not supported; left out")


def name_object_settings(owner: Any, scene: Any, messages: Messages) -> None:
    """Those of an evaluated object in its scene."""
    if versions.shadow_terminator_shading(owner) > 0.0:
        subject = Subject("Object", name_of(owner))
        _warn(messages, subject, "the shading offset of the shadow terminator is not supported; it is shaded as with 0")
    if scene.rayleaf.integrator == "DISTRIBUTION" and owner.is_shadow_catcher:
        subject = Subject("Object", name_of(owner))
        _warn(messages, subject, "distribution ray tracing knows no shadow catchers; rendered like any object")


def name_volume_settings(material: Any, messages: Messages) -> None:
    """Those of a material that fills an object of grids."""
    if versions.cycles_setting(material, "volume_interpolation", "LINEAR") == "CUBIC":
        subject = Subject("Material", name_of(material))
        _warn(messages, subject, "cubic interpolation of grids is not supported; they are interpolated linearly")
