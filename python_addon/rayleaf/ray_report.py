"""What ray interpolation did in a render, in words: for panels, and for the message after a render on Auto."""

from collections.abc import Iterable
from typing import Any

_MOST_NAMES = 5  # of objects in one message


def caches(record: dict[str, Any]) -> list[dict[str, Any]]:
    """One entry a tree, and one for objects that have none, of what a render recorded (frame.py)."""
    return list(record.get("core", {}).get("ray_caches", []))


def names(cache: dict[str, Any]) -> str:
    """The objects of an entry: those listed, and how many more share it."""
    more = cache["instances"] - len(cache["objects"])
    return ", ".join(cache["objects"]) + (f" and {more} more" if more > 0 else "")


def of_object(record: dict[str, Any], name: str) -> dict[str, Any] | None:
    """The entry that lists an object; None where there is none, as for those whose interpolation is off."""
    return next((each for each in caches(record) if name in each["objects"]), None)


def outcome(cache: dict[str, Any]) -> list[str]:
    """How the rays against an entry's objects were answered, and what Auto went by."""
    if not cache["used"]:
        return [f"traced: {cache['reason']}"]
    queries = cache["queries"]
    followed = ("followed",) if cache["followed"] else ()
    ways = ("interpolated", *followed, "traced", "missed")
    shares = ", ".join(f"{cache[how] / max(queries, 1):.0%} {how}" for how in ways)
    memory = f"{cache['bytes'] / 1e6:.1f} MB, and {cache['tracer_bytes'] / 1e6:.1f} MB to trace by"
    return [f"{queries:,} rays: {shares}", memory] + ([cache["reason"]] if cache["reason"] else [])


def _listed(entries: list[dict[str, Any]]) -> str:
    found = [name for each in entries for name in each["objects"]]
    count = sum(each["instances"] for each in entries)
    shown = found[:_MOST_NAMES]
    return ", ".join(shown) + (f" and {count - len(shown)} more" if count > len(shown) else "")


def decision(record: dict[str, Any]) -> str:
    """What Auto decided for which objects, and why; empty if there was nothing to decide."""
    decided = [each for each in caches(record) if each["mode"] == "AUTO"]
    if not decided:
        return ""
    used = [each for each in decided if each["used"]]
    parts = [f"on for {_listed(used)}"] if used else []
    for reason in _in_order(_kind_of_reason(each) for each in decided if not each["used"]):
        parts.append(
            f"off for {_listed([e for e in decided if not e['used'] and _kind_of_reason(e) == reason])} ({reason})"
        )
    return "Ray interpolation on Auto: " + "; ".join(parts)


def _kind_of_reason(cache: dict[str, Any]) -> str:
    """Without the figures of a probe, so that objects with the same fate share one part of a message."""
    return "a probe found tracing faster" if cache["reason"].startswith("probe:") else str(cache["reason"])


def _in_order(items: Iterable[str]) -> list[str]:
    return list(dict.fromkeys(items))
