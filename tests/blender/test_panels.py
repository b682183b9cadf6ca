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
    assert len(table) == 8 and sum(map(len, table.values())) > 40, table
    run = run_blender(
        DRAWING
        + """
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
