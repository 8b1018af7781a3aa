"""Drapes of cloth with darts: their derivative by a dart's width, and frames that go on from the last mesh."""

import json

import numpy as np
import pytest
from drape_designs import HELD, DrapeDesign, sheet
from small_scenes import make_replay, rows_of, write_scene, write_script

from restshape.replay.parity import Parity
from restshape.scene.load import revise
from restshape.shape.build import outline_from_spec

DART = '[darts.dart]\nedge = "right"\nlength = 0.08\nwidth = 0.03\n'
QUANTITIES = '[quantities]\nlowest = { position = "z", reduce = "min" }\npotential = { energy = "potential" }\n'
WIDER = [{"t": 0, "do": "set", "key": "darts.dart.width", "value": 0.04, "frames": 2}]


def moved_by_width(design: DrapeDesign) -> np.ndarray:
    """Rates (n, 2) of the mesh's nodes as the dart gets wider: on edges those of the outline, inside none."""
    mesh, width, h = design.analysis.space, design.scene.darts["dart"].width, 1e-5
    ends = [outline_from_spec(revise(design.scene, "darts.dart.width", width + s * h).shape).points for s in (1, -1)]
    rates, out = (ends[0] - ends[1]) / (2 * h), np.zeros_like(mesh.X)
    for edge in range(len(mesh.outline.edges)):
        on = np.unique(mesh.facets[mesh.facet_edge == edge])
        way = mesh.outline.point(edge, np.array([0.0, 1.0]))
        share = (mesh.X[on] - way[0]) @ (way[1] - way[0]) / np.sum((way[1] - way[0]) ** 2)
        out[on] = mesh.outline.point(edge, share, rates)
    return out


def test_the_remainder_of_the_derivative_by_the_width_is_of_second_order(tmp_path):
    design = DrapeDesign(tmp_path, sheet("hinge", HELD, DART, size=0.06))
    dX = moved_by_width(design)
    assert np.abs(dX).max() == pytest.approx(0.5, rel=1e-6)
    first, second = design.remainders(dX, 1e-3)
    assert second > 1e-10, "nothing to compare with"
    assert 1.8 < np.log2(first / second) < 2.2


def test_a_wider_dart_keeps_the_mesh_and_rests_as_when_solved_again(tmp_path):
    scene, script = (
        write_scene(tmp_path, sheet("hinge", HELD, DART, QUANTITIES, size=0.05)),
        write_script(tmp_path, WIDER),
    )
    reused, rebuilt = (make_replay(scene, script, name=name) for name in ("auto", "rebuild"))
    check = Parity(reused)
    rows = rows_of(reused, lambda row: row.update(check()))
    assert [row["level"] for row in rows[1:]] == [1, 1] and all(row["converged"] for row in rows)
    # One mesh, one rest: forces, positions and energies of a cold solve.
    found = check.summary()
    assert found["holds"] and found["entries"] < 1e-12 and found["solution"] < 1e-8, found
    # Another mesh, with its own nodes inside: the energy is that of the same cloth.
    again = rows_of(rebuilt)
    assert rows[-1]["q_potential"] == pytest.approx(again[-1]["q_potential"], rel=2e-3)
    areas = [replay.analysis.problem.lumped.area.sum() for replay in (reused, rebuilt)]
    assert areas == pytest.approx([0.2**2 - 0.5 * 0.04 * 0.08] * 2, rel=1e-12)


@pytest.mark.mpi
@pytest.mark.parametrize("folded", ["", pytest.param("folded = true\n", marks=pytest.mark.weekly)])
def test_two_ranks_rest_as_one(tmp_path, on_ranks, folded):
    # Without friction and layers, so that there is one rest.
    text = sheet("hinge", HELD, DART + folded, QUANTITIES, size=0.1) + "\n[effects.contact]\nself = false\n"
    scene, script = write_scene(tmp_path, text), write_script(tmp_path, WIDER)
    found = []
    for ranks in (1, 2):
        done = on_ranks(ranks, "replay", scene, "--edits", script, "--json", f"{ranks}.json")
        assert done.returncode == 0, done.stderr
        found.append(json.loads((tmp_path / f"{ranks}.json").read_text()))
    one, two = found
    assert (one["ranks"], two["ranks"], two["refused"]) == (1, 2, 0) and one["levels"] == two["levels"]
    for name, values in one["quantities"].items():
        np.testing.assert_allclose(two["quantities"][name], values, rtol=1e-6, err_msg=name)
