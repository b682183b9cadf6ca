"""An object's random number, as Cycles computes it, so that materials look alike in both.

Objects that stand for themselves hash their name; instances have a number of Blender's. The hash is Bob Jenkins' lookup3
(public domain) of one or two words.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

_WORD = 0xFFFFFFFF
_SEED = 0xDEADBEEF + (2 << 2) + 13  # lookup3's start for two words


def _rotate(value: Any, bits: int) -> Any:
    return ((value << bits) | (value >> (32 - bits))) & _WORD


def _hash_two_words(x: Any, y: Any) -> Any:
    """lookup3's final mix; of numbers, or of arrays with room for 64 bits."""
    return _final_mix((_SEED + x) & _WORD, (_SEED + y) & _WORD, _SEED & _WORD)


def _final_mix(a: Any, b: Any, c: Any) -> Any:
    c = ((c ^ b) - _rotate(b, 14)) & _WORD
    a = ((a ^ c) - _rotate(c, 11)) & _WORD
    b = ((b ^ a) - _rotate(a, 25)) & _WORD
    c = ((c ^ b) - _rotate(b, 16)) & _WORD
    a = ((a ^ c) - _rotate(c, 4)) & _WORD
    b = ((b ^ a) - _rotate(a, 14)) & _WORD
    return ((c ^ b) - _rotate(b, 24)) & _WORD


def random_of_words(words: NDArray[np.int64]) -> NDArray[np.float32]:
    """0..1 by one word each."""
    seed = 0xDEADBEEF + (1 << 2) + 13  # lookup3's start for one word
    return np.asarray(_final_mix((seed + words) & _WORD, seed & _WORD, seed & _WORD) / _WORD, np.float32)


def random_of_name(name: bytes) -> float:
    """0..1."""
    word = 0
    for byte in name:
        word = (word * 37 + byte) & _WORD
    return float(_hash_two_words(word, 0) / _WORD)


def random_of_number(number: int) -> float:
    """0..1."""
    return float(_hash_two_words(number & _WORD, 0) / _WORD)


def random_of_index(count: int) -> NDArray[np.float32]:
    """(count,) 0..1: of the strands of an object, by their number."""
    return np.asarray(_hash_two_words(np.arange(count, dtype=np.int64), 0) / _WORD, np.float32)
