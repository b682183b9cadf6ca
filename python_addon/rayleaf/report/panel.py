"""The artist's button: sweeps the settings over the open scene in a second Blender, and says which setting gives the wished
error in the least time."""

import json
import subprocess
import tempfile
from pathlib import Path
from typing import Any

import bpy
from bpy.props import BoolProperty, CollectionProperty, FloatProperty, IntProperty, StringProperty

from ..registration import registration_factory
from . import points
from .points import Point

_POLL_SECONDS = 0.25
_SAMPLES = (1, 4, 16, 64)
_ERRORS = (0.02, 0.005, 0.00125)
# So many samples more than the most that is tried: the reference's noise is then a quarter of the smallest.
_REFERENCE_FACTOR = 16
_ADDON = __package__.rpartition(".")[0]


def tried_points() -> list[Point]:
    """What is swept: paths per pixel, each with and without ray interpolation."""
    tried = points.samples(list(_SAMPLES))
    for count in _SAMPLES[1:]:
        for point in points.interpolation(list(_ERRORS), count)[1:]:
            tried.append(Point(f"{points.counted(count)}, interpolation", point.label, assign=point.assign))
    return tried


class RayleafMeasuredSetting(bpy.types.PropertyGroup):
    """One line of the table."""

    seconds: FloatProperty()  # type: ignore
    error: FloatProperty()  # type: ignore
    is_beaten: BoolProperty()  # type: ignore
    assign: StringProperty()  # type: ignore  # JSON: property path -> value


class RayleafMeasurement(bpy.types.PropertyGroup):
    """What was measured last; of the window manager, so no file keeps it."""

    settings: CollectionProperty(type=RayleafMeasuredSetting)  # type: ignore
    state: StringProperty()  # type: ignore
    wanted_error: FloatProperty(  # type: ignore
        name="Target Noise",
        description="Noise and error that the picture may have: root mean square, in display colours from 0 to 1",
        default=0.02,
        min=0.0001,
        max=1.0,
        precision=4,
    )

    def chosen(self) -> Any:
        """The fastest setting within the wished error, or None."""
        within = [each for each in self.settings if each.error <= self.wanted_error]
        return min(within, key=lambda each: each.seconds) if within else None


class _Run:
    """A second Blender at work on a copy of the open file."""

    def __init__(self, width: int) -> None:
        from .measure import Conditions, blender_command, write_job  # NumPy is loaded here, not with the add-on

        self.tried, self.references = tried_points(), [points.reference("RAYLEAF", _SAMPLES[-1] * _REFERENCE_FACTOR)]
        self._folder = tempfile.TemporaryDirectory(prefix="rayleaf_measure_")
        folder = Path(self._folder.name)
        file = folder / "scene.blend"
        bpy.ops.wm.save_as_mainfile(filepath=str(file), copy=True, relative_remap=True)
        job, self._result = write_job(folder, self.tried + self.references, Conditions(width), _ADDON)
        command = blender_command(bpy.app.binary_path, file, job, self._result, _ADDON)
        self._log = (folder / "log").open("w+", encoding="utf-8")
        self._process = subprocess.Popen(command, stdout=self._log, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL)

    def share(self) -> float:
        """Of the pictures, how many are done."""
        try:
            done = len(json.loads(self._result.read_text(encoding="utf-8")))
        except (OSError, ValueError):  # not yet there, or just being written
            return 0.0
        return done / (len(self.tried) + len(self.references))

    def is_running(self) -> bool:
        return self._process.poll() is None

    def wait(self) -> None:
        self._process.wait()

    def results(self) -> list[Any]:
        """Raises RuntimeError with Blender's last line if it failed."""
        if self._process.returncode != 0 or not self._result.exists():
            self._log.seek(0)
            raise RuntimeError((self._log.read().strip().splitlines() or ["no message"])[-1])
        return list(json.loads(self._result.read_text(encoding="utf-8")))

    def close(self) -> None:
        """Stop it if it runs, and remove its files."""
        if self.is_running():
            self._process.kill()
            self._process.wait()
        self._log.close()
        self._folder.cleanup()


def show(measurement: RayleafMeasurement, run: _Run) -> None:
    """Fill the table with a run's results, fastest first."""
    from .measure import judge

    found = judge(run.results(), run.tried, run.references)
    measurement.settings.clear()
    for each in sorted(found.measured, key=lambda measured: measured.time):
        line = measurement.settings.add()
        line.name, line.seconds, line.error = each.point.name, each.time, each.error.rmse
        line.is_beaten, line.assign = bool(each.beaten_by), json.dumps(each.point.assign)
    measurement.state = f"{len(measurement.settings)} settings measured"


