"""Small scenes of furniture that tests of several folders share."""

import json
from functools import reduce
from pathlib import Path

HEAD = 'format = "restshape-scene"\nversion = 1\napp = "furniture"\ntitle = "bench"\n'

BENCH = """
[wood]
name = "pine"
thickness = 0.02

[fastener]
name = "screw"

[planks.top]
from = [-0.6, 0, 0.51]
to = [0.6, 0, 0.51]
width = [0, 0.3, 0]

[planks.left]
from = [-0.5, 0, 0]
to = [-0.5, 0, 0.5]
width = [0, 0.3, 0]

[planks.right]
from = [0.5, 0, 0]
to = [0.5, 0, 0.5]
width = [0, 0.3, 0]

[weights.box]
on = "top"
mass = "20 kg"

[effects.gravity]
g = [0, 0, -10]
"""

FLOOR_BOARD = """
[wood]
name = "pine"
thickness = "18 mm"

[fastener]
name = "screw"
spacing = "60 mm"

[planks.base]
center = [0, 0, "9 mm"]
size = [0.4, 0.3]

[planks.post]
from = [0, 0, 0.018]
to = [0, 0, 0.45]
width = [0, 0.26, 0]

[planks.seat]
center = [0, 0, 0.459]
size = [0.4, 0.3]

[weights.person]
on = "seat"
mass = "30 kg"
at = [0.1, 0, 0.5]

[effects.gravity]
"""
"""A stool on a board that lies on the floor, its middle as a number; to stand behind `HEAD`."""

COFFEE_TABLE = """format = "restshape-scene"
version = 1
app = "furniture"
title = "coffee table"
[parameters]
t = "18 mm"
long = "1 m"
wide = "0.6 m"
high = "0.42 m"
[wood]
name = "oak"
thickness = "t"
[fastener]
name = "dowel"
spacing = "32 mm"
[floor]
friction = 0.4
[planks.top]
from = ["-long/2", 0, "high"]
to = ["long/2", 0, "high"]
width = [0, "wide", 0]
# two frames of two legs and a rail under the top
[planks.leg1]
from = ["-long/2 + 0.08", "-wide/2 + 0.08", 0]
to = ["-long/2 + 0.08", "-wide/2 + 0.08", "high"]
width = [0, 0.08, 0]
[planks.leg2]
from = ["-long/2 + 0.08", "wide/2 - 0.08", 0]
to = ["-long/2 + 0.08", "wide/2 - 0.08", "high"]
width = [0, 0.08, 0]
[planks.leg3]
from = ["long/2 - 0.08", "-wide/2 + 0.08", 0]
to = ["long/2 - 0.08", "-wide/2 + 0.08", "high"]
width = [0, 0.08, 0]
[planks.leg4]
from = ["long/2 - 0.08", "wide/2 - 0.08", 0]
to = ["long/2 - 0.08", "wide/2 - 0.08", "high"]
width = [0, 0.08, 0]
# a lower shelf between the leg pairs, along x
[planks.shelf]
from = ["-long/2 + 0.08", 0, 0.15]
to = ["long/2 - 0.08", 0, 0.15]
width = [0, 0.52, 0]
[weights.books]
on = "top"
mass = "25 kg"
at = [0.2, 0, 0.5]
[weights.magazines]
on = "shelf"
mass = "8 kg"
[pushes.knock]
on = "top"
force = ["80 N", 0, 0]
at = [0, 0, 0]
[pushes.side]
on = "top"
force = [0, "80 N", 0]
[pushes.sit]
on = "top"
force = [0, 0, "-600 N"]
at = [0.5, 0, 0.5]
[effects.gravity]
[effects.push]
"""
"""A table on four legs with a shelf between them, with two mirror planes, all of whose joints are too weak."""

SLANTED_BENCH = """format = "restshape-scene"
version = 1
app = "furniture"
title = "bench with a slanted leg"
[parameters]
t = "22 mm"
long = "1.2 m"
high = "0.44 m"
lean = "0.12 m"
[wood]
name = "pine"
thickness = "t"
[fastener]
name = "screw"
spacing = "30 mm"
[floor]
friction = 0.45
[planks.seat]
from = ["-long/2", 0, "high"]
to = ["long/2", 0, "high"]
width = [0, 0.32, 0]
[planks.left]
from = ["-long/2 + 0.1", 0, 0]
to = ["-long/2 + 0.1", 0, "high"]
width = [0, 0.30, 0]
[planks.right]
from = ["long/2 - 0.2 + lean", 0, 0]
to = ["long/2 - 0.2", 0, "high"]
width = [0, 0.30, 0]
[weights.two]
on = "seat"
mass = "150 kg"
at = [0, 0, 0.5]
[pushes.edge]
on = "seat"
force = [0, 0, "-800 N"]
at = [-0.5, 0, 0.5]
[pushes.shove]
on = "seat"
force = ["200 N", 0, 0]
[effects.gravity]
[effects.push]
[effects.bending]
[quantities]
sag = { deflection = true, max = "4 mm" }
"""
"""A bench with a slanted leg, whose seat may sag by 4 mm at most."""

