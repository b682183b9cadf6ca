"""Runs inside Blender: instances in the colour that an Attribute node of type Instancer or View Layer reads, in both engines."""

import sys
from pathlib import Path

import both_engines
import bpy
import scenes

PIXELS = 100
TINT = "tint"


class Nodes:
    """A tree of geometry nodes on a grid."""

    def __init__(self, grid):
        self.tree = scenes.group("made", "NodeSocketGeometry", "NodeSocketGeometry", "GeometryNodeTree")
        self.input, self.output = self.add("NodeGroupInput").outputs[0], self.add("NodeGroupOutput").inputs[0]
        grid.modifiers.new("made", "NODES").node_group = self.tree

    def add(self, kind):
        return self.tree.nodes.new(kind)

    def link(self, source, target):
        self.tree.links.new(source, target)

    def finish(self, geometry):
        self.link(geometry, self.output)

    def object(self, shown):
        """An object, or a collection, as an instance."""
        kind, name = (
            ("CollectionInfo", "Collection") if isinstance(shown, bpy.types.Collection) else ("ObjectInfo", "Object")
        )
        node = self.add(f"GeometryNode{kind}")
        node.inputs[name].default_value = shown
        if name == "Object":
            node.inputs["As Instance"].default_value = True
        return node.outputs[0 if name == "Collection" else "Geometry"]

    def on_points(self, points, instance, size=1.0):
        node = self.add("GeometryNodeInstanceOnPoints")
        self.link(points, node.inputs["Points"])
        self.link(instance, node.inputs["Instance"])
        node.inputs["Scale"].default_value = (size, size, size)
        return node.outputs[0]

    def stored(self, geometry, value, kind):
        """With the attribute of instances."""
        node = self.add("GeometryNodeStoreNamedAttribute")
        node.data_type, node.domain = kind, "INSTANCE"
        node.inputs["Name"].default_value = TINT
        self.link(geometry, node.inputs[0])
        self.link(value, next(each for each in node.inputs if each.name == "Value" and each.enabled))
        return node.outputs[0]

    def index(self, operation="MULTIPLY", by=0.04):
        node = self.add("ShaderNodeMath")
        node.operation, node.inputs[1].default_value = operation, by
        self.link(self.add("GeometryNodeInputIndex").outputs[0], node.inputs[0])
        return node.outputs[0]

    def numbered(self, geometry, number):
        node = self.add("GeometryNodeSetID")
        self.link(geometry, node.inputs["Geometry"])
        self.link(number, node.inputs["ID"])
        return node.outputs[0]

    def places(self):
        return self.add("GeometryNodeInputPosition").outputs[0]


def instances(grid, cube):
    nodes = Nodes(grid)
    nodes.finish(nodes.stored(nodes.on_points(nodes.input, nodes.object(cube)), nodes.places(), "FLOAT_VECTOR"))


def numbered(grid, cube):
    """Numbers of their own, each twice."""
    nodes = Nodes(grid)
    placed = nodes.on_points(nodes.numbered(nodes.input, nodes.index("PINGPONG", 8.0)), nodes.object(cube))
    nodes.finish(nodes.stored(placed, nodes.index(), "FLOAT"))


def collection(grid, cube):
    nodes, both = Nodes(grid), bpy.data.collections.new("both")
    other = bpy.data.objects.new("other", cube.data)
    cube.location, other.location = (0, 0, 0), (0.1, 0.1, 0.5)
    both.objects.link(cube)
    bpy.context.scene.collection.objects.unlink(cube)
    both.objects.link(other)
    nodes.finish(nodes.stored(nodes.on_points(nodes.input, nodes.object(both)), nodes.index(), "FLOAT"))


def beside_a_mesh(grid, cube):
    """Instances and a mesh, both in each instance of a level further out."""
    nodes = Nodes(grid)
    mesh, joined, painted = (nodes.add(f"GeometryNode{kind}") for kind in ("MeshCube", "JoinGeometry", "SetMaterial"))
    mesh.inputs["Size"].default_value = (0.15, 0.15, 0.3)
    painted.inputs["Material"].default_value = cube.data.materials[0]
    nodes.link(mesh.outputs[0], painted.inputs["Geometry"])
    line = nodes.add("GeometryNodeMeshLine")
    line.inputs["Count"].default_value, line.inputs["Offset"].default_value = 2, (0.12, 0, 0.2)
    inner = nodes.stored(nodes.on_points(line.outputs[0], nodes.object(cube), 0.5), nodes.index(by=0.5), "FLOAT")
    nodes.link(inner, joined.inputs[0])
    nodes.link(painted.outputs[0], joined.inputs[0])
    placed = nodes.on_points(nodes.input, joined.outputs[0])
    nodes.finish(nodes.stored(placed, nodes.places(), "FLOAT_VECTOR"))


