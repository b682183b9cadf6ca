"""The panels: that each is registered, and that README's settings stand where it says."""

import re
from pathlib import Path

README = (Path(__file__).resolve().parents[2] / "README.md").read_text()

# Draws panels into nothing and keeps the labels of what they show.
DRAWING = """
import sys
import bpy
from rayleaf import ui

def every_panel(base=ui._Panel):
    for each in base.__subclasses__():
        yield each
        yield from every_panel(each)

class Layout:
    "Takes the calls that a panel makes of Blender's layout."
    def __init__(self):
        self.labels = []
    def prop(self, owner, name, text=None, **more):
        self.labels.append(owner.bl_rna.properties[name].name if text is None else text)
    def __getattr__(self, name):
        return lambda *arguments, heading="", **more: self
    def __setattr__(self, name, value):
        self.__dict__[name] = value

def drawn(panel, context):
    layout = Layout()
    fake = type("Fake", (), {"layout": layout, "_column": panel._column})()
    panel.draw(fake, context)
    return layout.labels

scene = bpy.context.scene
scene.render.engine = "RAYLEAF"
"""


def settings_table():
    """Panel -> the settings that README's table names, in order."""
    table, panel = {}, ""
    for line in README.partition("## Settings")[2].partition("\n## ")[0].splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if line.startswith("|") and len(cells) == 3 and cells[1] not in ("setting", "---"):
            panel = cells[0] or panel
            table.setdefault(panel, []).extend(re.split(r", ", cells[1].partition(": ")[2] or cells[1]))
    return table


def named_places():
    """(tab of the Properties editor, what follows) as README writes them: "Object Properties > Ray Interpolation overrides"."""
    return re.findall(
        r"(Render|Object|Material|View Layer) Properties > (.{40})", " ".join(README.replace("*", "").split())
    )


def test_every_panel_and_operator_of_the_add_on_is_registered(run_blender):
    run = run_blender(
        DRAWING
        + """
import rayleaf.report.panel
classes = [each for module in list(sys.modules.values()) if getattr(module, "__name__", "").startswith("rayleaf")
           for each in vars(module).values() if isinstance(each, type) and issubclass(each, (bpy.types.Panel, bpy.types.Operator))]
report(classes=sorted({each.__name__ for each in classes if each.__module__.startswith("rayleaf")}),
       missing=sorted({each.__name__ for each in classes if not each.is_registered and each.__module__.startswith("rayleaf")}))
"""
    ).report
    assert "RAYLEAF_PT_tessellation" in run["classes"] and "RAYLEAF_OT_select_subject" in run["classes"]
    assert run["missing"] == []


def test_every_setting_that_readme_names_is_in_the_panel_where_it_says(run_blender):
    table = settings_table()
    assert len(table) == 9 and sum(map(len, table.values())) > 40, table
    run = run_blender(
        DRAWING
        + """
bpy.context.preferences.view.show_developer_ui = True
scene.rayleaf.integrator, scene.rayleaf.ray_interpolation.use_advanced = "DISTRIBUTION", True
registered = [panel for panel in every_panel() if panel.is_registered and panel.bl_context == "render"]
context = bpy.context
report(labels={panel.bl_label: drawn(panel, context) for panel in registered if not hasattr(panel, "bl_parent_id")
               and panel.poll(context)})
"""
    ).report["labels"]
    # What README says in other words than the panel.
    said = {
        "Clamp Direct": "Clamp Direct",
        "Off": "Ray Interpolation",
        "Auto": "Ray Interpolation",
        "On": "Ray Interpolation",
    }
    for panel, settings in table.items():
        labels = {label.removesuffix(" (MB)") for label in run[panel]}
        missing = {name for name in settings if said.get(name, name) not in labels}
        assert missing == set(), (panel, missing, labels)


def test_every_place_that_readme_names_is_a_panel(run_blender):
    places = named_places()
    assert len(places) >= 4, places
    run = run_blender(
        DRAWING
        + """
import rayleaf.report.panel
def labels(base):
    for each in base.__subclasses__():
        if "RAYLEAF" in getattr(each, "COMPAT_ENGINES", ()) and each.is_registered and hasattr(each, "bl_context"):
            yield [each.bl_context.replace("_", " ").title(), each.bl_label]
        yield from labels(each)
report(panels=list(labels(bpy.types.Panel)))
"""
    ).report["panels"]
    engine = ["Render", "Render Engine"]  # Blender's own choice of an engine has no panel
    missing = [
        place
        for place in places
        if not any(place[0] == tab and place[1].startswith(label) for tab, label in [*run, engine])
    ]
    assert missing == []


