"""Small scenes of furniture that tests of several folders share."""

import json
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
