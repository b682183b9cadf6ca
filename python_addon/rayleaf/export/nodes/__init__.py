"""The compiler from Blender's node trees to the core's flat shader program.

`compiler.py` walks a tree; the other modules each know one family of nodes and register a function per node.
"""


def load_nodes() -> None:
    """Make the families of nodes known to the compiler."""
    from . import closures, colors, inputs, lamps, maths, patterns, principled, sky, spread, textures, tiling, volumes

    assert (
        closures
        and colors
        and inputs
        and lamps
        and maths
        and patterns
        and principled
        and sky
        and spread
        and textures
        and tiling
        and volumes
    )
