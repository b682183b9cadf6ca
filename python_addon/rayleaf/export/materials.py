"""Materials to shader programs, each once."""

from collections.abc import Callable
from dataclasses import dataclass
from types import ModuleType
from typing import Any

from .. import cycles_versions, versions
from ..messages import Messages, Subject
from ..names import name_of
from . import unsupported
from .kept import CompiledMaterial, KeptExport
from .nodes.compiler import Compiler
from .nodes.resources import Resources
from .nodes.displacement import bend_normal, compile_displacement
from .nodes.emitter import Emitter
from .nodes.principled import write_default_surface
from .nodes.trees import shader_tree
from .nodes.volumes import write_default_volume
from .ray_interpolation import volume_of

_NEUTRAL = -1  # the core's grey: for slots without a material before Blender 5.0, and for materials that are rejected


@dataclass(frozen=True)
class VolumeMaterial:
    """What fills a volume."""

    material_list: int
    reads: frozenset[str]  # names of grids


class MaterialLibrary:
    """The materials of a scene and their lists by slot."""

    def __init__(
        self,
        core: ModuleType,
        scene: Any,
        resources: Resources,
        messages: Messages,
        depsgraph: Any,
        check_cancel: Callable[[], None],
        former: KeptExport,
    ) -> None:
        """`depsgraph`: materials are taken as evaluated in it, so that animated values count. `former`: what an earlier
        export compiled."""
        self._core, self._scene, self._resources, self._messages = core, scene, resources, messages
        self._depsgraph, self._check_cancel = depsgraph, check_cancel
        self._materials: dict[int, int] = {}  # by the pointer of the original
        self._lists: dict[tuple[int, ...], int] = {}
        self._holdout: int | None = None
        self._default = _NEUTRAL  # of slots without a material
        self._volumes: dict[int, VolumeMaterial | None] = {}  # by the pointer of the original; 0: of no material
        self._displacing: set[int] = set()
        self._former = former
        self.compiled: dict[int, CompiledMaterial] = {}  # by pointer, as `former`

    def displaces(self, material: Any) -> bool:
        """Whether a material moves the points of surfaces."""
        return self.material(material) in self._displacing

    def material(self, material: Any) -> int:
        """The index of a material; Blender's default for None, the neutral one for what the core rejects."""
        if material is None:
            return self._default_material()
        key = material.original.as_pointer()
        if key not in self._materials:
            self._check_cancel()
            self._materials[key] = self._add(material.evaluated_get(self._depsgraph))
        return self._materials[key]

    def _default_material(self) -> int:
        if self._default == _NEUTRAL and cycles_versions.default_surface_is_principled():
            emitter = Emitter(self._core, "default")
            write_default_surface(emitter)
            self._default = int(self._scene.add_material("default", emitter.program))
        return self._default

    def index_of(self, pointer: int) -> int | None:
        """The index of the material of that original; None where no object shows it."""
        return self._materials.get(pointer)

    def _add(self, material: Any) -> int:
        subject = Subject("Material", name_of(material))
        pointer = material.original.as_pointer()
        try:
            compiled = self._former.materials.get(pointer) or self.compile(material)
            index = int(self._scene.add_material(*compiled.arguments))
        except self._core.InputError as error:
            self._messages.warn(f"{subject}: {error}; rendered grey", subject)
            return _NEUTRAL
        except RecursionError:
            self._messages.warn(f"{subject}: its chain of nodes is too long; rendered grey", subject)
            return _NEUTRAL
        self._resources.wanted_attributes |= compiled.wanted
        self.compiled[pointer] = compiled
        if compiled.displaces:
            self._displacing.add(index)
        return index

    def compile(self, material: Any) -> CompiledMaterial:
        """An evaluated material's program. Raises InputError, RecursionError."""
        subject = Subject("Material", name_of(material))
        emitter = Emitter(
            self._core, subject.name, cycles_versions.bump_shadow(material), cycles_versions.clearing(material)
        )
        has_surface = True
        displacement = medium = None
        moves = versions.displacement_method(material) != "BUMP"
        with self._resources.noted() as asked, shader_tree(material) as tree:
            if tree is not None:
                compiler = self._compiler(emitter, subject)
                if not moves:
                    emitter.program.bump_width = cycles_versions.bump_width_of_displacement()
                    bend_normal(compiler, tree)
                has_surface = compiler.compile_tree(tree)
                displacement = self._displacement(tree, subject) if moves else None
                medium = self._medium(tree, subject)
            else:
                emitter.operation("diffuse", [emitter.scalar(1.0), emitter.constant(*material.diffuse_color[:3])])
            volume = volume_of(self._core, material.rayleaf)
        # A material of nothing but a volume has no surface that could be seen.
        surface = emitter.program if has_surface or medium is None else None
        shadow = versions.transparent_shadow(material)
        arguments = (subject.name, surface, material.pass_index, volume, displacement, medium, shadow)
        return CompiledMaterial(arguments, frozenset(asked.attributes), asked.images)

    def volume(self, materials: list[Any]) -> VolumeMaterial | None:
        """What fills an object that grids are of: the volume of the first material that has one; without any material,
        Cycles' own. None where there is none."""
        for material in materials or [None]:
            key = 0 if material is None else material.original.as_pointer()
            if key not in self._volumes:
                self._check_cancel()
                self._volumes[key] = self._add_volume(material)
            found = self._volumes[key]
            if found is not None:
                return found
        return None

    def fills_volumes(self, pointer: int) -> bool:
        """Whether the material of that original is that of an object that grids are of."""
        return pointer in self._volumes

    def _add_volume(self, material: Any) -> VolumeMaterial | None:
        name = "volume" if material is None else name_of(material)
        subject, emitter = Subject("Material", name), Emitter(self._core, name)
        try:
            with self._resources.noted() as asked:
                if material is None:
                    write_default_volume(emitter, self._resources)
                elif not self._compile_volume(emitter, subject, material.evaluated_get(self._depsgraph)):
                    return None
                else:
                    unsupported.name_volume_settings(material, self._messages)
            pass_index = 0 if material is None else material.pass_index
            index = int(self._scene.add_material(name, None, pass_index, medium=emitter.program))
        except (self._core.InputError, RecursionError) as error:
            reason = "its chain of nodes is too long" if isinstance(error, RecursionError) else str(error)
            self._messages.warn(f"{subject}: {reason}; its volume is left out", subject)
            return None
        reads = frozenset(name for name in asked.attributes if not name.startswith("\n"))
        return VolumeMaterial(int(self._scene.add_material_list([index])), reads)

    def _compile_volume(self, emitter: Emitter, subject: Subject, material: Any) -> bool:
        compiler = self._compiler(emitter, subject)
        compiler.reads_grids = True
        with shader_tree(material) as tree:
            return tree is not None and compiler.compile_volume(tree)

    def _compiler(self, emitter: Emitter, subject: Subject, displaces: bool = False) -> Compiler:
        return Compiler(emitter, subject, self._resources, self._messages, displaces=displaces)

    def _medium(self, tree: Any, subject: Subject) -> Any | None:
        """The program of what fills the space behind the surface; None where nothing does."""
        emitter = Emitter(self._core, subject.name)
        return emitter.program if self._compiler(emitter, subject).compile_volume(tree) else None

    def _displacement(self, tree: Any, subject: Subject) -> tuple[Any, int, int] | None:
        """A program that displaces, and the registers of its vectors in object and in world space."""
        emitter = Emitter(self._core, subject.name)
        compiler = self._compiler(emitter, subject, displaces=True)
        try:
            registers = compile_displacement(compiler, tree)
        except self._core.InputError as error:
            self._messages.warn(f"{subject}: {error}; its displacement is left out", subject)
            return None
        return None if registers is None else (emitter.program, *registers)

    def holdout(self) -> int:
        """A material that cuts a hole into the picture."""
        if self._holdout is None:
            emitter = Emitter(self._core, "Holdout")
            emitter.operation("holdout", [emitter.scalar(1.0)])
            self._holdout = int(self._scene.add_material("Holdout", emitter.program))
        return self._holdout

    def slot_list(self, materials: list[Any], holdout: bool) -> int:
        """The index of the list of an object's materials by slot; -1 where all are neutral."""
        if holdout:
            indices = tuple(self.holdout() for _ in materials or [None])
        else:
            indices = tuple(self.material(material) for material in materials or [None])
        if all(index == _NEUTRAL for index in indices):
            return -1
        if indices not in self._lists:
            self._lists[indices] = int(self._scene.add_material_list(list(indices)))
        return self._lists[indices]


def slots_of(owner: Any, data: Any, from_owner: bool) -> list[Any]:
    """The materials by slot: the object's slots, linked to it or to its data; of foreign data its own materials."""
    if from_owner and owner.type != "EMPTY":
        return [slot.material for slot in owner.material_slots]
    return list(data.materials)
