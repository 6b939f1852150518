"""The hung sheet of `weft study peers` in Blender's cloth, without contact; Blender's own Python runs it:

blender --background --factory-startup --threads 1 --python-exit-code 1 --python blender_sheet.py -- SIDE STEPS FRAMES FILE

SIDE particles a side of a square metre, STEPS per frame of 1/60 s (Blender's quality steps). Writes x y z of all
particles by turns as 32-bit floats (frame by frame, y up, the row of pins first) to FILE, and prints one line of JSON:
{"engine": "Blender 3.4.1", "cpu_ms_per_frame": 10.4}.

Blender's cloth counts time in frames, whatever they last: of gravity it takes a thousandth, as metres per frame², and a
spring's stiffness is the tension divided by the mean length of all edges, as newtons times (s per frame)² per metre.
Every edge is a spring of the same tension; shear springs are only those across faces of four corners, which resist no
compression. So the sheet is of triangles, whose diagonals are as stiff as their sides. Compression is resisted as much
as tension only with the angular model of bending, whose own stiffness is 0 here. Every particle weighs the same.
"""

import array
import pathlib
import sys

import bpy

sys.path.insert(0, str(pathlib.Path(__file__).parent))
from measure import measure  # noqa: E402

WEIGHT = 0.2  # kg
STIFFNESS = 2000.0  # N/m
GRAVITY = 9.81  # m/s²
FRAME = 1 / 60  # s


def make_mesh(side):
    """In x and y, y down from the row of pins; cut along parallel diagonals."""
    spacing = 1 / (side - 1)
    vertices = [(column * spacing, -row * spacing, 0.0) for row in range(side) for column in range(side)]
    triangles = []
    for row in range(side - 1):
        for column in range(side - 1):
            a = row * side + column
            b, c, d = a + 1, a + side, a + side + 1
            triangles += [(a, c, d), (a, d, b)]
    mesh = bpy.data.meshes.new("sheet")
    mesh.from_pydata(vertices, [], triangles)
    return mesh


def mean_length(mesh):
    at = [vertex.co for vertex in mesh.vertices]
    return sum((at[edge.vertices[0]] - at[edge.vertices[1]]).length for edge in mesh.edges) / len(mesh.edges)


def add_sheet(side, steps, frames):
    mesh = make_mesh(side)
    sheet = bpy.data.objects.new("sheet", mesh)
    bpy.context.scene.collection.objects.link(sheet)
    pins = sheet.vertex_groups.new(name="pins")
    pins.add([0, side - 1], 1.0, "REPLACE")
    cloth = sheet.modifiers.new("cloth", "CLOTH")
    cloth.point_cache.frame_start, cloth.point_cache.frame_end = 1, frames + 1
    cloth.collision_settings.use_collision = False
    cloth.collision_settings.use_self_collision = False
    settings = cloth.settings
    settings.quality = steps
    settings.mass = WEIGHT / len(mesh.vertices)
    settings.vertex_group_mass = pins.name
    settings.bending_model = "ANGULAR"
    settings.bending_stiffness = 0.0
    settings.tension_stiffness = settings.compression_stiffness = STIFFNESS * FRAME**2 * mean_length(mesh)
    settings.tension_damping = settings.compression_damping = settings.bending_damping = 0.0
    settings.shear_stiffness = settings.shear_damping = settings.air_damping = 0.0
    return sheet


class Sheet:
    def __init__(self, side, steps, frames):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        self.scene = bpy.context.scene
        self.scene.gravity = (0.0, 0.0, -1000 * GRAVITY * FRAME**2)
        self.scene.frame_start, self.scene.frame_end = 1, frames + 1
        self.sheet = add_sheet(side, steps, frames)
        self.scene.frame_set(1)

    def advance_frame(self):
        self.scene.frame_set(self.scene.frame_current + 1)

    def positions(self):
        """z up becomes y up."""
        vertices = self.sheet.evaluated_get(bpy.context.evaluated_depsgraph_get()).data.vertices
        at = array.array("f", bytes(12 * len(vertices)))
        vertices.foreach_get("co", at)
        at[1::3], at[2::3] = at[2::3], array.array("f", (-y for y in at[1::3]))
        return at


def main():
    side, steps, frames, file = sys.argv[sys.argv.index("--") + 1 :]
    side, steps, frames = int(side), int(steps), int(frames)
    version = ".".join(str(part) for part in bpy.app.version)
    measure("Blender " + version, lambda: Sheet(side, steps, frames), frames, file)


main()
