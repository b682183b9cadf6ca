"""What fills volumes: the grids of Blender's Volume objects, and those that simulations of smoke and fire hold."""

import tempfile
from collections.abc import Callable, Iterable
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import cycles_versions, versions
from ..names import name_of, text_of

# Grids of a simulation: the property, channels, and whether noise makes it finer.
_SIMULATED = {
    "density": ("density_grid", 1, True),
    "color": ("color_grid", 4, True),
    "flame": ("flame_grid", 1, True),
    "temperature": ("temperature_grid", 1, True),
    "heat": ("heat_grid", 1, False),
    "velocity": ("velocity_grid", 3, False),
}

Grids = dict[str, Any]  # the core's, by name


def gas_domain(owner: Any) -> Any | None:
    """The settings of the simulation of smoke or fire of which an object is the domain; None of others."""
    for modifier in owner.modifiers:
        if modifier.type == "FLUID" and modifier.fluid_type == "DOMAIN":
            if modifier.domain_settings.domain_type == "GAS":
                return modifier.domain_settings
    return None


def density_unit(data: Any) -> str:
    """Whether a volume's densities are per unit of the object's space or of the world."""
    return "OBJECT" if hasattr(data, "grids") and data.render.space == "OBJECT" else "WORLD"


def grids_of(core: ModuleType, owner: Any, data: Any, reads: Iterable[str], frame: int) -> Grids:
    """Those of an evaluated object that are read and there. Raises the core's InputError."""
    if hasattr(data, "grids"):
        return _volume_grids(core, owner, data, sorted(reads))
    return _simulated_grids(core, owner, frame, sorted(reads))


def _volume_grids(core: ModuleType, owner: Any, data: Any, reads: list[str]) -> Grids:
    name = name_of(owner)
    loaded = data.grids.load()
    path = text_of(data.grids, "frame_filepath")
    rule: dict[str, Any] = dict(
        value_place=cycles_versions.place_of_grid_values(), mixing=cycles_versions.mixing_of_grid_values()
    )
    rule["least"] = float(data.render.clipping)
    # What modifiers make is in no file but the one that Blender writes of it.
    if text_of(data, "filepath") and not len(owner.modifiers):
        return dict(core.read_vdb(name, path if loaded and path else _said_path(data), reads, **rule))
    if not len(data.grids):
        return {}
    with tempfile.TemporaryDirectory() as folder:
        made = str(Path(folder) / "volume.vdb")
        data.grids.save(filepath=made)
        return dict(core.read_vdb(name, made, reads, **rule))


def _said_path(data: Any) -> str:
    """Of a file that Blender cannot read, for the message."""
    return versions.absolute_path(text_of(data, "filepath"), data)


def _simulated_grids(core: ModuleType, owner: Any, frame: int, reads: list[str]) -> Grids:
    domain = gas_domain(owner)
    if domain is None or not domain.cache_frame_start <= frame <= domain.cache_frame_end:
        return {}
    coarse = np.array(domain.domain_resolution, np.int64)
    fine = coarse * (domain.noise_scale if domain.use_noise else 1)
    grids = {}
    for name in reads:
        if name not in _SIMULATED:
            continue
        attribute, channels, follows_noise = _SIMULATED[name]
        size = fine if follows_noise else coarse
        values = _numbers(getattr(domain, attribute))
        if len(values) > 0 and len(values) == size.prod() * channels:
            shape = (*(int(length) for length in size[::-1]), channels)
            to_object = _in_texture_space(owner.data, size)
            described = (name_of(owner), name, values.reshape(shape), to_object, domain.clipping)
            grids[name] = core.VoxelGrid(*described, mixing=cycles_versions.mixing_of_grid_values())
    return grids


def _numbers(array: Any) -> NDArray[np.float32]:
    values = np.empty(len(array), np.float32)
    if len(values) > 0:
        array.foreach_get(values)
    return values


def _in_texture_space(mesh: Any, size: NDArray[np.int64]) -> NDArray[np.float64]:
    """From voxels to object space: a simulation fills the box of its mesh's texture space."""
    half, middle = np.array(mesh.texspace_size, np.float64), np.array(mesh.texspace_location, np.float64)
    step = 2.0 * half / size
    matrix = np.diag([*step, 1.0])
    matrix[:3, 3] = middle - half + 0.5 * step
    return matrix


def check_grids(grids: Grids, reads: Iterable[str], warn: Callable[[str], None]) -> None:
    """Tells of grids that are read and not there, and of bad numbers."""
    for name in sorted(set(reads) - set(grids)):
        warn(f"there is no grid '{name}'")
    for name, grid in grids.items():
        if grid.bad_numbers > 0:
            warn(f"grid '{name}' holds {grid.bad_numbers} numbers that are not finite; taken as 0")
