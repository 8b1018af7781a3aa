"""Hard cases of buckling: no load factor at all, extreme slenderness, twins, near-mechanisms, loads that turn round."""

import numpy as np
import pytest
from columns import FOOT, HINGES, PUSHED, TWINS, Column, column, euler, solved
from petsc4py import PETSc
from restshape_apps.solid.picture import main
from scipy.linalg import eigh
from small_scenes import across, drag, make_replay, rows_of, write_scene, write_script

from restshape.algebra.eigen import COUNT_EVERY
from restshape.algebra.gather import whole_matrix

PULL = '\n[loads.head]\non = "right"\nforce = [{0}, 0]\n'


def set_load(*forces: float) -> list[dict]:
    return [{"do": "set", "key": "loads.head.force", "value": [force, 0]} for force in forces]


def test_a_load_that_pulls(tmp_path):
    """Nothing buckles: the factor is infinite, the verdict holds, the row says so, and all goes on."""
    text = column(FOOT, PULL.format(1e3)).replace("load_factor = 1 }", "load_factor = 1, at_least = 1 }")
    longer = drag("right", (1, 0.025), across((1, 0.025), (1.1, 0.025), 4))
    script = write_script(tmp_path, [*longer, *set_load(-1e3, 2e3)])
    rows = rows_of(make_replay(write_scene(tmp_path, text), script))
    assert not any(row["refused"] for row in rows)
    for row in rows[:-2]:
        assert row["q_first"] == row["mu_1"] == np.inf and row["verdict"] == "holds"
        assert row["note"].startswith("nothing buckles: no load factor up to")
    assert rows[-2]["q_first"] == pytest.approx(euler(0.05, np.pi / 2, 1.1) / 1e3, rel=0.01)
    assert "nothing" not in rows[-2]["note"]
    assert rows[-1]["q_first"] == np.inf


def test_no_load_at_all(tmp_path):
    scene, script = write_scene(tmp_path, column(FOOT, PULL.format(0))), write_script(tmp_path, set_load(-1e3))
    rows = rows_of(make_replay(scene, script))
    assert rows[0]["q_first"] == np.inf and np.isfinite(rows[1]["q_first"]) and not rows[1]["refused"]


def test_a_body_that_supports_only_carry_away(tmp_path):
    """Both ends go the same way: no strain but rounding, no load, no load factor."""
    ends = '\n[supports.ends]\non = ["left", "right"]\nfix = { x = 0.3, y = -0.2 }\n'
    analysis = solved(tmp_path, column(ends))
    assert analysis.most == np.inf and not len(analysis.load_factors) and "without a load" in analysis.row()["note"]


def test_a_thousandth(tmp_path):
    """Thickness over length 1/1000, with triangles of that size: Euler's load, however small against the stiffness."""
    text = column(height=0.001, size=0.003, modes=2)
    analysis = solved(tmp_path, text.replace("tolerance = 1e-9", "tolerance = 1e-6"))
    for factor, z in zip(analysis.load_factors, (0.5 * np.pi, 1.5 * np.pi)):
        assert 1e3 * factor == pytest.approx(euler(0.001, z), rel=1e-3)


def test_a_stocky_block(tmp_path):
    """As wide as long: its load factors are far beyond sense, those within a mean strain of 1 are still found."""
    analysis = solved(tmp_path, column(height=1.0, size=0.2))
    assert np.all(np.diff(analysis.load_factors) >= 0) and np.all(analysis.load_factors > 1e4)
    assert np.all(analysis.load_factors < analysis.most) and analysis.residual() < 1e-8


def test_a_neck_that_is_nearly_a_hinge(tmp_path):
    """A column whose middle is cut to a hundredth: it folds there, like two struts on a spring of bending."""
    neck, length = 0.002, 1.0
    cut = f"""
[shape.holes.upper]
polygon = [[0.499, {0.025 + neck / 2}], [0.501, {0.025 + neck / 2}], [0.501, 0.0495], [0.499, 0.0495]]
[shape.holes.lower]
polygon = [[0.499, 0.0005], [0.501, 0.0005], [0.501, {0.025 - neck / 2}], [0.499, {0.025 - neck / 2}]]
"""
    whole = column(HINGES, PUSHED.format(1e3), size=0.03)
    analysis = solved(tmp_path, whole.replace("\n[material", cut + "\n[material", 1))
    weaker, stronger = analysis.load_factors[0], solved(tmp_path, whole).load_factors[0]
    assert 0.0 < weaker < stronger and analysis.residual() < 1e-6
    shape = np.abs(analysis.modes[0].reshape(-1, 2)[:, 1])
    assert abs(analysis.mesh.X[np.argmax(shape), 0] - 0.5 * length) < 0.05


