"""Numbers of Blender's settings. Loaded when the add-on is enabled: no NumPy here."""

import struct

BYTES_PER_MEGABYTE = 1_000_000


def as_typed(value: float) -> float:
    """The shortest number that Blender's single precision holds as this one: 0.005, not 0.00499999988."""
    rounded = struct.pack("f", value)
    typed = (float(f"{value:.{digits}g}") for digits in range(1, 10))
    return next(number for number in typed if struct.pack("f", number) == rounded)
