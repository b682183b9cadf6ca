"""How far light is followed, how much of it one sample may bring, and what is left out of it."""

from bpy.props import BoolProperty, FloatProperty, IntProperty


class LightPaths:
    """These properties, for the scene's settings to inherit."""

    max_bounces: IntProperty(  # type: ignore
        name="Total",
        description="How often light may bounce in all. Raise it where glass in glass, or mirrors in mirrors, turn black",
        default=12,
        min=0,
        max=1024,
    )
    diffuse_bounces: IntProperty(  # type: ignore
        name="Diffuse",
        description="How often light may bounce between matte surfaces. Raise it for interiors that are too dark",
        default=4,
        min=0,
        max=1024,
    )
    glossy_bounces: IntProperty(  # type: ignore
        name="Glossy",
        description="How often light may be mirrored. Raise it where reflections of mirrors turn black",
        default=4,
        min=0,
        max=1024,
    )
    transmission_bounces: IntProperty(  # type: ignore
        name="Transmission",
        description="How often light may enter or leave glass. Raise it where glass behind glass turns black",
        default=12,
        min=0,
        max=1024,
    )
    transparent_bounces: IntProperty(  # type: ignore
        name="Transparent",
        description="Surfaces that a ray may pass straight through. Raise it where leaves with cut-out pictures turn black",
        default=8,
        min=0,
        max=1024,
    )
    volume_bounces: IntProperty(  # type: ignore
        name="Volume",
        description="How often fog and smoke may scatter light again. Raise it for dense clouds that are too dark",
        default=0,
        min=0,
        max=1024,
    )
    roulette_start: IntProperty(  # type: ignore
        name="Russian Roulette",
        description="Bounces after which dim paths may end by chance. Lower is faster and noisier",
        default=3,
        min=0,
        max=1024,
    )
    shadow_bias: FloatProperty(  # type: ignore
        name="Shadow Bias",
        description="What is nearer than this to a shaded point casts no shadow on it, for pictures like those of older"
        " ray tracers; 0 is right, and free of acne",
        default=0.0,
        min=0.0,
        subtype="DISTANCE",
        unit="LENGTH",
        precision=6,
    )
    clamp_direct: FloatProperty(  # type: ignore
        name="Direct",
        description="The most light that one sample may bring straight from lights; 0 for no limit. Lower removes bright"
        " specks, and darkens a little",
        default=0.0,
        min=0.0,
    )
    clamp_indirect: FloatProperty(  # type: ignore
        name="Indirect",
        description="The most light that one sample may bring after bounces; 0 for no limit. Lower removes bright specks,"
        " and darkens a little",
        default=10.0,
        min=0.0,
    )
    filter_glossy: FloatProperty(  # type: ignore
        name="Filter Glossy",
        description="Blur mirrors and glass that are seen by light from matte surfaces: higher brings less noise and"
        " softer caustics, 0 changes nothing",
        default=1.0,
        min=0.0,
        soft_max=10.0,
        max=1e6,
    )
    use_reflective_caustics: BoolProperty(  # type: ignore
        name="Reflective",
        description="Light that comes to matte surfaces by way of mirrors. Without it there is less noise, and some"
        " light is missing",
        default=True,
    )
    use_refractive_caustics: BoolProperty(  # type: ignore
        name="Refractive",
        description="Light that comes to matte surfaces through glass. Without it there is less noise, and what stands"
        " behind glass is darker",
        default=True,
    )
