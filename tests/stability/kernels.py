"""The kernels of all instruction sets give the same bits."""

from collections.abc import Callable
from typing import Any

import numpy as np
from core.shapes import trace


def check_same_bits(hits: Callable[[], dict[str, Any]]) -> None:
    """Fails unless rays are answered alike by the kernels of every instruction set; needs the fixture `any_target`."""
    results = []
    for target in trace.simd_targets():
        assert trace.use_simd_target(target)
        results.append(hits())
    assert len(results) >= 2, "only one instruction set: nothing to compare"
    first, *others = results
    for other in others:
        for key in ("t", "u", "v", "position", "normal"):
            np.testing.assert_array_equal(first[key], other[key], err_msg=key)
