"""Seams: pairs by share of length, forces that both sides have alike, derivatives, and cloth that is sewn."""

from dataclasses import replace

import numpy as np
import pytest
from drape_designs import COTTON, DrapeDesign
from small_scenes import block, head, make_replay, meshed, write_scene, write_script

from restshape._kernels import NearPairs
from restshape.errors import UserError
from restshape.fem.assembled import Assembled
from restshape.fem.elements import HINGE, SEAM_FLAT
from restshape.fem.integral import Integral
from restshape.interface.first_frame import first_frame
from restshape.physics.cloth.cloth_problem import ClothProblem
from restshape.physics.cloth.relaxation.close_seams import close_seams, has_opened
from restshape.physics.cloth.relaxation.equilibrium import EquilibriumSolver
from restshape.physics.cloth.relaxation.relaxation_report import ConvergenceReport
from restshape.physics.cloth.seams.seam_lines import SeamLine, SeamPair
from restshape.physics.cloth.seams.seams import Seams, Springs
from restshape.physics.cloth.sensitivity.hand_rates import node_motion
from restshape.physics.cloth.sheet.fabric import Fabric
from restshape.physics.cloth.sheet.membrane import Membrane
from restshape.scene.load import load_scene

TUBE = """
[seams.side]
from = "left"
to = "right"
[supports.pin]
on = ["a", "d"]
fix = ["x", "y", "z"]
"""


def strip(width, height, rows, offset=0.0):
    """Nodes (n, 2) and triangles of a rectangle, two nodes wide, with nodes at these parts of its height."""
    y = height * np.asarray(rows)
    X = np.column_stack([np.tile([offset, offset + width], len(y)), np.repeat(y, 2)])
    cells = np.array([(k + a, k + b, k + c) for k in range(0, len(X) - 2, 2) for a, b, c in ((0, 1, 3), (0, 3, 2))])
    return X, cells.astype(np.int32)


def two_strips(rows, other):
    """Two rectangles of 0.1 m x 0.2 m that are sewn together, one beside the other in the pattern."""
    X, cells = strip(0.1, 0.2, rows)
    Y, others = strip(0.1, 0.2, other, 0.3)
    right = np.arange(len(rows), dtype=np.int32) * 2 + 1
    left = len(X) + np.arange(len(other), dtype=np.int32) * 2
    lines = [SeamLine(nodes, np.ones(len(nodes) - 1)) for nodes in (right, left)]
    seams = Seams([SeamPair("middle", *lines, 3e5, 0.02, 0.05)], np.arange(len(X) + len(Y), dtype=np.int32))
    places = np.vstack([X, Y])
    seams.place(places)
    return places, np.vstack([cells, others + len(X)]), seams


def irregular(count, seed):
    """Parts of a height, from 0 to 1."""
    inner = np.sort(np.random.default_rng(seed).uniform(0.05, 0.95, count))
    return np.concatenate([[0.0], inner, [1.0]])


def test_uniform_stretch_goes_through_a_seam_of_unlike_meshes():
    """The patch test: constant tension leaves nothing but what the springs give, in either mesh."""
    X, cells, seams = two_strips(irregular(4, 1), irregular(7, 2))
    modulus, strain = 300.0, 0.03
    membrane = Membrane("stvk", cells)
    fabric = Fabric(np.diag([modulus, modulus, 0.5 * modulus]), np.zeros((3, 3)), 0.1, "none", 1.0, "stvk")
    membrane.update(fabric, np.zeros(len(cells)), np.zeros(3), 1.0)
    x = np.column_stack([(1 + strain) * X[:, 0], X[:, 1], np.zeros(len(X))])
    tension = modulus * (strain + 0.5 * strain**2) * (1 + strain)
    second = X[:, 0] > 0.2
    x[second, 0] += -0.2 * (1 + strain) + tension / 3e5
    forces = Assembled([membrane.integral(X), seams.integral(1)]).residual(x)
    inner = (X[:, 0] > 0.05) & (X[:, 0] < 0.35)
    assert np.abs(forces[inner]).max() < 1e-12 * modulus
    assert seams.gap(x) == pytest.approx(tension / 3e5)
    # Energy of the springs: k g^2/2 along the whole seam.
    assert seams.integral(1).energies(x).sum() == pytest.approx(0.5 * tension**2 / 3e5 * 0.2)


