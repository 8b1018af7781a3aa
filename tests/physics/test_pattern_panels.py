"""Scenes of several panels: side by side in one pattern, meshed one by one, placed each in space, draped together."""

import numpy as np
import pytest
from small_scenes import head, make_replay, meshed, write_scene, write_script

from restshape.cli.main import main
from restshape.errors import UserError
from restshape.interface.first_frame import first_frame
from restshape.physics.cloth.contact.thin_bodies import borne
from restshape.physics.cloth.free_pieces import falling_pieces
from restshape.physics.cloth.relaxation.binding import mesh_in_frames
from restshape.scene.edge_names import edge_suggestion
from restshape.scene.edit_script import load_script
from restshape.scene.load import load_scene, revise
from restshape.scene.panels import frames_of
from restshape.shape.build import outline_from_spec
from restshape.shape.hand.panel_drag import with_frames
from restshape.shape.panels.panel_placement import PatternPlacement, plane_axes
from restshape.shape.session import EditSession

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
    assert "overlap" not in what or "packed in rows" in refused.value.do


def test_a_wrapped_panel_keeps_its_lengths_and_lies_on_its_cylinder(tmp_path):
    """About the axis of a body that leans: distances along the pattern are those along the cylinder."""
    post = "[bodies.post]\ncapsule = { start = [0, 0, 0], end = [0.1, 0, 0.3], radius = 0.04 }\n[effects.contact]\n"
    tables = panel("front", "at = [0.3, 0.1]", 'angle = "20 deg"', 'around = "post"', width=0.1), post
    scene = load_scene(write_scene(tmp_path, garment(*tables)))
    outline = outline_from_spec(scene.shape)
    X = np.array([[0.0, 0.0], [0.1, 0.0], [0.0, 0.15], [0.1, 0.15]]) @ plane_axes(frames_of(scene)["front"]).T
    X += [0.3, 0.1]
    np.testing.assert_allclose(X, outline.points[[0, 1, 3, 2]], atol=1e-15)
    places, pieces = PatternPlacement(scene), np.zeros(4, dtype=np.int32)
    axis = np.array([0.1, 0.0, 0.3]) / np.hypot(0.1, 0.3)
    off = places.places(X, pieces) - [0.05, 0.0, 0.15]
    np.testing.assert_allclose(off @ axis, [0.0, 0.0, 0.15, 0.15], atol=1e-15)
    np.testing.assert_allclose(np.linalg.norm(off - np.outer(off @ axis, axis), axis=1), 0.05)
    around = off[1] - off[1] @ axis * axis
    assert np.arccos(around @ off[0] / 0.05**2) * 0.05 == pytest.approx(0.1)
    assert off[0, 1] < 0.0 and off[1, 0] > off[0, 0], "from the front to the right"
    step = 1e-6 * np.array([[0.6, 0.8]])
    slope = (places.places(X[1:2] + step, pieces[:1]) - places.places(X[1:2] - step, pieces[:1])) / 2.0
    np.testing.assert_allclose(places.directions(step, X[1:2], pieces[:1]), slope, atol=1e-14)


def test_each_panel_has_its_material_and_grain(tmp_path):
    """Grain turns with the panel; a panel that names no material is of the one that none names."""
    lining = (
        '[material.lining]\northotropic = { E = ["2 MPa", "1 MPa", "1 MPa"], nu = [0.1, 0.1, 0.1],'
        ' G = [3e5, 3e5, 3e5] }\nrho = 300\nthickness = "0.1 mm"\n'
    )
    turned = panel("back", 'angle = "90 deg"', 'material = "lining"', 'grain = "-90 deg"')
    made = drape(tmp_path, garment(FRONT + turned + HUNG.format(name="front") + HUNG.format(name="back"), lining))
    problem = made.analysis.problem
    mesh, fabric = problem.mesh, problem.fabric
    front, back = mesh.cells_of("front"), mesh.cells_of("back")
    np.testing.assert_allclose(fabric.density[front], 0.15)
    np.testing.assert_allclose(fabric.density[back], 0.03)
    C = fabric.membrane[back]
    assert np.allclose(C[:, 0, 0] / C[:, 1, 1], 2.0)


