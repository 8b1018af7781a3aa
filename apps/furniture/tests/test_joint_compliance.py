"""What the compliance of joints decides: redundant joints, and a constraint status that changes; statics by numpy."""

import json

import numpy as np
import pytest
from furniture_scenes import BENCH, HEAD, STEP_STOOL
from restshape_apps.furniture.cli import check_planks, guidance
from restshape_apps.furniture.guidance.design import Design, Guidance
from restshape_apps.furniture.guidance.doubts import depends
from restshape_apps.furniture.physics.furniture import Compliance, Furniture
from restshape_apps.furniture.physics.joint_compliance import (
    ComplianceModels,
    UtilisationRange,
    compliances,
    recorded_utilisations,
    utilisation_range,
    utilisation_range_at,
)
from restshape_apps.furniture.physics.plank_findings import joint_planks
from restshape_apps.furniture.physics.plank_phrases import phrases
from restshape_apps.furniture.pieces import SCENES, cantilever, drawn, scales, table
from restshape_apps.furniture.shape.planks import Piece
from restshape_apps.furniture.small_pieces import bench, stretched
from small_scenes import make_replay

import restshape
from restshape.cli.main import main

RAIL = """
[planks.rail]
from = [0.17, -0.2, 0.12]
to = [0.17, 0.2, 0.12]
width = [0, 0, 0.08]
"""

BENCH_WITH_RAIL = (
    HEAD
    + BENCH.replace("20 kg", "8 kg").replace('on = "top"', 'on = "top"\nat = [0.4, 0, 0.5]')
    + """
[planks.rail]
from = [-0.49, 0, 0.2]
to = [0.49, 0, 0.2]
width = [0, 0.1, 0]
"""
)


def cross(v: np.ndarray) -> np.ndarray:
    """The matrix whose product with a vector is the vector product of v and that."""
    return np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])