def test_forces_on_both_sides_are_equal_and_opposite():
    X, _, seams = two_strips(irregular(3, 5), irregular(5, 6))
    x = np.random.default_rng(1).normal(size=(len(X), 3))
    forces = Assembled([seams.integral(1)]).residual(x)
    first = X[:, 0] < 0.2
    np.testing.assert_allclose(forces[first].sum(axis=0), -forces[~first].sum(axis=0), rtol=1e-12)


def test_alike_sides_are_sewn_node_to_node():
    rows = irregular(4, 3)
    _, _, seams = two_strips(rows, rows)
    number, pairs = seams.sewing()
    assert len(seams.nodes) == len(rows) and not len(pairs)
    assert len(np.unique(number)) == len(number) - len(rows)


def test_places_that_both_sides_have_keep_all_nodes_of_a_corner_between_edges():
    # Two edges at a distance on the second side: both of their ends are sewn to the node between.
    springs = Springs.of([np.array([0.0, 0.5, 1.0]), np.array([0.0, 0.5, 0.5, 1.0])])
    assert sorted(springs.node[springs.lines == 1]) == [1, 2]


@pytest.mark.parametrize("seed", [0, 1])
def test_forces_follow_places_in_the_material_to_first_order(seed):
    """dr/dX of springs whose places, lengths and shares hang on all nodes of both sides."""
    X, _, seams = two_strips(irregular(4, 10 + seed), irregular(6, 20 + seed))
    random = np.random.default_rng(seed)
    x, dX = random.normal(size=(len(X), 3)), random.normal(size=X.shape) * 1e-2
    rate = np.zeros_like(x)
    seams.integral(1).add_design_product(x, dX, rate)

    def forces(step):
        seams.place(X + step * dX)
        return Assembled([seams.integral(1)]).residual(x)

    here, errors = forces(0.0), []
    for step in (1e-2, 5e-3):
        errors.append(np.abs(forces(step) - here - step * rate).max())
    assert np.abs(rate).max() > 1.0 and 1.8 < np.log2(errors[0] / errors[1]) < 2.2


def test_a_seam_sewn_flat_bends_like_an_edge_between_triangles():
    """The hinge of the same cloth in one piece: pieces of alike meshes are whole edges."""
    rows = irregular(2, 4)
    X, Y = strip(0.1, 0.2, rows)[0], strip(0.15, 0.2, rows, 0.1)[0]
    x = np.random.default_rng(3).normal(size=(len(X), 3))
    y = np.random.default_rng(4).normal(size=(len(Y), 3))
    y[::2] = x[1::2]
    # As one cloth: the second one's left nodes are the first one's right ones.
    whole, both = np.vstack([X, Y]), np.vstack([x, y])
    first = 2 * np.arange(len(rows) - 1)
    left, right = np.column_stack([first + 1, first + 3]), len(X) + np.column_stack([first, first + 2])
    # Of the first strip's triangles the lower ones are at its right, of the second's the upper ones at its left.
    corners = first, len(X) + first + 3
    hinge = Integral(HINGE["flap4"], whole, np.column_stack([left, *corners]).astype(np.int32), np.array([2e-3]))
    flaps = np.column_stack([left, corners[0], right, corners[1]]).astype(np.int32)
    lengths = np.zeros((len(whole), 1))
    found = []
    for flap in flaps:
        lengths[:] = 0.0
        lengths[flap[0]] = np.linalg.norm(whole[flap[1]] - whole[flap[0]])
        piece = Integral(SEAM_FLAT["flap6"], whole, flap[None], np.array([2e-3]), coefficients=lengths)
        found.append(piece.energies(both)[0])
    np.testing.assert_allclose(found, hinge.energies(both), rtol=1e-12)


def test_moving_and_turning_a_side_in_the_pattern_changes_no_force():
    X, _, seams = two_strips(irregular(4, 1), irregular(5, 2))
    x = np.random.default_rng(1).normal(size=(len(X), 3))
    second, moved = X[:, 0] > 0.2, np.zeros_like(X)
    moved[second] = (X[second] - X[second].mean(axis=0)) @ [[0.0, 1.0], [-1.0, 0.0]] + [0.3, -0.1]
    rate = np.zeros_like(x)
    seams.integral(1).add_design_product(x, moved, rate)
    scale = np.abs(Assembled([seams.integral(1)]).residual(x)).max()
    assert np.abs(rate).max() < 1e-12 * scale