def test_a_panel_that_is_only_moved_or_turned_in_the_pattern_drapes_as_before(tmp_path):
    """By the hand, by a turn and by a key: after an edit that its vertex keeps; no step is taken, and others stay."""
    events = [
        {"do": "press", "on": "front.b"},
        {"do": "drag", "to": [0.21, -0.01], "frames": 1},
        {"do": "release"},
        {"do": "press", "on": "front", "at": [0, 0]},
        {"do": "drag", "to": [-0.5, -0.3], "frames": 2},
        {"do": "release"},
        {"do": "rotate", "on": "front", "by": "40 deg", "frames": 2},
        {"do": "set", "key": "panels.front.at", "value": [-0.6, -0.4]},
        {"do": "undo"},
    ]
    path = write_scene(tmp_path, garment(BOTH.replace("move", "at = [0, 0]\nmove", 1)))
    replay, rows, seen = make_replay(path, write_script(tmp_path, events)), [], []
    for row in replay.frames():
        problem = replay.analysis.problem
        rows.append(row)
        seen.append((problem.mesh.X.copy(), problem.corners(replay.analysis.x).copy()))
    assert all(row["converged"] and not row["refused"] for row in rows), [row["refused"] for row in rows]
    edited = next(k for k, row in enumerate(rows) if row["line"] == 4)
    mesh = replay.analysis.problem.mesh
    back, front = mesh.nodes_of("back"), mesh.nodes_of("front")
    for X, x in seen[edited + 1 :]:
        np.testing.assert_allclose(x, seen[edited][1], atol=1e-12)
        np.testing.assert_array_equal(X[back], seen[edited][0][back])
    assert np.abs(seen[-1][0] - seen[edited][0])[front].max() > 0.3
    steps = {row["line"]: row["relaxation_steps"] for row in rows if row["level"] == 1}
    assert steps[6] == 0 and max(steps[line] for line in (8, 9, 10)) <= 1, "turns round what is at rest"
    scene = replay.session.scene
    own = PatternPlacement(scene).coordinates(mesh.X, mesh.node_piece)[front]
    np.testing.assert_allclose(own.max(axis=0), [0.21, 0.15], atol=1e-12)


FOLDED = """
[panels.front]
outline = ["hem", "side", "neck", "fold"]
mirror = "fold"
at = [0, 0]
turn = ["90 deg", 0, 0]
vertices = { a = [0, 0], b = [0.1, 0], c = [0.08, 0.15], d = [0, 0.15] }
edges = { hem = { line = ["a", "b"] }, side = { spline = ["b", "c"], through = [[0.07, 0.08]] }, neck = { arc = ["c", "d"], through = [0.03, 0.13] }, fold = { line = ["d", "a"] } }
holes = { eye = { circle = { center = [0.03, 0.05], radius = 0.01 } } }
[supports.front]
on = ["front.neck", "front.mirror.neck"]
fix = ["x", "y", "z"]
"""  # noqa: E501 (a line of TOML)


