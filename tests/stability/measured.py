"""Measured errors and the bounds they must keep: checked, and written where RAYLEAF_STABILITY names a file."""

import json
import os
from pathlib import Path

import numpy as np


def check_bound(case: str, quantity: str, measured: float, bound: float, unit: str) -> None:
    """Fails if `measured` is above `bound` or is no number; records both."""
    path = os.environ.get("RAYLEAF_STABILITY")
    if path:
        line = {"case": case, "quantity": quantity, "measured": float(measured), "bound": float(bound), "unit": unit}
        with Path(path).open("a", encoding="utf-8") as file:
            file.write(json.dumps(line) + "\n")
    assert np.isfinite(measured), f"{case}: {quantity} is {measured}"
    assert measured <= bound, f"{case}: {quantity} is {measured:.3g} {unit}, more than {bound:.3g}"