EDGE_STOOL = """format = "restshape-scene"
version = 1
app = "furniture"
title = "stool, person on one edge"
[parameters]
m = "70 kg"
[wood]
name = "pine"
thickness = "18 mm"
[fastener]
name = "screw"
spacing = "60 mm"
[planks.seat]
from = [-0.25, 0, 0.441]
to = [0.25, 0, 0.441]
width = [0, 0.3, 0]
[planks.left]
from = [-0.2, 0, 0]
to = [-0.2, 0, 0.432]
width = [0, 0.26, 0]
[planks.right]
from = [0.2, 0, 0]
to = [0.2, 0, 0.432]
width = [0, 0.26, 0]
[planks.rail]
from = [-0.191, 0, 0.15]
to = [0.191, 0, 0.15]
width = [0, 0.1, 0]
[weights.man]
on = "seat"
mass = "m"
at = [0.4, 0, 0.5]
[effects.gravity]
"""
"""A stool with a rail between its legs and a person on the edge of its seat, which depends on joints."""

LEANING_BENCH = """format = "restshape-scene"
version = 1
app = "furniture"
title = "bench with a slanted leg"

[wood]
name = "pine"
thickness = "30 mm"

[fastener]
name = "screw"
spacing = "30 mm"

[floor]
friction = 0.45

[planks]
seat = { from = [-0.6, 0, 0.44], to = [0.6, 0, 0.44], width = [0, 0.32, 0] }
left = { from = [-0.5, 0, 0], to = [-0.5, 0, 0.425], width = [0, 0.3, 0] }
right = { from = [0.4903712, 0, 0], to = [0.4331671, 0, 0.425], width = [0, 0.3, 0] }
rail = { from = [-0.485, 0, 0.3775], to = [0.4, 0, 0.3775], width = [0, 0, 0.095] }

[weights]
two = { on = "seat", mass = "150 kg", at = [0, 0, 0.5] }

[pushes]
edge = { on = "seat", force = [0, 0, "-800 N"], at = [-0.5, 0, 0.5] }
shove = { on = "seat", force = ["200 N", 0, 0] }

[effects]
gravity = {}
push = {}
bending = {}
guidance = {}
"""
"""A bench with a leaning leg and a rail that ends before it: it holds, but the rail's joint bends along its line."""

PARTED_STOOL = """
format = "restshape-scene"
version = 1
app = "furniture"
title = "step stool whose lower step stands 170 mm before the upper one"

[wood]
name = "pine"
thickness = "18 mm"

[planks]
lside = { from = [0.2, -0.2, 0], to = [0.2, -0.2, 0.42], width = [0.22, 0, 0] }
rside = { from = [0.2, 0.2, 0], to = [0.2, 0.2, 0.42], width = [0.22, 0, 0] }
upper = { from = [0.2, -0.22, 0.43], to = [0.2, 0.22, 0.43], width = [0.24, 0, 0] }
lcheek = { from = [0, -0.2, 0], to = [0, -0.2, 0.2], width = [0.15, 0, 0] }
rcheek = { from = [0, 0.2, 0], to = [0, 0.2, 0.2], width = [0.15, 0, 0] }
lower = { from = [0, -0.22, 0.21], to = [0, 0.22, 0.21], width = [0.15, 0, 0] }

[effects]
gravity = {}
guidance = {}
"""
"""A step stool in two parts."""

STEP_STOOL = """format = "restshape-scene"
version = 1
app = "furniture"
[wood]
name = "pine"
thickness = "18 mm"
[fastener]
name = "screw"
spacing = "30 mm"
[planks.lside]
from = [0, -0.2, 0]
to = [0, -0.2, 0.4]
width = [0.36, 0, 0]
[planks.rside]
from = [0, 0.2, 0]
to = [0, 0.2, 0.4]
width = [0.36, 0, 0]
[planks.upper]
from = [0.12, -0.2, 0.39]
to = [0.12, 0.2, 0.39]
width = [0.2, 0, 0]
[planks.lower]
from = [-0.12, -0.2, 0.2]
to = [-0.12, 0.2, 0.2]
width = [0.2, 0, 0]
[weights.tools]
on = "upper"
mass = "2 kg"
[pushes.up]
on = "upper"
force = [0, 0, "-1000 N"]
at = [0, -0.45, -0.5]
[pushes.down]
on = "lower"
force = ["-60 N", 0, "-1000 N"]
at = [0.3, -0.45, -0.5]
[effects.gravity]
[effects.push]
"""
"""A stool of two sides and two steps with their mirror plane, each step loaded at an edge."""