def test_a_panel_that_is_cut_on_the_fold_keeps_both_halves_alike(tmp_path):
    """The fold is a line of the mesh; a drag of one half moves the other, a vertex on the fold goes along it."""
    press = {"do": "press", "on": "front.b", "at": [0.1, 0.0]}
    drags = [press, {"do": "drag", "to": [0.12, 0.01], "frames": 1}, {"do": "release"}]
    drags += [{"do": "press", "on": "front.d", "at": [0, 0]}, {"do": "drag", "to": [0.01, 0.01], "frames": 1}]
    half = {"do": "insert", "on": "front.hem", "name": "front.m", "s": 0.5}
    path = write_scene(tmp_path, garment(FOLDED, size=0.03))
    replay = make_replay(path, write_script(tmp_path, [*drags, {"do": "release"}, half]))
    rows = list(replay.frames())
    assert not any(row["refused"] for row in rows)
    outline, mesh = replay.session.outline, replay.analysis.problem.mesh
    at = {name: outline.points[outline.entity(f"front.{name}").vertices[0]] for name in ("a", "b", "c", "d")}
    np.testing.assert_allclose(at["b"], [0.12, 0.01], atol=1e-15)
    np.testing.assert_allclose(at["d"], [0.0, 0.16], atol=1e-15)
    for name in ("b", "c"):
        image = outline.points[outline.entity(f"front.mirror.{name}").vertices[0]]
        np.testing.assert_allclose(image, at[name] * [-1, 1], atol=1e-15)
    given = outline_from_spec(load_scene(path).shape)
    on_it = given.point(given.entity("front.neck").edges[0], np.linspace(0.0, 1.0, 1001))
    assert np.hypot(*(on_it - [0.03, 0.13]).T).min() < 1e-4
    fold = mesh.nodes_of("front.fold")
    assert len(fold) > 4 and np.abs(mesh.X[fold, 0]).max() < 1e-12
    assert len(mesh.cells_of("front.mirror")) > 10
    assert outline.names("hole") == ["front.eye", "front.mirror.eye"]


@pytest.mark.parametrize(
    ("change", "what"),
    [
        (('mirror = "fold"', 'mirror = "side"'), "is no straight line"),
        (('mirror = "fold"', 'mirror = "spine"'), "there is no edge 'spine'"),
        (("c = [0.08, 0.15]", "c = [-0.08, 0.15]"), "would"),
    ],
)
def test_folds_that_cannot_be_are_refused(tmp_path, change, what):
    """A bent one, one that is not there, and one that the panel crosses."""
    with pytest.raises(UserError) as refused:
        make_replay(write_scene(tmp_path, garment(FOLDED.replace(*change))))
    assert what in refused.value.what and "panels.front" in refused.value.where


def test_a_panel_that_nothing_holds_falls_and_is_named(tmp_path):
    """The other one hangs; one that lies above it may come to lie on it, and is not lost yet."""
    replay = make_replay(write_scene(tmp_path, garment(FRONT + BACK + HUNG.format(name="front"))))
    (row,) = replay.frames()
    assert row["converged"] == 0 and "nothing catches back: it falls without end" in row["note"]
    problem = replay.analysis.problem
    flat = np.zeros((len(problem.mesh.X), 3))
    flat[problem.mesh.nodes_of("back"), 2] = 1.0
    problem.self_contact = problem.self_contact or object()
    assert falling_pieces(problem, flat) == ()
    assert falling_pieces(problem, -flat) == ("back",)
    # Two that both fall, side by side or one above the other, catch none.
    problem.supports.mask[:] = False
    assert all(falling_pieces(problem, way * flat) == ("front", "back") for way in (-1.0, 0.0, 1.0))


@pytest.mark.parametrize(
    ("edge", "do"),
    [
        ("bottom", "did you mean 'front.bottom' or 'back.bottom'?"),
        ("front.botom", "did you mean 'front.bottom'?"),
        ("zzz", "name one of the edges: front.bottom, "),
    ],
)
def test_an_edge_that_is_not_there_is_guessed(edge, do):
    named = [f"{panel}.{one}" for panel in ("front", "back") for one in ("bottom", "mirror.bottom", *"abcdefg")]
    assert do in edge_suggestion(edge, named)
    assert "and 6 more" in edge_suggestion("zzz", named)


def test_panels_of_two_triangles_drape(tmp_path):
    """A mesh as large as its panels."""
    made = drape(tmp_path, garment(BOTH, size=0.5))
    assert len(made.analysis.problem.mesh.cells) == 4