def test_there_and_back(tmp_path):
    """Dragged thinner and thick again, a column has the load factors that it had, and their modes their numbers."""
    text = column(HINGES, PUSHED.format(1e3), height=0.1, size=0.05, modes=3)
    path = across((0.5, 0.1), (0.5, 0.04), 30) + across((0.5, 0.04), (0.5, 0.1), 30)
    script = write_script(tmp_path, drag("top", (0.5, 0.1), path))
    rows = rows_of(make_replay(write_scene(tmp_path, text), script))
    assert not any(row["refused"] or row["missed"] for row in rows)
    assert rows[-1]["q_first"] == pytest.approx(rows[0]["q_first"], rel=1e-6)
    assert {row["track"] for row in rows} == {"1 2 3"}


def test_two_that_cross(tmp_path):
    """Of two masts the left one is dragged thicker, then thinner than the other: the modes trade places, and say so."""
    path = across((0, 0.5), (-0.004, 0.5), 8) + across((-0.004, 0.5), (0.004, 0.5), 16)
    script = write_script(tmp_path, drag("left", (0, 0.5), path))
    rows = rows_of(make_replay(write_scene(tmp_path, TWINS), script))
    assert not any(row["refused"] for row in rows)
    thick, thin = rows[9]["track"].split(), rows[-1]["track"].split()
    assert thick[:2] == thin[1::-1]
    # The third is the next one of whichever mast is thinner: of the right one first, which is as it was.
    assert rows[9]["mu_3"] == pytest.approx(rows[0]["mu_3"], rel=1e-4) and rows[-1]["mu_3"] < 0.9 * rows[0]["mu_3"]
    assert thick[2] not in thin
    # The right mast is as it was.
    number = thick[0]
    for row in rows[5:]:
        place = row["track"].split().index(number) + 1
        assert row[f"mu_{place}"] == pytest.approx(rows[9]["mu_1"], rel=2e-2)


def test_twins_are_both_found_from_nothing(tmp_path):
    """A Krylov space grown from one vector hardly knows two modes of nearly one factor: the count tells of both."""
    for name in ("auto", "rebuild", "refactor"):
        analysis = solved(tmp_path, TWINS, policy=name)
        assert analysis.load_factors[1] == pytest.approx(analysis.load_factors[0], rel=1e-3) and analysis.eigen.counted
        assert analysis.load_factors[2] > 2.0 * analysis.load_factors[1]


def test_a_lost_mode_is_found_by_the_next_count(tmp_path):
    """The lowest mode is taken from all that a frame begins with: the count misses it, and it is found."""
    design = Column(tmp_path, column(modes=2))
    critical = design.analysis.critical
    lost = design.analysis.modes[0]
    stiff = np.stack([design.analysis.stiffness_product(lost.reshape(-1, 2)).ravel()])
    critical.history = [block[1:] - (block[1:] @ stiff.T) * lost for block in critical.history]
    critical.uncounted, critical.known = COUNT_EVERY, 2
    found = design.move(1e-6 * np.sin(design.X))
    assert design.analysis.eigen.missed >= 1
    np.testing.assert_allclose(found, design.load_factors, rtol=1e-3)


def test_a_picture_of_the_modes(tmp_path, capsys):
    path = write_scene(tmp_path, column())
    assert main([str(path), "--out", str(tmp_path / "a.png")]) == 0 and (tmp_path / "a.png").stat().st_size > 1e4
    pulled = write_scene(tmp_path, column(FOOT, PULL.format(1e3)), "pulled.toml")
    assert main([str(pulled), "--out", str(tmp_path / "b.png")]) == 2 and not (tmp_path / "b.png").exists()
    assert "nothing buckles" in capsys.readouterr().err