def test_parts_that_are_sewn_together_do_not_meet():
    X, cells = np.array([[0, 0], [1, 0], [0, 1], [3, 0], [4, 0], [3, 1.0]]), np.array([[0, 1, 2], [3, 4, 5]], np.int32)
    edges = np.array([[0, 1], [0, 2], [1, 2], [3, 4], [3, 5], [4, 5]], np.int32)
    x = np.column_stack([X % 3, [0, 0, 0, 1e-3, 1e-3, 1e-3]])
    known = NearPairs(X, edges, cells)
    assert len(known.search(x, 2e-3)[0]) == 9
    known.sew(np.array([0, 1, 2, 0, 4, 5], np.int32), np.array([[1, 5]], np.int32))
    edge_edge, cell_node = known.search(x, 2e-3)
    # Of the edges, those with node 0 or 3, and those with 1 or 5, are neighbours.
    assert edge_edge.tolist() == [[1, 5], [2, 3]]
    assert cell_node.tolist() == [[0, 4], [1, 2]]


@pytest.mark.parametrize("kind", ["morley", "hinge"])
def test_moments_across_a_flat_seam_follow_places_in_the_material(unlike, kind):
    design = unlike(kind, 'stitched = "flat"')
    problem, mesh = design.problem, design.analysis.space
    random = np.random.default_rng(0)
    x, dX = random.normal(size=(problem.n_nodes, 3)), random.normal(size=mesh.X.shape) * 1e-3
    rate, here = np.zeros_like(x), mesh.X.copy()
    problem.seam_bending.integral(1).add_design_product(x, node_motion(problem, dX), rate)

    def forces(step):
        mesh.X[...] = here + step * dX
        problem.update()
        return Assembled([problem.seam_bending.integral(1)]).residual(x)

    before, errors = forces(0.0), []
    for step in (0.2, 0.1):
        errors.append(np.abs(forces(step) - before - step * rate).max())
    assert errors[0] < 0.1 * np.abs(0.2 * rate).max() and 1.7 < np.log2(errors[0] / errors[1]) < 2.3


def tube(kind="hinge", size=0.04, extra=""):
    return head("cloth") + block(0.3, 0.1) + COTTON.format(kind=kind, bending=5e-6) + TUBE + extra + meshed(size)


@pytest.mark.parametrize("kind", ["morley", "hinge"])
def test_a_strip_is_sewn_to_a_tube_that_hangs(tmp_path, kind):
    quantities = '[quantities]\nsewn = { energy = "seams" }\npull = { reaction = "z", at = "left" }\n'
    row = first_frame(write_scene(tmp_path, tube(kind, extra=quantities))).row
    assert row["converged"] == 1 and row["tangent_positive_definite"] == 1
    assert row["seam_gap"] < 1e-4 and row["crossings"] == 0
    assert row["seam_energy"] == row["q_sewn"] > 0.0
    assert row["q_pull"] == pytest.approx(500 * 0.3e-3 * 9.81 * 0.03, rel=1e-6)


UNLIKE = """
[shape]
outline = ["bottom", "lower", "upper", "top", "left"]
[shape.vertices]
a = [0, 0]
b = [0.3, 0]
m = [0.3, 0.037]
c = [0.3, 0.1]
d = [0, 0.1]
[shape.edges]
bottom = { line = ["a", "b"] }
lower = { line = ["b", "m"] }
upper = { line = ["m", "c"] }
top = { line = ["c", "d"] }
left = { line = ["d", "a"] }
[seams.side]
from = "left"
to = ["lower", "upper"]
[supports.pins]
on = ["a", "d"]
fix = ["x", "y", "z"]
[effects.contact]
self = false
"""
"""A strip whose sides have other nodes: springs go from both to places between."""


def unlike_text(kind, more):
    """The text of its scene with other keys of the seam."""
    sewn = UNLIKE.replace("[supports", f"{more}\n[supports", 1)
    return head("cloth") + sewn + COTTON.format(kind=kind, bending=5e-6) + meshed(0.04)