@pytest.mark.slow
def test_frames_of_panels_equal_cold_ones_under_each_policy(tmp_path):
    """After a drag, a vertex and a turn: the rest of a drag, and that of a new mesh of every panel."""
    events = [
        {"do": "press", "on": "front.b"},
        {"do": "drag", "to": [0.21, -0.01], "frames": 2},
        {"do": "release"},
        {"do": "insert", "on": "front.bottom", "name": "front.m", "s": 0.4},
        {"do": "rotate", "on": "front", "by": "-20 deg", "about": [0, 0], "frames": 2},
    ]
    path = write_scene(tmp_path, garment(BOTH.replace("move", "at = [0, 0]\nmove", 1)))
    script = write_script(tmp_path, events)
    ends = []
    for policy in ("auto", "rebuild"):
        replay = make_replay(path, script, policy)
        rows = list(replay.frames())
        assert all(row["converged"] and not row["refused"] for row in rows)
        x = replay.analysis.problem.corners(replay.analysis.x)
        ends.append([x[replay.analysis.problem.mesh.nodes_of(f"front.{name}")] for name in "abcd"])
    np.testing.assert_allclose(ends[0], ends[1], atol=2e-4)


def test_other_applications_refuse_panels(tmp_path):
    """They name one that has them."""
    path = write_scene(tmp_path, head("solid") + FRONT + meshed(0.05))
    with pytest.raises(UserError) as refused:
        load_scene(path)
    assert "panels" in refused.value.what and 'app = "' in refused.value.do


def test_contact_is_as_stiff_wherever_panels_lie(tmp_path):
    """A thin bar bears the largest panel, or what is sewn together, not the box around the pattern."""
    bar = "[bodies.bar]\ncapsule = { start = [-1, 0, 0], end = [1, 0, 0], radius = 0.005 }\n"
    given = {}
    for place in ("[0.5, 0]", "[3, 5]"):
        text = garment(FRONT, BACK.replace("move", f"at = {place}\nmove", 1), bar)
        scene = load_scene(write_scene(tmp_path, text.replace("[mesh]", "[effects.contact]\n[mesh]")))
        given[place] = borne(scene, 0.002)
    assert len(set(given.values())) == 1
    sewn = text + '[seams.side]\nfrom = "front.right"\nto = "back.left"\n'
    scene = load_scene(write_scene(tmp_path, sewn.replace("[mesh]", "[effects.contact]\n[mesh]")))
    assert borne(scene, 0.002)[0] == pytest.approx(1.5 * given["[3, 5]"][0])


def test_cloth_goes_to_a_new_mesh_wherever_its_panels_lie_then(tmp_path):
    """A vertex and a move in the pattern at once: an undo of both gives the last rest, which nothing has torn."""
    events = [
        {"do": "insert", "on": "front.bottom", "name": "front.m", "s": 0.4},
        {"do": "press", "on": "back", "at": [0.25, 0]},
        {"do": "drag", "to": [0.25, 0.6], "frames": 1},
        {"do": "release"},
        {"do": "set", "key": "panels.back.angle", "value": "30 deg"},
        {"do": "undo"},
    ]
    text = garment(
        FRONT, BACK.replace("move", "at = [0.25, 0]\nmove", 1), HUNG.format(name="front"), HUNG.format(name="back")
    )
    replay = make_replay(write_scene(tmp_path, text), write_script(tmp_path, events))
    rows = list(replay.frames())
    assert all(row["converged"] and not row["refused"] for row in rows)
    state = replay.analysis.state
    moved = replay.session.scene
    back = state.problem.mesh.nodes_of("back")
    for place in ([0.9, 0.3], [-0.5, -0.5]):
        scene = revise(moved, "panels.back.at", place)
        there = mesh_in_frames(state, scene)
        own = [
            PatternPlacement(one).coordinates(mesh.X, mesh.node_piece)
            for one, mesh in ((moved, state.problem.mesh), (scene, there))
        ]
        np.testing.assert_allclose(own[0], own[1], atol=1e-15)
        assert np.abs(there.X - state.problem.mesh.X)[back].min() > 0.1


