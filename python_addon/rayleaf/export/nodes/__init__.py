"""The compiler from Blender's node trees to the core's flat shader program.

`compiler.py` walks a tree; the other modules each know one family of nodes and register a function per node.
"""


def load_nodes() -> None:
    """Make the families of nodes known to the compiler."""
    from . import closures, colors, inputs, maths, patterns, sky, spread, textures

    assert closures and colors and inputs and maths and patterns and sky and spread and textures