@pytest.fixture
def unlike(tmp_path):
    """Returns a function that makes the drape of a strip that is sewn to a tube."""

    return lambda kind, more="": DrapeDesign(tmp_path, unlike_text(kind, more))


@pytest.mark.slow
@pytest.mark.parametrize("more", ["", 'stitched = "flat"'])
@pytest.mark.parametrize("kind", ["morley", "hinge"])
def test_remainder_of_a_sewn_drape_is_of_second_order(unlike, kind, more):
    design = unlike(kind, more)
    first, second = design.remainders(design.direction(), 1e-4)
    assert second > 1e-10 and 1.8 < np.log2(first / second) < 2.2


@pytest.mark.slow
@pytest.mark.parametrize(
    "key", ["material.cotton.E", "material.cotton.bending", "seams.side.stiffness", "seams.side.slack"]
)
def test_remainder_by_what_gives_seams_their_stiffness_is_of_second_order(unlike, key):
    design = unlike("hinge", 'stitched = "flat"')
    value = 0.2e6 if key == "material.cotton.E" else 5e-6
    if key == "seams.side.stiffness":
        # Soft enough that it matters.
        value = 50.0
        design.take(design.scene_with(key, value))
    if key == "seams.side.slack":
        value = 1e-4
        design.take(design.scene_with(key, value))
    s = design.analysis.number_derivatives([key], 1e-10).s[0]
    steps = (0.04 * value, 0.02 * value)
    first, second = (float(np.linalg.norm(design.change(key, value + h) - design.x - h * s)) for h in steps)
    assert second > 1e-10 and 1.8 < np.log2(first / second) < 2.2


MESSAGES = {
    "unknown": ('from = "front"\nto = "right"', "'front', which is not there"),
    "no edge": ('from = "a"\nto = "right"', "'a', which is 'vertex'"),
    "itself": ('from = "left"\nto = "left"', "'left' would be sewn to itself"),
    "twice": (
        'from = "left"\nto = "right"\n[seams.other]\nfrom = "right"\nto = "left"\nreverse = true',
        "in unlike ways",
    ),
}


@pytest.mark.parametrize("case", MESSAGES)
def test_seams_that_make_no_sense_are_refused(tmp_path, case):
    text, message = MESSAGES[case]
    cloth = head("cloth") + block() + COTTON.format(kind="hinge", bending=1e-6) + meshed(0.2)
    with pytest.raises(UserError, match=message):
        load_scene(write_scene(tmp_path, f"{cloth}[seams.one]\n{text}\n"))


def test_a_seam_on_a_plane_of_symmetry_is_refused(tmp_path):
    text = tube().replace('on = ["a", "d"]\nfix = ["x", "y", "z"]', 'on = "left"\nsymmetry = "x"')
    with pytest.raises(UserError, match="plane of symmetry: there the cloth goes on"):
        load_scene(write_scene(tmp_path, text))


@pytest.mark.slow
def test_an_edit_that_closes_a_wide_seam_comes_to_rest(tmp_path):
    """From springs that give by decimetres to stiff ones, with contact of the cloth with itself."""
    text = tube(size=0.03).replace('to = "right"', 'to = "right"\nstiffness = 1e-3')
    design = DrapeDesign(tmp_path, text)
    assert design.analysis.row()["seam_gap"] > 0.1 and "open by" in design.analysis.row()["note"]
    design.take(design.scene_with("seams.side.stiffness", 1e6))
    row = design.analysis.row()
    assert row["converged"] == 1 and row["seam_gap"] < 1e-4 and row["crossings"] == 0


OWN = "[effects.contact]\nself = false\n"


@pytest.fixture
def falls(monkeypatch):
    """A list of the parts of their stiffness that seams have in each fall."""
    pulls, fall = [], EquilibriumSolver.fall

    def counted(solver, *given):
        pulls.append(solver.problem.seams.pull)
        fall(solver, *given)

    monkeypatch.setattr(EquilibriumSolver, "fall", counted)
    return pulls