def test_a_violent_drag(tmp_path):
    """Ten times as long and back in jumps, with new meshes on the way: equal to what is solved from nothing there."""
    scene = write_scene(tmp_path, column(height=0.05, size=0.04).replace("tolerance = 1e-9", "tolerance = 1e-8"))
    path = [(2.0, 0.025), (1.0, 0.025), (4.0, 0.025), (0.5, 0.025), (1.0, 0.025)]
    script = write_script(tmp_path, drag("right", (1, 0.025), path))
    rows, cold = (rows_of(make_replay(scene, script, name)) for name in ("auto", "rebuild"))
    assert not any(row["refused"] for row in rows)
    for row, length in zip(rows[2:7], (2.0, 1.0, 4.0, 0.5, 1.0)):
        assert 1e3 * row["q_first"] == pytest.approx(euler(0.05, np.pi / 2, length), rel=0.02)
    np.testing.assert_allclose([r["q_first"] for r in rows], [r["q_first"] for r in cold], rtol=2e-3)


def masts(widths: list[float], gap: float = 0.1, height: float = 1.0, base: float = 0.1) -> tuple[str, float]:
    """A scene of masts [m] on one held base, all pressed by the same traction, and the place of its right side."""
    left = np.cumsum([0.0, *(w + gap for w in widths[:-1])])
    points = [(0.0, 0.0), (left[-1] + widths[-1], 0.0)]
    for k in reversed(range(len(widths))):
        points += [(left[k] + widths[k], height), (left[k], height)]
        points += [(left[k], base), (left[k - 1] + widths[k - 1], base)] if k else []
    sides = list(zip(points, [*points[1:], points[0]]))
    on = {y: ", ".join(f'"e{i}"' for i, (p, q) in enumerate(sides) if p[1] == q[1] == y) for y in (0.0, base, height)}
    text = 'format = "restshape-scene"\nversion = 1\napp = "solid"\n[shape]\noutline = ['
    text += ", ".join(f'"e{i}"' for i in range(len(points))) + "]\n[shape.vertices]\n"
    text += "".join(f"p{i} = [{x}, {y}]\n" for i, (x, y) in enumerate(points)) + "[shape.edges]\n"
    text += "".join(f'e{i} = {{ line = ["p{i}", "p{(i + 1) % len(points)}"] }}\n' for i in range(len(points)))
    text += "[material.steel]\nE = 200e9\nnu = 0.3\nthickness = 0.01\n[effects.solid]\n[effects.buckling]\nmodes = 1\n"
    text += f'[supports.base]\non = [{on[0.0]}, {on[base]}]\nfix = ["x", "y"]\n'
    text += f"[loads.tips]\non = [{on[height]}]\ntraction = [0, -2e7]\n[mesh]\nsize = 0.06\n"
    return text + "[solve]\ntolerance = 1e-4\n[quantities]\nfirst = { load_factor = 1 }\n", float(points[1][0])


def dense(analysis) -> float:
    """The lowest positive load factor by LAPACK, which cannot miss it."""
    pencil = analysis.critical.pencil
    G, K = (whole_matrix(m, PETSc.COMM_SELF).toarray() for m in (pencil.stiffness, pencil.mass))
    free = analysis.physics.mask.ravel() == 0
    return (
        1.0
        / eigh(
            -G[np.ix_(free, free)], K[np.ix_(free, free)], eigvals_only=True, subset_by_index=2 * [int(free.sum()) - 1]
        )[0]
    )


@pytest.mark.parametrize("frames", [1, 4, 11])
def test_a_mast_that_becomes_the_weakest_is_seen_when_the_hand_rests(tmp_path, frames):
    """The last of five, the thickest, is dragged thinner than the others, of which it knows nothing."""
    text, side = masts([0.05, 0.052, 0.054, 0.056, 0.11])
    way = across((side, 0.5), (side - 0.06875, 0.5), frames)
    script = write_script(tmp_path, [*drag("e1", (side, 0.5), way), {"do": "idle", "frames": 2}])
    made = make_replay(write_scene(tmp_path, text), script)
    rows, known = [], -1
    for row in made.frames():
        rows.append(row)
        assert not row["refused"], row["refused"]
        if row["counted"] and made.analysis.geometry != known:
            right, known = dense(made.analysis), made.analysis.geometry
        if row["counted"]:
            assert row["mu_1"] == pytest.approx(right, rel=1e-5), row["index"]
    assert rows[-1]["mu_1"] < 0.7 * rows[0]["mu_1"]
    resting = [row for row in rows if row["do"] in ("release", "idle")]
    assert all(row["counted"] for row in resting) and not any(row["missed"] for row in resting[1:])
    assert resting[0]["q_first"] == resting[0]["mu_1"]