def test_a_drag_of_panels_is_predicted(tmp_path):
    """Within the remainder of the derivative, on wrapped and mirrored panels too; keys of panels have none."""
    post = "[bodies.post]\ncapsule = { start = [0, 0, -1], end = [0, 0, 1], radius = 0.3 }\n"
    wrapped = FOLDED.replace('turn = ["90 deg", 0, 0]', 'around = "post"\nabout = [0, 0, 0]')
    tables = (
        wrapped,
        panel("back", "at = [0.5, 0]", 'around = "post"', 'turn = [0, 0, "180 deg"]'),
        HUNG.format(name="back"),
        post,
    )
    events = [{"do": "press", "on": "front.b", "at": [0.1, 0]}, {"do": "drag", "to": [0.102, -0.002], "frames": 1}]
    path, script = write_scene(tmp_path, garment(*tables, size=0.03)), write_script(tmp_path, events)
    ends = []
    for predict in ("none", "linear"):
        replay = make_replay(path, script, predict=predict)
        row = list(replay.frames())[-1]
        assert row["predicted"] == (predict == "linear"), row["note"]
        ends.append(replay.analysis.problem.corners(replay.analysis.x))
    assert np.abs(ends[1] - ends[0]).max() < 2e-5


@pytest.mark.slow
def test_panels_that_are_sewn_far_from_a_bar_do_not_fall_past_it_meanwhile(tmp_path):
    """Their tops are 0.7 m apart, and 0.1 m above the bar: seams that closed under weight would meet far below it."""
    sides = [
        panel(name, f"move = [0, {y}, 0]", 'turn = ["90 deg", 0, 0]') for name, y in (("front", -0.35), ("back", 0.35))
    ]
    seam = '[seams.top]\nfrom = "front.top"\nto = "back.top"\n'
    bar = "[bodies.bar]\ncapsule = { start = [0, 0, 0], end = [0.2, 0, 0], radius = 0.05 }\nfriction = 0.3\n"
    scene = garment(*sides, seam, bar, "[effects.contact]\n").replace("1e-8", "1e-4").replace("0.2 MPa", "5 kPa")
    row = first_frame(write_scene(tmp_path, scene)).row
    assert row["converged"] == 1 and row["seam_gap"] < 1e-3


def test_panels_that_overlap_are_packed_where_the_scene_says_so(tmp_path):
    """Whatever `at` says; no hand moves them then."""
    text = garment(OVERLAPPING).replace("version = 1", 'version = 1\nlayout = "auto"')
    replay = make_replay(write_scene(tmp_path, text))
    outline = replay.session.outline
    low, high = outline.bounds()
    assert outline.area() < np.prod(high - low) < 2.0 * outline.area()
    with pytest.raises(UserError, match="packs all panels"):
        with_frames(replay.session.scene, frames_of(replay.session.scene))


@pytest.mark.parametrize(
    ("event", "do"),
    [
        ({"do": "hole", "name": "window", "center": [0.1, 0.07], "radius": 0.02}, "name it front.window"),
        ({"do": "hole", "name": "back.eye", "center": [0.1, 0.07], "radius": 0.02}, "name it front.eye"),
        ({"do": "hole", "name": "front.1", "center": [0.1, 0.07], "radius": 0.02}, "name it front.new"),
        ({"do": "insert", "on": "front.bottom", "name": "v9", "s": 0.5}, "name it front.v9"),
    ],
)
def test_new_parts_have_names_of_their_panel(tmp_path, event, do):
    """Any other name is refused; one of the panel comes back from the scene that is written."""
    tables = FRONT.replace("move =", "at = [0, 0]\nmove ="), BOTH[len(FRONT) :].replace("move =", "at = [1, 0]\nmove =")
    path = write_scene(tmp_path, garment(*tables))
    scene = load_scene(path)
    right = event | {"name": do.removeprefix("name it ")}
    *_, refused, made = EditSession(scene, load_script(write_script(tmp_path, [event, right]), scene)).frames()
    assert do in refused.refused and not made.refused
    out = tmp_path / "again.toml"
    words = ["export", str(path), str(write_script(tmp_path, [right])), "--as", "toml", "--out", str(out)]
    assert main(words) == 0
    again = outline_from_spec(load_scene(out).shape)
    assert again.area() == pytest.approx(made.outline.area(), rel=1e-12)
    assert {right["name"]} <= again.layout.entities.keys()