RAIL_STOOL = """
[wood]
name = "pine"
thickness = "18 mm"

[fastener]
name = "screw"
spacing = "30 mm"

[floor]
friction = 0.6

[planks.seat]
from = [-0.2, 0, 0.45]
to = [0.2, 0, 0.45]
width = [0, 0.28, 0]

[planks.left]
from = [-0.15, 0, 0]
to = [-0.15, 0, 0.441]
width = [0, 0.26, 0]

[planks.right]
from = [0.15, 0, LOW]
to = [0.15, 0, 0.441]
width = [0, 0.26, 0]

[planks.rail]
from = [FROM, 0, 0.2]
to = [TO, 0, 0.2]
width = [0, 0.2, 0]

[weights.sitter]
on = "seat"
mass = "60 kg"

[pushes.shove]
on = "seat"
force = ["160 N", 0, 0]

[effects.gravity]
[effects.push]
[effects.guidance]
"""
"""A stool whose legs have faces at -0.141 and 0.141 m; it breaks unless the rail meets both."""

CORNER = """
[wood]
name = "pine"
thickness = 0.02

[fastener]
name = "screw"

[planks.base]
from = [{x}, 0, 0.01]
to = [{x} + 0.4, 0, 0.01]
width = [0, 0.2, 0]

[planks.wall]
from = [{x}, 0, 0.01]
to = [{x}, 0, 0.5]
width = [0, 0.2, 0]

[weights.box]
on = "wall"
mass = "2 kg"
at = [0.5, 0, 0]

[pushes.pull]
on = "wall"
force = [5, 0, 0]
at = [0.5, 0, 0]

[effects.gravity]
g = [0, 0, -10]

[effects.push]
"""
"""An L: a base on the floor and a wall, whose middle lines meet; a push over the base."""

POST = """format = "restshape-scene"
version = 1
app = "furniture"
title = "a post on a board"
[wood]
name = "pine"
thickness = "18 mm"
[fastener]
name = "screw"
spacing = "20 mm"
[floor]
friction = 0.9
[planks.base]
center = [0, 0, "9 mm"]
size = [4, 4]
[planks.post]
from = [0, 0, "18 mm"]
to = [0, 0, "1018 mm"]
width = [0, WIDTH, 0]
[pushes.across]
on = "post"
at = [0.5, 0, 0]
force = [1, 0, 0]
[pushes.along]
on = "post"
at = [0.5, 0, 0]
force = [0, FORCE, 0]
[effects.gravity]
[effects.push]
"""


def post(width: str, force: str) -> str:
    """A post whose joint is as long as it is wide, pushed at its top along the joint."""
    return POST.replace("WIDTH", f'"{width}"').replace("FORCE", f'"{force}"')


ARM = (
    post("0.9 m", "1 N").split("[pushes.across]")[0]
    + """[effects.gravity]
[planks.arm]
from = ["9 mm", 0, 0.8]
to = ["209 mm", 0, 0.8]
width = [0, 0, "24 mm"]
[planks.out]
from = [0.2, 0.009, 0.8]
to = [0.2, 0.6, 0.8]
width = ["18 mm", 0, 0]
[weights.w]
on = "out"
at = [0.5, 0, 0.5]
mass = "MASS"
"""
)
"""The post with an arm, and a board that hangs out from it."""


def rail_stool(start: float, end: float, low: float = 0.0) -> str:
    """A stool whose rail goes from x = `start` to `end` [m], and whose right leg begins at a height of `low` [m]."""
    ends = {"FROM": start, "TO": end, "LOW": low}
    return HEAD + reduce(lambda text, one: text.replace(one[0], repr(one[1])), ends.items(), RAIL_STOOL)


def corner_of_boards(x: float) -> str:
    """An L whose corner is at x [m]."""
    return HEAD + CORNER.replace("{x} + 0.4", repr(x + 0.4)).replace("{x}", repr(x))


def rail(start: float, end: float, y: float = 0.0, width: float = 0.1) -> str:
    """A level rail of `BENCH` along x, 0.2 m high [m]; its legs' inner faces are at x = -0.49 and 0.49 m."""
    return f"\n[planks.rail]\nfrom = [{start}, {y}, 0.2]\nto = [{end}, {y}, 0.2]\nwidth = [0, {width}, 0]\n"


def write_bench(folder: Path, text: str = BENCH, name: str = "bench.toml") -> Path:
    """A scene file of a bench: a board of 1.2 m on two legs 1 m apart."""
    path = folder / name
    path.write_text(HEAD + text)
    return path


def write_edits(folder: Path, *events: dict, name: str = "edits.jsonl", **header: str) -> Path:
    """An edit script of events a second apart."""
    first = {"format": "restshape-edits", "version": 1, "units": "m", **header}
    lines = [first, *({"t": float(k), **event} for k, event in enumerate(events))]
    path = folder / name
    path.write_text("".join(json.dumps(line) + "\n" for line in lines))
    return path