def test_every_setting_says_what_it_does(run_blender):
    run = run_blender(
        DRAWING
        + """
import inspect
import rayleaf.report.panel
from rayleaf import ray_interpolation, properties, sampling_presets
groups = [*ray_interpolation.CLASSES, properties.RayleafSceneSettings, rayleaf.report.panel.RayleafMeasurement]
groups += [operator for operator in rayleaf.report.panel.CLASSES if hasattr(operator, "bl_idname")]
groups += sampling_presets.CLASSES
inner = {"rna_type", "name", "settings", "state"}
properties = []
for group in groups:
    names = {name for base in group.__mro__ for name in inspect.get_annotations(base)} - inner
    known = group.bl_rna.properties if "bl_idname" not in vars(group) else bpy.types.Operator.bl_rna_get_subclass_py(
        group.__name__).bl_rna.properties
    properties += [(group, known[name]) for name in names if name in known and known[name].type != "POINTER"]
items = [item for _, prop in properties if prop.type == "ENUM" for item in prop.enum_items]
report(count=len(properties), mute=[f"{group.__name__}.{prop.identifier}" for group, prop in properties
                                    if len(prop.description) < 12] + [item.name for item in items if not item.description])
"""
    ).report
    assert run["count"] > 60
    assert run["mute"] == []


def test_comparisons_show_with_developer_extras_alone(run_blender):
    run = run_blender(
        DRAWING
        + """
panels = [panel for panel in every_panel() if panel.__name__.startswith("RAYLEAF_PT_debug")]
shown = {}
for extras in (False, True):
    bpy.context.preferences.view.show_developer_ui = extras
    shown[extras] = [panel.poll(bpy.context) for panel in panels]
passes = drawn(bpy.types.RAYLEAF_PT_passes, bpy.context)
debug = [label for panel in panels for label in drawn(panel, bpy.context)]
report(hidden=shown[False], shown=shown[True], passes=passes, debug=debug)
"""
    ).report
    assert run["hidden"] == [False, False] and run["shown"] == [True, True]
    assert {"Tree", "Level", "Cache Misses"} <= set(run["debug"]) and not {"Tree", "Level"} & set(run["passes"])
    assert {"Curve Primitive", "Tessellation Cache", "Widen Mirrored Rays", "Coarser Where Dim"} <= set(run["debug"])


def test_presets_and_the_settings_of_cycles_are_taken_over(run_blender):
    run = run_blender(
        DRAWING
        + """
import addon_utils
addon_utils.enable("cycles")
own, theirs = scene.rayleaf, scene.cycles
values = lambda: [own.samples, own.max_bounces, own.transparent_bounces, own.clamp_indirect, own.seed]
first = values()
found = {}
for name in ("FINAL", "PREVIEW", "DEFAULT"):
    bpy.ops.rayleaf.preset(preset=name)
    found[name] = values()
from rayleaf.sampling_presets import FROM_CYCLES
different = {}
for name, ours in FROM_CYCLES.items():
    prop = theirs.bl_rna.properties[name]
    if prop.type == "ENUM":
        others = [item.identifier for item in prop.enum_items if item.identifier != getattr(own, ours)]
        setattr(theirs, name, others[0])
    elif prop.type == "BOOLEAN":
        setattr(own, ours, getattr(theirs, name))
        setattr(theirs, name, not getattr(theirs, name))
    else:
        setattr(theirs, name, type(getattr(theirs, name))(7))
    different[ours] = getattr(own, ours) != getattr(theirs, name)
scene.cycles_curves.shape = "THICK" if own.strand_shape == "RIBBON" else "RIBBONS"
before = own.strand_shape
bpy.ops.rayleaf.copy_cycles_settings()
equal = {ours: getattr(own, ours) == getattr(theirs, name) for name, ours in FROM_CYCLES.items()}
report(first=first, found=found, different=different, equal=equal, shapes=[before, own.strand_shape])
"""
    ).report
    assert run["found"]["DEFAULT"] == run["first"]
    assert run["found"]["FINAL"][0] > run["first"][0] > run["found"]["PREVIEW"][0]
    assert all(run["different"].values()), run["different"]
    assert all(run["equal"].values()), run["equal"]
    assert run["shapes"] == ["ROUND", "RIBBON"]
