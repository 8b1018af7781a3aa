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