def test_frames_with_a_seam_that_is_held_open_take_as_few_steps_as_any(tmp_path, falls):
    """All four corners are pinned: the seam stays as wide as the strip."""
    design = DrapeDesign(tmp_path, tube(extra=OWN).replace('["a", "d"]', '["a", "b", "c", "d"]'))
    row = design.analysis.row()
    assert row["seam_gap"] == pytest.approx(0.3)
    # A cold start gives up once the seam pulls with all that it has, and not after 200 rounds.
    assert 1.0 in falls and len(falls) < 100
    falls.clear()
    before = design.x
    design.take(design.scene_with("material.cotton.rho", 500.0 * (1 + 1e-6)))
    assert design.analysis.row()["relaxation_steps"] <= 2 and not falls
    assert np.abs(design.x - before).max() < 1e-7


def test_seams_are_closed_again_where_they_are_new_others_or_wider(tmp_path):
    design = DrapeDesign(tmp_path, tube(extra=OWN).replace('["a", "d"]', '["a", "b", "c", "d"]'))
    state, other = design.analysis.state, design.scene_with("seams.side.stiffness", 1e6)
    seam, gap = state.gaps["side"]
    assert gap == pytest.approx(0.3)
    for scene, known, opened in (
        (design.scene, state.gaps, False),
        (design.scene, {}, True),
        (other, state.gaps, True),
        (design.scene, {"side": (seam, 0.9 * gap)}, True),
    ):
        assert has_opened(state.solver, design.x, scene, known) == opened


def test_cloth_that_nothing_catches_falls_once_while_its_seam_is_open(tmp_path, falls):
    ball = "[bodies.ball]\nsphere = { center = [0.15, 0.05, 0.5], radius = 0.1 }\n[effects.contact]\n"
    row = first_frame(write_scene(tmp_path, tube().split("[supports")[0] + ball + meshed(0.04))).row
    assert row["converged"] == 0 and "falls without end" in row["note"]
    # The one in which the seam pulls softly, and that of the cold start.
    assert len(falls) == 2 and falls[0] < 0.1 and falls[1] == 1.0


def test_a_closing_that_is_interrupted_leaves_seams_with_all_of_their_stiffness(tmp_path, monkeypatch):
    design = DrapeDesign(tmp_path, tube(extra=OWN).replace('["a", "d"]', '["a", "b", "c", "d"]'))
    pulls, state = [], design.analysis.state

    def stopped(solver, *_):
        pulls.append(solver.problem.seams.pull)
        raise KeyboardInterrupt

    monkeypatch.setattr(EquilibriumSolver, "fall", stopped)
    with pytest.raises(KeyboardInterrupt):
        close_seams(state.solver, design.x.copy(), 100, ConvergenceReport())
    assert pulls[0] < 1.0 and design.problem.seams.pull == 1.0
    assert state.solver.residual_norm(design.x) < 1e-8


def test_a_strip_whose_own_ends_are_sewn_together_keeps_its_weight_meanwhile(tmp_path, monkeypatch):
    """Panels have a twentieth of it."""
    parts, lightened = [], ClothProblem.lightened
    monkeypatch.setattr(ClothProblem, "lightened", lambda *given: parts.append(given[1]) or lightened(*given))
    first_frame(write_scene(tmp_path, tube(extra=OWN)))
    assert parts == [1.0]


def test_versions_of_a_stiffened_sheet_never_come_again(tmp_path):
    """A matrix of steps that was made with the plate counts as old in all later frames."""
    problem = DrapeDesign(tmp_path, tube(extra=OWN).replace('["a", "d"]', '["a", "b", "c", "d"]')).problem
    begun = problem.stiffness_version
    with problem.stiffened(0.03):
        pass
    assert problem.stiffness_version == begun
    with problem.stiffened(0.03):
        seen = []
        for pull in (0.1, 0.2, 1.0):
            problem.pull_seams(pull)
            seen.append(problem.stiffness_version)
    for _ in range(4):
        problem.update()
        assert problem.stiffness_version not in seen


