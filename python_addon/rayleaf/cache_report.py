"""What a render held of facets and what the geometry cache did, in lines: for Blender's status text, which without a window is printed."""

from typing import Any


def _level(name: str, level: dict[str, Any]) -> str:
    counted = f"{level['cold']:,} diced first, {level['lookups']:,} lookups, {level['misses']:,} misses"
    cost = f"{level['vertices_recomputed']:,} vertices again, {level['bytes'] / 1e6:.1f} MB, {level['bypassed']:,} bypassed"
    return f"{name}: {counted}, {level['hit_rate']:.2%} hits, {cost}"


def lines(core: dict[str, Any]) -> list[str]:
    """By level, and the rays by kind, of what the core recorded; nothing where no subpatch was asked for."""
    facets = core["memory"]["facets"]
    resident = [f"Facets in memory: {facets / 1e6:.1f} MB"] if facets else []
    cache = core["geometry_cache"]
    levels = {**cache["levels"], "parts": cache["parts"]}
    if not any(level["lookups"] for level in levels.values()):
        return resident
    sizes = f"{cache['bytes'] / 1e6:.1f} MB, {cache['splits']:,} splits"
    again = f"{cache['vertices_recomputed']:,} of {cache['vertices_diced']:,} vertices computed again"
    rays = ", ".join(f"{count:,} {kind}" for kind, count in core["rays"].items() if count and kind != "pixels")
    told = [_level(name, level) for name, level in levels.items()]
    return [*resident, f"Geometry cache: {sizes}, {again}", *told, f"Rays: {rays}"]
