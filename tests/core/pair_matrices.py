"""How evenly the renderer's first pairs of random numbers are spread together, and the search for matrices that do it.

Pair k of N = 2^m samples has the digits of (C1 M, C2 M) times those of the sample's index, over GF(2): C1 is the identity,
C2 Pascal's triangle, which are the first two dimensions of Sobol, and M the pair's own matrix, upper triangular, with ones
on its diagonal. An elementary interval of d1..d4 digits in four numbers holds as many samples as any other if the first
d1..d4 rows of the four matrices are independent (Niederreiter 1992, theorem 4.28); scrambling does not change that.

`python3 pair_matrices.py` prints steps for core/base/random.h, pair by pair in the order of `ORDER`.
"""

import functools
import random
from collections.abc import Sequence

SHIFTS = (1, 2, 3, 5)  # steps of a matrix add digits to those so many places before them
ORDER = ("filter", "light of vertex 0", "scatter of 0", "light of 1", "scatter of 1", "lens", "time")
Steps = list[int]  # of a matrix: which digits each step adds
Rows = list[int]  # of a matrix: digits of the index, as bits


def times(index: int, steps: Sequence[int]) -> int:
    """The matrix times an index's digits."""
    for digits, shift in zip(steps, SHIFTS):
        index ^= (index & digits) >> shift
    return index


def pascal(index: int) -> int:
    """C2 times an index's digits."""
    for digits, shift in ((0xAAAAAAAA, 1), (0xCCCCCCCC, 2), (0xF0F0F0F0, 4), (0xFF00FF00, 8), (0xFFFF0000, 16)):
        index ^= (index & digits) >> shift
    return index


def rows(steps: Sequence[int], m: int) -> list[Rows]:
    """Of both matrices of a pair, for 2^m samples."""
    both: list[Rows] = [[0] * m, [0] * m]
    for column in range(m):
        first = times(1 << column, steps)
        for matrix, digits in zip(both, (first, pascal(first))):
            for row in range(m):
                matrix[row] |= (digits >> row & 1) << column
    return both


def independent(vectors: Rows) -> bool:
    """Over GF(2)."""
    basis: Rows = []
    for vector in vectors:
        for other in basis:
            vector = min(vector, vector ^ other)
        if vector == 0:
            return False
        basis = sorted([*basis, vector], reverse=True)
    return True


def compositions(total: int, parts: int) -> list[tuple[int, ...]]:
    """All ways to divide digits among numbers."""
    if parts == 1:
        return [(total,)]
    return [(first, *rest) for first in range(total + 1) for rest in compositions(total - first, parts - 1)]


@functools.cache
def intervals(digits: int, numbers: int) -> list[tuple[int, ...]]:
    """Shapes of elementary intervals that join the last pair of numbers to those before it."""
    return [c for c in compositions(digits, numbers) if any(c[:-2]) and any(c[-2:])]


def uneven(pairs: Sequence[Sequence[int]], m: int, digits: int) -> int:
    """How many shapes of so many digits do not hold the same number of 2^m samples everywhere."""
    matrices = [matrix for steps in pairs for matrix in rows(steps, m)]
    shapes = intervals(digits, len(matrices))
    return sum(not independent([row for n, matrix in zip(c, matrices) for row in matrix[:n]]) for c in shapes)


def cost(pairs: Sequence[Sequence[int]], m: int) -> float:
    """Of uneven shapes: the larger the intervals, the more a picture shows of it."""
    numbers = 2 * len(pairs)
    return sum(
        2.0 ** (m - digits) * uneven(pairs, m, digits) / len(intervals(digits, numbers)) for digits in range(2, m + 1)
    )


def search(before: list[Steps], most_digits: int, beam: int, chance: random.Random) -> Steps:
    """The matrix of a further pair, column by column: what a column makes of fewer samples stays as it is."""
    found: list[tuple[float, float, Steps]] = [(0.0, 0.0, [0] * len(SHIFTS))]
    joint = [([other], 1.0) for other in before] + ([(before, 0.5)] if len(before) == 2 else [])
    for m in range(2, most_digits + 1):
        usable = [i for i, shift in enumerate(SHIFTS) if shift < m]
        further = []
        for so_far, _, steps in found:
            for choice in range(1 << len(usable)):
                longer = list(steps)
                for bit, i in enumerate(usable):
                    longer[i] |= (choice >> bit & 1) << (m - 1)
                worse = sum(share * cost([*others, longer], m) for others, share in joint)
                further.append((so_far + worse, chance.random(), longer))
        found = sorted(further)[:beam]
    best = found[0][2]
    rest = [chance.getrandbits(32) >> most_digits << most_digits for _ in SHIFTS]
    return [digits | more for digits, more in zip(best, rest)]


def main() -> None:
    """Prints the matrices."""
    chance = random.Random(2)
    pairs: list[Steps] = [[0] * len(SHIFTS)]
    for name in ORDER[1:]:
        pairs.append(search(pairs, 10 if len(pairs) == 1 else 9, 12, chance))
        print(f"{name}: {', '.join(f'{digits:#010x}' for digits in pairs[-1])}", flush=True)


if __name__ == "__main__":
    main()
