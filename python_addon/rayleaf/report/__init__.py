"""Error against run time: settings are swept over a scene, and every picture is compared with a converged one.

`points` says which settings are tried, `render_points` renders them inside Blender, `errors` and `frontier` judge the
pictures, `frames` sets whole frames beside Cycles, `plots` and `page` make the HTML page of `rayleaf report`, `panel`
is the artist's button. Only `render_points` and `panel` know Blender; only `plots` draws, with matplotlib.
"""
