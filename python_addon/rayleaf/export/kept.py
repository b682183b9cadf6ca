"""What one export leaves to the next of the same view layer: the shapes and programs of what has not changed."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

from .instance_values import Value


@dataclass(frozen=True)
class KeptShape:
    """A shape, and what it is made of."""

    shape: Any  # the core's
    sources: frozenset[int]  # pointers of the original data blocks
    wanted: frozenset[str]  # attributes that it was to carry

    def is_of(self, sources: frozenset[int], wanted: frozenset[str]) -> bool:
        """Whether it is what would be made now, unless one of its sources has changed."""
        return self.sources == sources and self.wanted == wanted


@dataclass(frozen=True)
class CompiledMaterial:
    """The arguments of the core's `add_material`, and what compiling them asked for."""

    arguments: tuple[Any, ...]
    wanted: frozenset[str]  # attributes
    uses_images: bool

    @property
    def displaces(self) -> bool:
        """Whether it moves the points of surfaces."""
        (_name, _surface, _pass_index, _volume, displacement, *_) = self.arguments
        return displacement is not None


@dataclass
class KeptExport:
    """Shapes and programs by what they are exported of; ids of attributes and textures are those of `scene`."""

    scene: Any | None = None  # the core's SceneDescription
    shapes: dict[Any, KeptShape] = field(default_factory=dict)
    materials: dict[int, CompiledMaterial] = field(default_factory=dict)  # by pointer of the original
    scene_properties: dict[str, Value] = field(default_factory=dict)  # of the scene, that they hold

    def without(self, changed: Iterable[int], images_changed: bool) -> "KeptExport":
        """What is left where these data blocks have changed."""
        gone = frozenset(changed)
        return KeptExport(
            self.scene,
            {key: kept for key, kept in self.shapes.items() if not kept.sources & gone},
            {
                pointer: kept
                for pointer, kept in self.materials.items()
                if pointer not in gone and not (images_changed and kept.uses_images)
            },
            self.scene_properties,
        )
