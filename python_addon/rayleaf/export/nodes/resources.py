"""What programs refer to, and what compiling a tree asked for."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

from ..attributes import ACTIVE_COLOR, ACTIVE_UV
from ..images import ImageLibrary
from ..instance_values import Value, first_property


@dataclass
class Asked:
    """What the compilation of one tree asked for."""

    attributes: set[str] = field(default_factory=set)
    images: bool = False


@dataclass
class Resources:
    """What programs refer to: images, attribute ids; and what the shapes must carry because of it."""

    attribute_id: Callable[[str], int]
    images: ImageLibrary
    frame: int
    # By name the outputs that a view layer asks for: the slot of the core's film, and whether it is a colour.
    aovs: dict[str, tuple[int, bool]] = field(default_factory=dict)
    wanted_attributes: set[str] = field(default_factory=set)
    scene_holders: tuple[Any, ...] = ()  # data blocks whose properties are the scene's
    scene_properties: dict[str, Value] = field(default_factory=dict)  # those that programs hold

    def scene_property(self, name: str) -> Value:
        """A property of the view layer, else of the scene, else of the world; 0 without."""
        self.scene_properties[name] = first_property(self.scene_holders, name)
        return self.scene_properties[name]

    def attribute(self, name: str) -> int:
        """The id of an attribute; shapes that have it will carry it."""
        self.wanted_attributes.add(name)
        return self.attribute_id(name)

    @contextmanager
    def noted(self) -> Iterator[Asked]:
        """Notes what is asked for meanwhile."""
        asked, before = Asked(), self.wanted_attributes
        count, self.wanted_attributes = self.images.asked, asked.attributes
        try:
            yield asked
        finally:
            asked.images = self.images.asked > count
            self.wanted_attributes = before | asked.attributes

    def active_uv(self) -> int:
        """The active UV map, as operations name it."""
        self.wanted_attributes.add(ACTIVE_UV)
        return -1

    def active_color(self) -> int:
        """The active colour attribute."""
        return self.attribute(ACTIVE_COLOR)
