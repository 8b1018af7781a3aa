"""Scenes and scripts that the tests of shapes share."""

import json
from pathlib import Path

from small_scenes import CURVED

from restshape.scene.edit_script import Script, load_script
from restshape.scene.load import load_scene
from restshape.scene.model import Scene, ShapeSpec
from restshape.shape.build import outline_from_spec
from restshape.shape.outline import Outline

PLATE = {
    "vertices": {"a": [0, 0], "b": [2, 0], "c": [2, 1], "d": [0, 1]},
    "edges": {
        "bottom": {"line": ["a", "b"]},
        "right": {"arc": ["b", "c"], "through": [2.2, 0.5]},
        "top": {"spline": ["c", "d"], "through": [[1.5, 1.1], [0.8, 1.2], [0.5, 1.1]]},
        "left": {"polyline": ["d", "a"], "through": [[0.05, 0.7], [-0.05, 0.3]]},
    },
    "outline": ["bottom", "right", "top", "left"],
    "holes": {"window": {"circle": {"center": [0.5, 0.5], "radius": 0.2}}},
    "regions": {"patch": {"polygon": [[1.3, 0.3], [1.6, 0.3], [1.6, 0.6]]}},
    "points": {"probe": [1.0, 0.5]},
    "groups": {"pair": ["window", "patch"]},
}


def plate() -> Outline:
    """A plate with an edge of every kind, a round hole, a region and an embedded point."""
    return outline_from_spec(ShapeSpec.model_validate(PLATE))


def shape(**tables) -> Outline:
    """The outline of plain tables."""
    return outline_from_spec(ShapeSpec.model_validate(tables))


def square(**tables) -> Outline:
    """The unit square with further tables."""
    corners = {"a": [0, 0], "b": [1, 0], "c": [1, 1], "d": [0, 1]}
    sides = {"bottom": ["a", "b"], "right": ["b", "c"], "top": ["c", "d"], "left": ["d", "a"]}
    edges = {name: {"line": ends} for name, ends in sides.items()}
    return shape(vertices=corners, edges=edges, outline=list(sides), **tables)


def scene_and_script(folder: Path, events: list[dict], text: str = CURVED) -> tuple[Scene, Script]:
    """The scene with this text and a script of events, each in its own 20 ms."""
    (folder / "plate.toml").write_text(text)
    header = {"format": "restshape-edits", "version": 1, "scene": "plate.toml", "units": "m"}
    lines = [header, *({"t": 0.02 * i, **event} for i, event in enumerate(events))]
    (folder / "edits.jsonl").write_text("\n".join(map(json.dumps, lines)) + "\n")
    scene = load_scene(folder / "plate.toml")
    return scene, load_script(folder / "edits.jsonl", scene)