def within_a_collection(grid, cube):
    """What a member of a collection makes, where an empty shows the collection."""
    instances(grid, cube)
    made = bpy.data.collections.new("made")
    made.objects.link(grid)
    bpy.context.scene.collection.objects.unlink(grid)
    empty = scenes.add(None, "empty")
    empty.instance_type, empty.instance_collection = "COLLECTION", made
    empty.location.x = 0.3


def particles(grid, cube):
    bpy.context.view_layer.objects.active = grid
    bpy.ops.object.particle_system_add()
    settings = grid.particle_systems[0].settings
    settings.type, settings.count, settings.emit_from, settings.hair_length = "HAIR", 40, "FACE", 1.0
    settings.render_type, settings.instance_object, settings.particle_size = "OBJECT", cube, 1.0
    settings[TINT], grid[TINT], cube[TINT] = (0.2, 0.4, 0.6), 1.0, 1.0


def on_vertices(grid, cube):
    cube.parent, cube.location, grid.instance_type = grid, (0, 0, 0), "VERTS"


def maker(grid, cube):
    on_vertices(grid, cube)
    grid[TINT], cube[TINT] = (0.3, 0.9, 0.1, 0.5), 1.0


def own(grid, cube):
    """The grid's data have one too, and do not count."""
    on_vertices(grid, cube)
    grid.data[TINT], cube.data[TINT] = 1.0, 0.7


def layer(grid, cube):
    maker(grid, cube)
    bpy.context.view_layer[TINT], bpy.context.scene[TINT] = (0.8, 0.1, 0.1), 1.0


def scene_of_layer(grid, cube):
    maker(grid, cube)
    bpy.context.scene[TINT], bpy.context.scene.world[TINT] = 0.4, 1.0


def world(grid, cube):
    maker(grid, cube)
    bpy.context.scene.world[TINT] = 3


OF_GEOMETRY_NODES = (instances, numbered, collection, beside_a_mesh, within_a_collection)
OF_PROPERTIES = (particles, maker, own)
OF_LAYERS = (layer, scene_of_layer, world)


def attribute_material(kind):
    """Shines in the colour of the attribute, moved up: there is no negative light."""
    material, tree, _ = scenes.material("tinted")
    tree.nodes.clear()
    output, emission, shifted, attribute = (
        tree.nodes.new(f"ShaderNode{kind}") for kind in ("OutputMaterial", "Emission", "VectorMath", "Attribute")
    )
    attribute.attribute_type, attribute.attribute_name = kind, TINT
    shifted.inputs[1].default_value = (1.0, 1.0, 1.0)
    tree.links.new(attribute.outputs["Color"], shifted.inputs[0])
    tree.links.new(shifted.outputs[0], emission.inputs["Color"])
    tree.links.new(attribute.outputs["Alpha"], emission.inputs["Strength"])
    tree.links.new(emission.outputs[0], output.inputs["Surface"])
    return material


if __name__ == "__main__":
    report = globals()["report"]  # given by the test
    pictures = {}
    cases = [(case, "INSTANCER") for case in (*OF_GEOMETRY_NODES, *OF_PROPERTIES)]
    cases += [(case, "VIEW_LAYER") for case in OF_LAYERS]
    for case, kind in cases:
        scenes.empty_file()
        scene = bpy.context.scene
        scenes.plain_world((0, 0, 0))
        bpy.ops.mesh.primitive_cube_add(size=0.2, location=(9, 0, 0))
        cube = bpy.context.object
        cube.data.materials.append(attribute_material(kind))
        bpy.ops.mesh.primitive_grid_add(x_subdivisions=4, y_subdivisions=3, size=2)
        grid = bpy.context.object
        grid.show_instancer_for_render = grid.show_instancer_for_viewport = False
        case(grid, cube)
        both_engines.look_straight_down(scene, 3, PIXELS)
        pictures[case.__name__] = [
            both_engines.picture(scene, engine, Path(sys.argv[1]) / "picture.exr").tolist()
            for engine in ("CYCLES", "RAYLEAF")
        ]
    report(
        pictures=pictures, of_geometry_nodes=[case.__name__ for case in OF_GEOMETRY_NODES], version=bpy.app.version[:2]
    )