def linear_utilisations(piece: Piece, compliance: Compliance) -> np.ndarray:
    """Uses of pull and shear, the larger (j,), under the weights, of rigid bodies on linear springs: K u = f."""
    furniture = Furniture(piece, compliance)
    furniture.test()
    g, n = furniture.geometry(), len(piece.planks)
    K, f, rows = np.zeros((6 * n, 6 * n)), np.zeros(6 * n), []
    for k, joint in enumerate(piece.joints):
        B = np.zeros((6, 6 * n))
        for plank, sign in ((joint.i, 1.0), (joint.j, -1.0)):
            arm = g.p[k] - g.centre[plank]
            B[:3, 6 * plank : 6 * plank + 6] = sign * np.hstack([np.eye(3), -cross(arm)])
            B[3:, 6 * plank + 3 : 6 * plank + 6] = sign * np.eye(3)
        scale = np.array([1.0 / compliance.joint_t] * 3 + [1.0 / compliance.joint_r] * 3)
        K += B.T @ (scale[:, None] * B)
        rows.append(scale[:, None] * B)
    for k, point in enumerate(g.contacts):
        plank = piece.feet[k // 4].plank
        B = np.zeros((3, 6 * n))
        B[:, 6 * plank : 6 * plank + 6] = np.hstack([np.eye(3), -cross(point - g.centre[plank])])
        K += B.T @ B / compliance.floor
    for k in range(n):
        f[6 * k : 6 * k + 3] += g.mass[k] * np.array(piece.gravity)
    for load in piece.weights:
        arm = g.axes[load.plank] @ (np.array(load.place) * g.size[load.plank])
        f[6 * load.plank : 6 * load.plank + 6] += np.concatenate([load.force, np.cross(arm, load.force)])
    u = np.linalg.solve(K, f)
    h = np.array([row @ u for row in rows])
    pull, shear = furniture.strength.T * g.nails
    tension, bending = np.sum(h[:, :3] * g.n, axis=1), np.sum(h[:, 3:] * g.y, axis=1)
    across = np.hypot(np.sum(h[:, :3] * g.x, axis=1), np.sum(h[:, :3] * g.y, axis=1))
    return np.maximum((2.0 * np.abs(bending) / furniture.lever + tension) / pull, across / shear)


def test_the_range_of_use_is_that_of_linear_springs() -> None:
    piece = Furniture(stretched(0.1)).moved()
    known, utilisations, compared = utilisation_range(piece, Compliance()), [], 0
    for one in compliances(piece, Compliance()):
        furniture = Furniture(piece, one)
        furniture.test()
        forces = furniture.forces()
        utilisations.append(forces.utilisation)
        # Feet that lift or slide are no linear springs.
        if not forces.one_sided:
            assert forces.utilisation == pytest.approx(linear_utilisations(piece, one), rel=2e-3, abs=1e-6)
            compared += 1
    assert compared >= 4 and len(known.redundant) > 1
    assert known.low == pytest.approx(np.min(utilisations, axis=0)) and known.high == pytest.approx(
        np.max(utilisations, axis=0)
    )


def test_frames_of_a_drag_range_over_compliances_with_the_model_that_there_is(monkeypatch) -> None:
    sim = restshape.open(restshape.load(SCENES / "table.toml"), strict=False)
    hand, made = sim.press("leg-4", at=[0.4, 0.2, 0.2]), []
    make = Furniture.__init__
    monkeypatch.setattr(Furniture, "__init__", lambda self, *given: (made.append(given), make(self, *given))[1])
    hand.to(0.42, 0.19, 0.2)
    analysis = sim.replay.analysis
    assert not made and len(analysis.utilisation_range.redundant)
    piece = analysis.design.furniture.moved(analysis.gamma)
    known = utilisation_range(piece, Compliance())
    assert known.high == pytest.approx(analysis.utilisation_range.high, rel=1e-9)
    assert known.low == pytest.approx(analysis.utilisation_range.low, rel=1e-9) and made
    assert utilisation_range_at(Furniture(piece), None).high == pytest.approx(known.high, rel=1e-12)
    sim.close()


def test_joints_that_alone_bear_a_load_are_not_redundant() -> None:
    for piece in (cantilever(), scales(), bench()):
        known = utilisation_range(Furniture(piece).moved(), Compliance())
        assert not len(known.redundant) and not known.changes and not known.findings(piece)


def test_a_constraint_status_that_changes_depends_on_joints() -> None:
    piece = table()
    known = utilisation_range(piece, Compliance())
    assert known.changes
    (one,) = known.findings(piece)
    assert (one.kind, one.subjects) == ("depends", ("leg-4", "top"))
    assert one.bound < 1.0 < one.value == known.high.max()
    replay = make_replay(SCENES / "table.toml")
    row = next(iter(replay.frames()))
    assert (
        row["constraint_status"] == "fails"
        and "depends on joints: the utilisation of leg-4 on top" in (row["violated_constraints"])
    )
    name, low, high = json.loads(row["redundant"])[0]
    assert (name, low, high) == (
        "leg-4 on top",
        pytest.approx(known.low.min(), abs=1.0),
        pytest.approx(one.value, rel=1e-3),
    )


def test_joints_that_are_weak_at_some_ratios_are_named_the_worst_first() -> None:
    piece = table()
    known = UtilisationRange(np.array([0.2, 0.1, 1.2, 0.3]), np.array([0.9, 1.125, 1.3, 1.4]), True)
    names = [one.subjects for one in known.findings(piece)]
    assert names == [joint_planks(piece, 3), joint_planks(piece, 1)]
    assert phrases(known.findings(piece)) == (
        "depends on joints: the utilisation of leg-4 on top from 0.30 to 1.40, leg-2 on top from 0.10 to 1.13"
        " over their compliances",
    )


def test_a_rail_is_redundant_and_named(tmp_path) -> None:
    path = tmp_path / "stool.toml"
    path.write_text(STEP_STOOL + RAIL)
    row = next(iter(make_replay(path).frames()))
    names = {name: (low, high) for name, low, high in json.loads(row["redundant"])}
    low, high = names["lower on rside"]
    assert high > 1.5 and low < 0.5 * high
    assert "depends on joints" not in row["violated_constraints"] and "falls" in row["violated_constraints"]


@pytest.mark.slow
@pytest.mark.parametrize("most", [12, 2])
def test_check_and_replay_print_the_same_redundant_joints(tmp_path, capsys, monkeypatch, most: int) -> None:
    path = tmp_path / "bench.toml"
    path.write_text(BENCH_WITH_RAIL)
    monkeypatch.setattr(check_planks, "SHOWN", most)
    monkeypatch.setattr(guidance, "MOST", most)
    assert main(["check", str(path)]) == 0
    checked = [line.split("redundant joint")[1].strip() for line in lines_with(capsys, "redundant joint ")]
    rows = list(make_replay(path).frames())
    known = json.loads(rows[0]["redundant"])
    # Little used ones are redundant too.
    assert len(known) == 4 and all(0.01 < high < 0.5 for _, _, high in known)
    guidance.print_guidance(rows)
    printed = [" ".join(line.split()) for line in capsys.readouterr().out.split("redundant joints")[1].splitlines()]
    names = [name for name, _, _ in known[:most]]
    assert [line.split(":")[0] for line in checked[:most]] == names
    assert [line.rsplit(" ", 2)[0] for line in printed[2 : 2 + most]][: len(names)] == names
    assert checked[most:] == (["and 2 more"] if most == 2 else [])
    assert ("... and 2 more" in printed) == (most == 2)


def lines_with(capsys, words: str) -> list[str]:
    """Printed lines that have these words."""
    return [line for line in capsys.readouterr().out.splitlines() if words in line]


def test_records_have_the_largest_first() -> None:
    piece = drawn("chair-2")
    known = utilisation_range(piece, Compliance())
    found = recorded_utilisations(piece, known, 9)
    assert [one[2] for one in found] == sorted((one[2] for one in found), reverse=True)
    assert len(found) == len(known.redundant)


def test_the_column_is_short_and_their_number_is_beside_it(capsys) -> None:
    piece = Furniture(drawn("bookshelf")).moved()
    known = utilisation_range(piece, Compliance())
    row = next(iter(make_replay(SCENES / "bookshelf.toml", overrides=["effects.guidance.suggestions=0"]).frames()))
    listed = json.loads(row["redundant"])
    assert len(row["redundant"]) <= 160 and [name for name, _, _ in listed] == [
        name for name, _, _ in recorded_utilisations(piece, known, len(listed))
    ]
    assert row["redundant_count"] == len(known.redundant) == 30 > len(listed) > 1
    guidance.print_guidance([row])
    assert f"and {30 - len(listed)} more" in capsys.readouterr().out


def test_a_range_is_marked_where_compliances_decide() -> None:
    # The table's first leg, moved along its width: it depends on joints nearly wherever it holds.
    design = Design(drawn("table"), Guidance())
    way = design.parameter(1, 1)
    (first, second), doubtful = way.ranges.intervals.tolist(), way.doubtful
    assert doubtful[0] == pytest.approx(first) and second[0] < doubtful[1][0] < doubtful[1][1] == second[1]
    sure = 0.5 * (second[0] + doubtful[1][0])
    for t, depend in ((0.5 * sum(first), True), (sure, False), (0.5 * sum(doubtful[1]), True)):
        assert bool(depends(design.furniture.moved(t * way.direction))) == depend


def test_models_of_a_piece_decide_as_the_models_of_each_change_of_it_do() -> None:
    piece = drawn("table")
    furniture = Furniture(piece)
    models, gamma, said = ComplianceModels(furniture), np.zeros((len(piece.planks), 8)), []
    for turn in np.linspace(0.07, 0.2, 8):
        gamma[piece.index("leg-4"), 4] = turn
        said.append(models.decide(gamma))
        assert said[-1] == bool(depends(furniture.moved(gamma)))
    assert True in said and False in said
    # Compliances that decided are tried first from then on, which changes no answer.
    for turn, before in zip(np.linspace(0.2, 0.07, 8), reversed(said)):
        gamma[piece.index("leg-4"), 4] = turn
        assert models.decide(gamma) == before


def test_neighbours_along_a_way_are_decided_in_few_steps_and_alike() -> None:
    # The contacts of the place before are nearly those of the next one.
    piece = drawn("table")
    furniture, gamma, leg = Furniture(piece), np.zeros((len(piece.planks), 8)), piece.index("leg-4")
    near, rest, answers = ComplianceModels(furniture), ComplianceModels(furniture), []
    for gamma[leg, 4] in np.linspace(0.07, 0.2, 27):
        rest.forget()
        answers.append((near.decide(gamma), rest.decide(gamma)))
    assert all(one == other for one, other in answers) and len({one for one, _ in answers}) == 2
    assert near._springs.steps < 0.7 * rest._springs.steps
    # Nothing is left of the places before once they are forgotten.
    near.forget()
    before = near._springs.steps
    near.decide(gamma)
    rest.forget()
    of_rest = rest._springs.steps
    rest.decide(gamma)
    assert near._springs.steps - before == rest._springs.steps - of_rest
