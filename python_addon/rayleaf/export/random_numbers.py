"""An object's random number, as Cycles computes it, so that materials look alike in both.

Objects that stand for themselves hash their name; instances have a number of Blender's. The hash is Bob Jenkins' lookup3
(public domain) of two words.
"""

_WORD = 0xFFFFFFFF
_SEED = 0xDEADBEEF + (2 << 2) + 13  # lookup3's start for two words


def _rotate(value: int, bits: int) -> int:
    return ((value << bits) | (value >> (32 - bits))) & _WORD


def _hash_two_words(x: int, y: int) -> int:
    """lookup3's final mix."""
    a, b, c = (_SEED + x) & _WORD, (_SEED + y) & _WORD, _SEED & _WORD
    c = ((c ^ b) - _rotate(b, 14)) & _WORD
    a = ((a ^ c) - _rotate(c, 11)) & _WORD
    b = ((b ^ a) - _rotate(a, 25)) & _WORD
    c = ((c ^ b) - _rotate(b, 16)) & _WORD
    a = ((a ^ c) - _rotate(c, 4)) & _WORD
    b = ((b ^ a) - _rotate(a, 14)) & _WORD
    return ((c ^ b) - _rotate(b, 24)) & _WORD


def random_of_name(name: str) -> float:
    """0..1."""
    word = 0
    for byte in name.encode():
        word = (word * 37 + byte) & _WORD
    return _hash_two_words(word, 0) / _WORD