@pytest.mark.parametrize(
    ("body", "radius"),
    [
        ("capsule = { start = [0, 0, 0.3], end = [0, 0, 0.3], radius = 0.04 }", 0.05),
        ("box = { center = [0, 0, 0.3], half = [0.03, 0.04, 0.5] }", 0.06),
        ('box = { center = [0, 0, 0.3], half = [0.03, 0.5, 0.04], rotate = ["90 deg", 0, "30 deg"] }', 0.06),
    ],
)
def test_a_panel_is_wrapped_around_all_of_a_body(tmp_path, body, radius):
    """A capsule of no length is a ball; the corners of a box that is turned are inside of the cylinder."""
    tables = panel("front", 'around = "post"', width=0.1), f"[bodies.post]\n{body}\n[effects.contact]\n"
    scene = load_scene(write_scene(tmp_path, garment(*tables)))
    X = outline_from_spec(scene.shape).points[:4]
    places = PatternPlacement(scene).places(X, np.zeros(4, dtype=np.int32))
    np.testing.assert_allclose(np.hypot(*places[:, :2].T), radius, atol=1e-15)


def test_a_picture_names_panels_and_their_edges_but_no_parts_of_their_other_halves(tmp_path, monkeypatch):
    figures = []
    monkeypatch.setattr("restshape.outputs.picture_files.write_figure", lambda figure, *_: figures.append(figure))
    seam = '[seams.one]\nfrom = "front.top"\nto = "back.bottom"\n'
    panels = panel("front", 'mirror = "left"') + panel("back", "move = [0, 0, 1]")
    scene = write_scene(tmp_path, garment(panels, HUNG.format(name="back"), seam))
    assert main(["check", str(scene), "--picture", str(tmp_path / "scene.png")]) == 0
    named = {text.get_text() for text in figures[0].axes[0].texts}
    # Those of a panel stand on it without its name.
    assert {"front", "back", "top", "right", "bottom", "mirror"} <= named
    assert not any("mirror." in name for name in named)


def test_panels_that_overlap_are_reported_before_a_dart_that_reaches_over_the_other_one(tmp_path):
    dart = '[darts.one]\nedge = "front.left"\nwidth = "1 cm"\nlength = "16 cm"\n'
    other = panel("back", "at = [0.1, 0]", width=0.5, height=0.3)
    scene = garment(panel("front", "at = [0, 0.1]"), other, HUNG.format(name="front"), HUNG.format(name="back"), dart)
    with pytest.raises(UserError, match="panels front and back would overlap"):
        outline_from_spec(load_scene(write_scene(tmp_path, scene)).shape)


HEAVY = """
[material.lead]
E = "0.2 GPa"
nu = 0.3
rho = "500000 kg/m^3"
thickness = "0.3 mm"
bending = "5e-3 N m"
"""


def test_errors_of_panels_are_those_of_their_own_fabrics(tmp_path):
    """Cloth a thousand times as stiff and as heavy drapes alike, so that the error of its strains is the same share."""
    back = FRONT.replace("front", "back").replace("move = [0, 0,", "move = [0, 0.3,")
    one = garment(FRONT, back, HUNG.format(name="front"), HUNG.format(name="back"))
    first, second = (text + f'material = "{name}"\n' for text, name in ((FRONT, "cotton"), (back, "lead")))
    two = garment(first, second, HUNG.format(name="front"), HUNG.format(name="back"), HEAVY)
    found = []
    for name, text in (("one", one), ("two", two)):
        row = next(make_replay(write_scene(tmp_path, text, f"{name}.toml")).frames())
        assert row["converged"] == 1
        found.append(row["estimate"])
    assert found[1] == pytest.approx(found[0], rel=1e-3)