class RAYLEAF_OT_measure_settings(bpy.types.Operator):
    """Render the scene small with many settings, and list error and time of each. Esc stops it"""

    bl_idname = "rayleaf.measure_settings"
    bl_label = "Measure"

    width: IntProperty(name="Width", description="Of the pictures, in pixels", default=160, min=16, max=4096)  # type: ignore

    _run: _Run
    _timer: Any = None
    _is_running = False  # of the class: one at a time

    @classmethod
    def poll(cls, _context: Any) -> bool:
        cls.poll_message_set("One measurement is under way")
        return not RAYLEAF_OT_measure_settings._is_running

    def invoke(self, context: Any, _event: Any) -> set[str]:
        self._run = _Run(self.width)
        RAYLEAF_OT_measure_settings._is_running = True
        self._timer = context.window_manager.event_timer_add(_POLL_SECONDS, window=context.window)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def execute(self, context: Any) -> set[str]:
        """Without a window: wait for the end."""
        self._run = _Run(self.width)
        self._run.wait()
        return self._finish(context)

    def modal(self, context: Any, event: Any) -> set[str]:
        measurement = context.window_manager.rayleaf_measurement
        if event.type == "ESC":
            self.cancel(context)
            return {"CANCELLED"}
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        if self._run.is_running():
            measurement.state = f"Measuring: {self._run.share():.0%} (Esc stops)"
            _redraw(context)
            return {"RUNNING_MODAL"}
        return self._finish(context)

    def cancel(self, context: Any) -> None:
        """Blender opens another file, or ends."""
        context.window_manager.rayleaf_measurement.state = "Stopped"
        self._close(context)

    def _finish(self, context: Any) -> set[str]:
        try:
            show(context.window_manager.rayleaf_measurement, self._run)
        except RuntimeError as error:
            context.window_manager.rayleaf_measurement.state = "Failed"
            self.report({"ERROR"}, f"Measuring failed: {error}")
            return {"CANCELLED"}
        finally:
            self._close(context)
        return {"FINISHED"}

    def _close(self, context: Any) -> None:
        RAYLEAF_OT_measure_settings._is_running = False
        self._run.close()
        if self._timer is not None:
            context.window_manager.event_timer_remove(self._timer)
        _redraw(context)


def _redraw(context: Any) -> None:
    for window in context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "PROPERTIES":
                area.tag_redraw()


class RAYLEAF_OT_apply_measured(bpy.types.Operator):
    """Set the scene to the fastest setting within the wished error"""

    bl_idname = "rayleaf.apply_measured"
    bl_label = "Apply"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: Any) -> bool:
        return context.window_manager.rayleaf_measurement.chosen() is not None

    def execute(self, context: Any) -> set[str]:
        for path, value in json.loads(context.window_manager.rayleaf_measurement.chosen().assign).items():
            owners, _, name = path.rpartition(".")
            setattr(context.scene.path_resolve(owners), name, value)
        return {"FINISHED"}


class RAYLEAF_PT_measurement(bpy.types.Panel):
    """Error against run time of the open scene."""

    bl_label = "Find Best Settings"
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "render"
    bl_options = {"DEFAULT_CLOSED"}
    COMPAT_ENGINES = {"RAYLEAF"}

    @classmethod
    def poll(cls, context: Any) -> bool:
        return context.engine in cls.COMPAT_ENGINES

    def draw(self, context: Any) -> None:
        layout, measurement = self.layout, context.window_manager.rayleaf_measurement
        layout.operator("rayleaf.measure_settings")
        if measurement.state:
            layout.label(text=measurement.state)
        if not measurement.settings:
            return
        chosen = measurement.chosen()
        layout.prop(measurement, "wanted_error")
        layout.label(text=f"Best: {chosen.name}" if chosen else "No measured setting is that close")
        layout.operator("rayleaf.apply_measured")
        column = layout.column(align=True)
        for each in measurement.settings:
            row = column.row()
            row.active = not each.is_beaten
            row.label(text=each.name, icon="CHECKMARK" if chosen == each else "BLANK1")
            row.label(text=f"{each.seconds:.2f} s")
            row.label(text=f"{each.error:.4f}")


CLASSES = (
    RayleafMeasuredSetting,
    RayleafMeasurement,
    RAYLEAF_OT_measure_settings,
    RAYLEAF_OT_apply_measured,
    RAYLEAF_PT_measurement,
)


register, unregister = registration_factory(
    CLASSES, {bpy.types.WindowManager: RayleafMeasurement}, attribute="rayleaf_measurement"
)
