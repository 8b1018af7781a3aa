"""Scenes of several panels: laid in one pattern plane, meshed one by one, placed each in space, draped together."""

import numpy as np
import pytest
from small_scenes import head, make_replay, meshed, write_scene, write_script

from restshape.errors import UserError
from restshape.scene.load import load_scene
from restshape.shape.build import outline_from_spec

COTTON = """
[material.cotton]
E = "0.2 MPa"
nu = 0.3
rho = "500 kg/m^3"
thickness = "0.3 mm"
bending = "5e-6 N m"
[effects.gravity]
[effects.drape]
tolerance = 1e-8
"""
HUNG = '[supports.{name}]\non = "{name}.top"\nfix = ["x", "y", "z"]\n'


def panel(name: str, *keys: str, width: float = 0.2, height: float = 0.15) -> str:
    """The table of a panel of a width and height [m], with other keys."""
    return "\n".join(
        [
            f"[panels.{name}]",
            'outline = ["bottom", "right", "top", "left"]',
            f"vertices = {{ a = [0, 0], b = [{width}, 0], c = [{width}, {height}], d = [0, {height}] }}",
            'edges = { bottom = { line = ["a", "b"] }, right = { line = ["b", "c"] }, top = { line = ["c", "d"] },'
            ' left = { line = ["d", "a"] } }',
            *keys,
            "",
        ]
    )


def garment(*tables: str, size: float = 0.05) -> str:
    """The text of a scene of cloth with these tables."""
    return head("cloth") + COTTON + "\n".join(tables) + meshed(size)


FRONT = panel("front", "move = [0, 0, 0.5]", 'turn = ["90 deg", 0, 0]')
BACK = panel("back", "move = [0, 0.3, 0.5]", 'turn = ["90 deg", 0, "30 deg"]', width=0.15)
BOTH = FRONT + BACK + HUNG.format(name="front") + HUNG.format(name="back")

OVERLAPPING = FRONT.replace("move =", "at = [0.02, 0.05]\nmove =") + BOTH[len(FRONT) :].replace(
    "move =", "at = [0, 0]\nmove ="
)


def drape(folder, text: str):
    """The replay of a scene, at rest."""
    replay = make_replay(write_scene(folder, text))
    assert all(row["converged"] for row in replay.frames())
    return replay


def corners(replay, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Material coordinates (n, 2) and positions (n, 3) [m] of the nodes of a panel, or of all, in the order of X."""
    problem = replay.analysis.problem
    mesh, x = problem.mesh, problem.corners(replay.analysis.x)
    nodes = mesh.nodes_of(name)
    order = np.lexsort(np.round(mesh.X[nodes] - mesh.X[nodes].min(axis=0), 9).T)
    return mesh.X[nodes][order], x[nodes][order]


def test_panels_lie_beside_each_other_and_keep_their_names(tmp_path):
    """What says no place is packed; each of several pieces has nodes and triangles of its own."""
    scene = load_scene(write_scene(tmp_path, garment(BOTH)))
    outline = outline_from_spec(scene.shape)
    assert outline.piece_names == ("front", "back")
    assert {"front", "back", "front.top", "back.a", "outline", "all"} <= outline.layout.entities.keys()
    assert outline.area() == pytest.approx(0.2 * 0.15 + 0.15 * 0.15)
    low, high = outline.bounds()
    assert np.prod(high - low) < 2.0 * outline.area()


def test_panels_drape_as_the_same_sheets_alone(tmp_path):
    """Beside each other, of meshes that know nothing of each other: to the tolerance of rest."""
    both = drape(tmp_path, garment(BOTH))
    for name, text in (("front", FRONT), ("back", BACK)):
        alone = drape(tmp_path, garment(text, HUNG.format(name=name)))
        X, x = corners(both, name)
        X_alone, x_alone = corners(alone, name)
        np.testing.assert_allclose(X - X.min(axis=0), X_alone - X_alone.min(axis=0), atol=1e-12)
        np.testing.assert_allclose(x, x_alone, atol=1e-6)


def test_a_drag_moves_the_nodes_of_its_panel_alone(tmp_path):
    """The others keep their places in the pattern to the last bit, and in space to the tolerance of rest."""
    press, drag = {"t": 0, "do": "press", "on": "front.b"}, {"t": 0, "do": "drag", "to": [0.21, -0.01], "frames": 2}
    path = write_scene(tmp_path, garment(BOTH.replace("move", "at = [0, 0]\nmove", 1)))
    replay = make_replay(path, write_script(tmp_path, [press, drag]))
    places, levels = [], []
    for row in replay.frames():
        places.append({name: corners(replay, name) for name in ("front", "back")})
        levels.append(row["level"])
        assert row["converged"] and not row["refused"]
    assert levels[-2:] == [1, 1]
    np.testing.assert_array_equal(places[-1]["back"][0], places[0]["back"][0])
    np.testing.assert_allclose(places[-1]["back"][1], places[0]["back"][1], atol=1e-6)
    assert places[-1]["front"][0][:, 0].max() == pytest.approx(0.21)


@pytest.mark.parametrize(
    ("text", "what", "where"),
    [
        (OVERLAPPING, "panels front and back would overlap", "panels"),
        (BOTH.replace('"front.top"', '"front.tip"'), "there is no entity 'front.tip'", "supports.front.on"),
        (BOTH.replace('line = ["c", "d"]', 'line = ["c", "e"]', 1), "there is no vertex 'e'", "panels.front.edges.top"),
        (BOTH + '[shape]\noutline = ["a"]\n', "[panels] and a [shape]", "shape"),
    ],
)  # fmt: skip
def test_bad_panels_are_refused_by_name(tmp_path, text, what, where):
    """With the key of the panel as the scene writes it, and its line."""
    with pytest.raises(UserError) as refused:
        make_replay(write_scene(tmp_path, garment(text)))
    assert what in refused.value.what and where in refused.value.where
