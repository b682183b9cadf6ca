"""Values of whole instances that materials ask for: the object's colour and properties, the particle it stands for, the place on
what makes it."""

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import versions
from .random_numbers import random_of_number

Floats = NDArray[np.float32]
Value = tuple[float, float, float, float]

# Names no attribute can have in Blender.
OBJECT_COLOR = "\nobject color"
PROPERTY_OF = "\nproperty of object "  # its name follows
PARTICLE = "\nparticle "  # one of Particle Info's outputs follows
INSTANCER = "\ninstancer "  # a texture coordinate of what makes it follows
INSTANCER_GENERATED, INSTANCER_UV = INSTANCER + "generated", INSTANCER + "uv"
INSTANCER_ATTRIBUTE = "\nattribute of instancer "  # its name follows

NONE: Value = (0.0, 0.0, 0.0, 0.0)


def number_value(value: Any) -> Value:
    """As an attribute."""
    return (float(value), float(value), float(value), 1.0)


def _of_vector(value: Any) -> Value:
    return (float(value[0]), float(value[1]), float(value[2]), 1.0)


_PARTICLE_VALUES: dict[str, Callable[[Any, int, int], Value]] = {
    "Index": lambda particle, index, frame: number_value(index),
    "Random": lambda particle, index, frame: number_value(random_of_number(index)),
    "Age": lambda particle, index, frame: number_value(frame - particle.birth_time),
    "Lifetime": lambda particle, index, frame: number_value(particle.lifetime),
    "Location": lambda particle, index, frame: _of_vector(particle.location),
    "Size": lambda particle, index, frame: number_value(particle.size),
    "Velocity": lambda particle, index, frame: _of_vector(particle.velocity),
    "Angular Velocity": lambda particle, index, frame: _of_vector(particle.angular_velocity),
}


def _property_at(owner: Any, path: str) -> Value | None:
    """A number, or up to four of them, at a path from a data block; missing ones 0, alpha 1."""
    try:
        value = owner.path_resolve(path)
    except (ValueError, TypeError):
        return None
    if isinstance(value, (bool, int, float)):
        return number_value(value)
    try:
        numbers = [float(each) for each in value][:4]
    except (ValueError, TypeError):
        return None
    red, green, blue, alpha = numbers + [0.0, 0.0, 0.0, 1.0][len(numbers) :]
    return (red, green, blue, alpha) if numbers else None


def found_property(holder: Any, name: str) -> Value | None:
    """A custom property of a data block, else a property of Blender's."""
    quoted = name.replace("\\", "\\\\").replace('"', '\\"')
    found = _property_at(holder, f'["{quoted}"]')
    return _property_at(holder, name) if found is None else found


def first_property(holders: Iterable[Any], name: str) -> Value:
    """Of the first holder that has it; None among them has none. 0 without."""
    for holder in holders:
        found = None if holder is None else found_property(holder, name)
        if found is not None:
            return found
    return NONE


def scene_holders(depsgraph: Any) -> tuple[Any, ...]:
    """The data blocks whose properties count as a scene's, the first that has one."""
    scene, layer = depsgraph.scene_eval, depsgraph.view_layer_eval
    return (layer, scene, versions.world_of(scene, layer))


def property_of(owner: Any, name: str) -> Value:
    """A property of an object, else of its data; 0 without."""
    return first_property((owner, owner.data), name)


def is_instance_value(name: str) -> bool:
    """Whether an attribute is one of these."""
    return name == OBJECT_COLOR or name.startswith((PROPERTY_OF, PARTICLE, INSTANCER, INSTANCER_ATTRIBUTE))


def of_object(owner: Any, name: str) -> Value:
    """An attribute that all instances of an object share."""
    if name == OBJECT_COLOR:
        red, green, blue, alpha = owner.color
        return (red, green, blue, alpha)
    return property_of(owner, name.removeprefix(PROPERTY_OF))


def of_particle(known: tuple[Any, int] | None, name: str, frame: int) -> Value:
    """A value of a particle of a system; children and what is no particle have none, but a number of chance."""
    output = name.removeprefix(PARTICLE)
    system, index = (None, 0) if known is None else known
    if system is None or not 0 <= index < len(system.particles):
        return number_value(random_of_number(0)) if output == "Random" else NONE
    return _PARTICLE_VALUES[output](system.particles[index], index, frame)


def of_instancer(depsgraph: Any, name: str) -> Floats:
    """(n, 4): a texture coordinate of what makes them, of all in the depsgraph's list; 0 where nothing does. Generated
    ones are halved and moved as Cycles does it."""
    rows: list[tuple[float, ...]] = []
    for instance in depsgraph.object_instances:  # to the end: see instances.collect
        if not instance.is_instance:
            rows.append(NONE)
        elif name == INSTANCER_UV:
            rows.append((*instance.uv, 0.0, 1.0))
        else:
            x, y, z = instance.orco
            rows.append((0.5 * x - 0.5, 0.5 * y - 0.5, 0.5 * z - 0.5, 1.0))
    return np.array(rows, np.float32)
