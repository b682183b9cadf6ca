"""The kernels of all instruction sets give the same bits."""

from collections.abc import Callable
from typing import Any

import numpy as np
from core.shapes import trace
from stability.measured import check_bound


def check_same_bits(case: str, hits: Callable[[], dict[str, Any]]) -> None:
    """Fails unless rays are answered alike by the kernels of every instruction set; needs the fixture `any_target`."""
    results = []
    for target in trace.simd_targets():
        assert trace.use_simd_target(target)
        results.append(hits())
    assert len(results) >= 2, "only one instruction set: nothing to compare"
    first, *others = results
    names = ("t", "u", "v", "position", "normal")
    different = sum(int(np.sum(first[name] != other[name])) for other in others for name in names)
    check_bound(case, "kernels differ", different, 0, "numbers")