def test_an_upright_strip_is_sewn_to_a_tube_that_hangs_by_a_corner(tmp_path):
    """Its energy is that of the strip laid double, whose middle hangs half a diagonal below the pin: no crumples."""
    upright = '[start]\nturn = ["90 deg", 0, 0]\n[quantities]\nsum = { energy = "potential" }\n'
    one = TUBE.replace('["a", "d"]', '"d"')
    text = head("cloth") + block(0.5, 0.2) + COTTON.format(kind="morley", bending=5e-6) + one + upright + meshed(0.04)
    row = first_frame(write_scene(tmp_path, text)).row
    assert row["converged"] == 1 and row["max_strain"] < 0.05 and row["seam_gap"] < 1e-3
    assert row["q_sum"] < 1.1 * 500 * 0.3e-3 * 9.81 * 0.1 * (0.2 - np.hypot(0.25, 0.2) / 2)


FLAT = 'stitched = "flat"'
EDITS = {
    "edges": ("from", "top", ('from = "left"', 'from = "top"')),
    "reverse": ("reverse", True, ('to = ["lower"', 'reverse = true\nto = ["lower"')),
}


@pytest.mark.parametrize("kind", ["morley", "hinge"])
@pytest.mark.parametrize("case", EDITS)
def test_a_flat_seam_that_an_edit_gives_other_edges_rests_where_a_cold_scene_rests(unlike, kind, case, tmp_path):
    """Folds may be others, so that the rest of the edit is put into the cloth of the edited scene."""
    key, value, words = EDITS[case]
    design = unlike(kind, FLAT)
    design.take(design.scene_with(f"seams.side.{key}", value))
    cold = DrapeDesign(tmp_path, unlike_text(kind, FLAT).replace(*words))
    solver = cold.analysis.state.solver
    assert solver.residual_norm(design.x) < 1e-8
    assert design.problem.energy(design.x) == pytest.approx(cold.problem.energy(design.x), rel=1e-10)
    assert solver.residual_norm(cold.x) < 1e-8


def test_ties_of_a_flat_seam_have_the_mesh_size_at_their_own_seam(unlike):
    problem = unlike("morley", FLAT).problem
    seams, before = problem.seams, problem.seam_bending.stiffness.copy()
    (pair,) = seams.pairs
    # Another seam before it, which is not flat, and has a mesh of another size.
    seams.pairs = (replace(pair, name="other", size=10.0 * pair.size, flat=False), pair)
    problem.update()
    np.testing.assert_allclose(problem.seam_bending.stiffness, before, rtol=1e-14)


def test_an_edit_adds_a_seam_to_a_scene_without_any(tmp_path):
    """By its own table; the drape is that of the scene with it, and an undo takes it out."""
    sewn = tube(size=0.2, extra=OWN)
    bare = sewn.replace('[seams.side]\nfrom = "left"\nto = "right"\n', "")
    assert bare != sewn
    edit = {"do": "set", "key": "seams.side", "value": {"from": "left", "to": "right"}}
    replay = make_replay(write_scene(tmp_path, bare), write_script(tmp_path, [edit, {"do": "undo"}]))
    rows = [dict(row) for row in replay.frames()]
    assert all(row["converged"] and not row["refused"] for row in rows)
    assert [np.isnan(row["seam_gap"]) for row in rows] == [True, False, True]
    assert rows[1]["seam_gap"] < 1e-3 and rows[1]["seam_energy"] > 0.0


def test_edits_add_seams_and_take_them_out(tmp_path):
    """By the whole table; undo and redo lead to the same rests."""
    strip = tube(extra=OWN)
    side, top = {"from": "left", "to": "right"}, {"from": "top", "to": "bottom", "stiffness": 1e3}
    events = [
        {"do": "set", "key": "seams", "value": {"side": side, "top": top}},
        {"do": "set", "key": "seams", "value": {}},
        {"do": "undo"},
        {"do": "undo"},
        {"do": "redo"},
    ]
    replay = make_replay(write_scene(tmp_path, strip), write_script(tmp_path, events))
    names, rows, places = [], [], []
    for row in replay.frames():
        seams = replay.analysis.problem.seams
        names.append([pair.name for pair in seams.pairs] if seams else [])
        rows.append(row)
        places.append(replay.analysis.x.copy())
    assert all(row["converged"] and not row["refused"] for row in rows)
    assert names == [["side"], ["side", "top"], [], ["side", "top"], ["side"], ["side", "top"]]
    assert [np.isnan(row["seam_gap"]) for row in rows] == [not own for own in names]
    for first, again in ((1, 3), (0, 4), (1, 5)):
        np.testing.assert_allclose(places[again], places[first], atol=1e-9)
