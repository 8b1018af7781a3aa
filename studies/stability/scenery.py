"""Small scenes and scripts from text, and replays of them in this process."""

import json
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from restshape.application import application_of
from restshape.calibration import Calibration
from restshape.interface.frame_loop import frame_loop
from restshape.interface.run import Run
from restshape.policy import Policy, policy
from restshape.replay.loop import Replay
from restshape.replay.request import Measured, Request
from restshape.scene.edit_script import Script, load_script
from restshape.scene.load import load_scene

BLOCK = """
[shape]
outline = ["bottom", "right", "top", "left"]

[shape.vertices]
a = [0, 0]
b = [{width}, 0]
c = [{width}, {height}]
d = [0, {height}]

[shape.edges]
bottom = {{ line = ["a", "b"] }}
right = {{ line = ["b", "c"] }}
top = {{ line = ["c", "d"] }}
left = {{ line = ["d", "a"] }}
"""

HOLE = """
[shape.holes]
window = { circle = { center = [0.5, 0.5], radius = 0.15 } }
"""

STEEL = """
[material.steel]
E = 200e9
nu = 0.3
rho = 8000
thickness = 0.01

[effects.solid]
model = "plane_stress"
"""

CLAMPED = """
[supports.wall]
on = "left"
fix = ["x", "y"]
"""

PULLED = """
[loads.pull]
on = "right"
traction = ["100 MPa", 0]
"""

QUANTITIES = """
[quantities]
stretch = { displacement = "x", at = "right", reduce = "mean" }
peak = { stress = "von_mises", reduce = "max" }
wall = { reaction = "x", at = "left" }
energy = { energy = "strain" }
"""


def head(app: str) -> str:
    """The first lines of a scene of an application."""
    return f'format = "restshape-scene"\nversion = 1\napp = "{app}"\n'


def block(width: float = 1.0, height: float = 1.0) -> str:
    """The [shape] of a rectangle whose lower left corner is the origin."""
    return BLOCK.format(width=width, height=height)


def meshed(size: float, order: int | None = 1) -> str:
    """The [mesh] of a constant size [m], with few triangles around holes; None leaves the order to the plan."""
    named = f"order = {order}\n" if order else ""
    return f"\n[mesh]\nsize = {size}\nedges_per_circle = 8\n{named}"


def plate(app: str, size: float = 0.12, order: int = 1) -> str:
    """A 2 m x 1 m plate of plane solids with a round hole, clamped at the left, pulled at the right."""
    return head(app) + block(2.0, 1.0) + HOLE + STEEL + CLAMPED + PULLED + meshed(size, order) + QUANTITIES


def write_scene(folder: Path, text: str, name: str = "scene.toml") -> Path:
    """The scene file with this text."""
    path = folder / name
    path.write_text(text)
    return path


def write_script(folder: Path, events: Iterable[dict[str, Any]], name: str = "edits.jsonl") -> Path:
    """The edit script with these events, a tenth of a second apart."""
    lines = [{"format": "restshape-edits", "version": 1, "units": "m"}]
    lines += [{"t": round(0.1 * i, 6), **event} for i, event in enumerate(events)]
    path = folder / name
    path.write_text("".join(json.dumps(line) + "\n" for line in lines))
    return path


def drag(on: str, start: Sequence[float], path: Sequence[Sequence[float]]) -> list[dict[str, Any]]:
    """A press, a drag along a path of cursor positions [m], and a release."""
    return [
        {"do": "press", "on": on, "at": list(start)},
        {"do": "drag", "path": [list(p) for p in path]},
        {"do": "release"},
    ]


def across(start: Sequence[float], end: Sequence[float], frames: int) -> list[tuple[float, float]]:
    """Cursor positions of a straight drag, without its start."""
    return [tuple(a + (b - a) * k / frames for a, b in zip(start, end)) for k in range(1, frames + 1)]


def set_value(key: str, *values: object) -> list[dict[str, Any]]:
    """Edits that give a key one value after the other."""
    return [{"do": "set", "key": key, "value": value} for value in values]


def make_run(*args: Any, recorder: Any = None, **named: Any) -> Run:
    """A run in this process, of what `requested` takes."""
    return Run(requested(*args, **named), recorder, summed=False)


def make_replay(*args: Any, recorder: Any = None, **named: Any) -> Replay:
    """The frame loop of such a run alone, for who tests it by itself."""
    return frame_loop(requested(*args, **named), recorder)


def requested(
    scene: Path,
    script: Path | None = None,
    name: str = "auto",
    overrides: Sequence[str] = (),
    calibration: Calibration | None = None,
    predict: str = "none",
    measured: Measured = "all",
    **changed: Any,
) -> Request:
    """What is replayed: a scene with a script, or none, under a policy; `changed` replaces fields of the policy."""
    read = load_scene(scene, overrides)
    edits = load_script(script, read) if script else Script.empty(read)
    chosen: Policy = replace(policy(name), **changed)
    known = calibration or Calibration.load()
    return Request(read, edits, application_of(read), chosen, known, predict=predict, measured=measured)


def rows_of(run: Run | Replay, look: Callable[[dict[str, Any]], None] = lambda row: None) -> list[dict[str, Any]]:
    """All rows of a run, or of the frame loop of one; `look` is called after each."""
    rows = []
    for row in run.rows() if isinstance(run, Run) else run.frames():
        look(row)
        rows.append(dict(row))
    return rows
