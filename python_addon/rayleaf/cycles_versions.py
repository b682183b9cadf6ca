"""The one place where Cycles' versions (3.4 to 5.x) make different pictures of the same lamps, materials and volumes."""

import math
from typing import Any

import bpy

from .versions import cycles_setting


def lamp_factor(lamp: Any) -> float:
    """What a lamp's power is multiplied by to give what it meant in Blender 3.

    Since 4.0 an area lamp of P watts sends out 4 / pi of what it did; Blender divides the powers in older files. A sun
    gives its strength to a surface that faces it; before, to one that faces each part of its disk. Since 4.5 there is an
    exposure.
    """
    return 2.0 ** float(getattr(lamp, "exposure", 0.0)) * _power_factor(lamp)


def _power_factor(lamp: Any) -> float:
    if bpy.app.version < (4, 0, 0):
        return 1.0
    if lamp.type == "AREA":
        return 4.0 / math.pi
    if lamp.type == "SUN":
        return 2.0 / (1.0 + math.cos(0.5 * lamp.angle))
    return 1.0


def has_soft_falloff(lamp: Any) -> bool:
    """Whether a point or spot lamp is a disk that faces whoever looks, instead of a sphere. Since 4.2 lamps can be set."""
    return bool(getattr(lamp, "use_soft_falloff", bpy.app.version < (4, 0, 0)))


def spot_profile() -> str:
    """How a spot shines within its cone before it fades; until 4.0 by the cosine to its axis."""
    return "COSINE" if bpy.app.version < (4, 0, 0) else "EVEN"


def rough_diffuse_keeps_energy() -> bool:
    """Whether light that a rough matte surface scatters more than once counts."""
    return bpy.app.version >= (4, 3, 0)


def toon_ends_at_right_angles() -> bool:
    """Whether a glossy toon shader lights nothing at right angles to the mirror direction and beyond."""
    return bpy.app.version >= (4, 0, 0)


def transforms_normals() -> bool:
    """Whether Vector Transform keeps normals at right angles to their surface; before, they were directions."""
    return bpy.app.version >= (4, 0, 0)


def strength_scales_slopes() -> bool:
    """Whether the strength of a normal map in tangent space scales its slopes; before, it mixed the normals."""
    return bpy.app.version >= (4, 0, 0)


def principled_shines_inside() -> bool:
    """Whether a Principled BSDF that is linked to a Volume socket emits by the length of the way."""
    return bpy.app.version < (4, 0, 0)


def facets_hide_jointly() -> bool:
    """Whether microfacets mask and shadow each other jointly (the core's Masking); before, independently."""
    return bpy.app.version >= (3, 5, 0)


def glass_reflects_by_facet() -> bool:
    """Whether each facet of rough glass reflects its own share of light; before 3.6, that of the smooth surface."""
    return bpy.app.version >= (3, 6, 0)


def follows_light_between_facets() -> bool:
    """Whether Cycles' Multiscatter GGX follows light from facet to facet; since 4.0 it scales what one facet scatters."""
    return bpy.app.version < (4, 0, 0)


def place_of_grid_values() -> str:
    """Where in its voxel a value of an OpenVDB grid stands in Cycles, as the core calls it."""
    return "MIDDLE" if bpy.app.version < (5, 0, 0) else "CORNER"


def mixing_of_grid_values() -> str:
    """What Cycles finds between the values of a grid, as the core calls it."""
    return "TRILINEAR" if bpy.app.version < (5, 0, 0) else "STOCHASTIC"


def volume_body(scene: Any) -> str:
    """What grids fill in Cycles, as the core calls it; the steps of its biased volumes go through blocks still."""
    if bpy.app.version < (5, 0, 0) or cycles_setting(scene, "volume_biased", False):
        return "BLOCKS"
    return "BOX" if bpy.app.version < (5, 2, 0) else "NARROW_BOX"


def voronoi_hash() -> str:
    """What chooses the points of Voronoi's cells."""
    return "JENKINS" if bpy.app.version < (5, 0, 0) else "PCG"


def bump_shadow(material: Any) -> str:
    """How the core darkens bumps of a material, as Cycles does; since 4.2 a material may ask for none. 4.4 has the cubic."""
    if not cycles_setting(material, "use_bump_map_correction", True):
        return "NONE"
    return "CUBIC" if bpy.app.version < (4, 5, 0) else "FACETS"


def bump_width_of_displacement() -> float:
    """How far heights are compared where a displacement bends normals, in pixels."""
    return 0.1 if bpy.app.version >= (4, 5, 0) else 1.0


def clearing(material: Any) -> str:
    """Which lobes of a material have normals that are turned until what they mirror clears the facet, as the core calls it."""
    if not cycles_setting(material, "use_bump_map_correction", True):
        return "NONE"
    return "ALL" if bpy.app.version < (3, 6, 0) else "MIRRORS"


def default_surface_is_principled() -> bool:
    """Whether objects without a material look like a Principled node; before, like a Diffuse one. 4.5 has the latter."""
    return bpy.app.version >= (5, 0, 0)


def coats_reflect_by_facet() -> bool:
    """Whether a coat keeps from what lies below what its facets reflect; before 4.5, what it would reflect if it were smooth."""
    return bpy.app.version >= (4, 5, 0)


def thin_films_are_newer() -> bool:
    """Whether films cover metals too, and their colours are those of the standard observer."""
    return bpy.app.version >= (5, 0, 0)


def lamps_have_uv() -> bool:
    """Whether UV coordinates on a lamp are its own; before, they were nothing. 3.4 has none, 4.2 has them."""
    return bpy.app.version >= (4, 0, 0)


def lamps_have_a_space() -> bool:
    """Whether Object coordinates on a lamp are its own; before, the place in the world. 4.3 has none, 4.5 has them."""
    return bpy.app.version >= (4, 4, 0)


def area_lamps_shine_by_direction() -> bool:
    """Whether an IES file is read on an area lamp by where its light goes; before, along the lamp's axis alone. 3.4 does not, 4.2 does."""
    return bpy.app.version >= (4, 0, 0)


def glow_counts_its_weight_twice() -> bool:
    """Whether the light of a Principled Volume is weakened twice by what it is mixed with. In 4.3 it is not, in 4.5 it is."""
    return bpy.app.version >= (4, 4, 0)


def bodies_scatter_after_diffuse_bounces() -> bool:
    """Whether light that was scattered by a diffuse surface still goes through bodies, as in Cycles since 5.0."""
    return bpy.app.version >= (5, 0, 0)


def random_walk_has_mean_free_path() -> bool:
    """Whether the radius of "Random Walk" is a mean free path; the one of fixed radius is called "Legacy" then."""
    return bpy.app.version >= (5, 2, 0)


def passes_unlinked_on() -> bool:
    """Whether what passes on an input that nothing is linked to counts as a link. Since 5.0 trees are made plain first."""
    return bpy.app.version < (5, 0, 0)
