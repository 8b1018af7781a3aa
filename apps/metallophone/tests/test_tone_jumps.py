"""Jumps by the mesh of quantities that follow a mode: both values are of the same mode, whatever its rank."""

import math

import restshape

RING = {
    "format": "restshape-scene",
    "version": 1,
    "app": "metallophone",
    "shape": {
        "outline": ["upper", "lower"],
        "vertices": {"a": [-0.05, 0.0], "b": [0.05, 0.0]},
        "edges": {
            "upper": {"arc": ["b", "a"], "through": [0.0, 0.05]},
            "lower": {"arc": ["a", "b"], "through": [0.0, -0.05]},
        },
        "holes": {"bore": {"circle": {"center": [0.005, 0.0], "radius": 0.022}}},
    },
    "material": {"brass": {"name": "brass", "thickness": 0.005}},
    "effects": {"modal": {"model": "plane_stress", "modes": 3}},
    "mesh": {"size": 0.008},
    "solve": {"jumps": True},
    "quantities": {"first": {"cents": "C6"}, "mode": {"mode": 1}},
}
DRAG = [
    {"do": "press", "on": "bore", "at": [0.005, 0.0]},
    {"do": "drag", "path": [[0.0, 0.021], [0.02, 0.0]], "frames": 12},
    {"do": "release"},
]


def test_a_mode_that_changes_its_rank_does_not_jump_to_another():
    """Two modes of nearly one frequency change ranks and part; flips change each of them far less than that."""
    scene = restshape.new_scene(RING)
    seen = 0
    for frame in restshape.replay(scene, restshape.new_script(scene, DRAG)):
        row = frame.row
        if not row["index"] or row["level"] < 2 or not row["mode_ids"].startswith("2 1"):
            continue
        apart = 1200.0 * math.log2(row["f_2"] / row["f_1"])
        assert abs(row["first_jump"]) < 0.2 * apart
        assert abs(row["mode_jump"]) < 0.2 * (row["f_2"] - row["f_1"])
        seen += 1
    assert seen


PLATE = {
    "format": "restshape-scene",
    "version": 1,
    "app": "metallophone",
    "shape": {
        "outline": ["bottom", "right", "top", "left"],
        "vertices": {"a": [0.0, 0.0], "b": [0.16, 0.0], "c": [0.16, 0.1], "d": [0.0, 0.1]},
        "edges": {
            "bottom": {"line": ["a", "b"]},
            "right": {"line": ["b", "c"]},
            "top": {"line": ["c", "d"]},
            "left": {"line": ["d", "a"]},
        },
        "holes": {"bore": {"circle": {"center": [0.06, 0.045], "radius": 0.015}}},
    },
    "material": {"steel": {"name": "steel", "thickness": 0.004}},
    "effects": {"modal": {"model": "plate", "modes": 5}},
    "mesh": {"size": 0.008},
    "solve": {"jumps": True},
    "quantities": {"first": {"mode": 1}, "second": {"mode": 2}, "third": {"mode": 3}},
}
SHORTER_AND_BACK = [
    {"do": "press", "on": "right"},
    {"do": "drag", "path": [[0.09, 0.05]], "frames": 20},
    {"do": "release"},
    {"do": "undo"},
    {"do": "redo"},
]


def test_modes_of_an_undo_are_compared_with_themselves():
    """Whole drags that are undone and redone change modes beyond likeness; meshes change a frequency by a percent."""
    scene = restshape.new_scene(PLATE)
    seen = set()
    for frame in restshape.replay(scene, restshape.new_script(scene, SHORTER_AND_BACK)):
        row = frame.row
        for name in PLATE["quantities"]:
            jump = row[f"{name}_jump"]
            if math.isfinite(jump):
                assert abs(jump) < 0.01 * row[f"q_{name}"], (row["index"], name)
                seen.add(row["event"])
    assert {"undo", "redo"} <= seen
