"""From Blender's data to the core's plain scene description."""


class ExportCancelled(Exception):
    """The user asked to stop while the scene was being exported."""
