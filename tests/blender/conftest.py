"""Gives the tests here the fixture `run_blender`."""

from blender_runner import run_blender  # noqa: F401
