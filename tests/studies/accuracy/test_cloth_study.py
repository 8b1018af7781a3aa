"""Errors of cloth: distances beside closed forms, and a small study of a strip whose tip is known."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from restshape_studies.accuracy import reference
from restshape_studies.accuracy.distance import Reference
from restshape_studies.accuracy.facts import compared_values
from restshape_studies.accuracy.grid import Grid
from restshape_studies.accuracy.replays import measure
from restshape_studies.accuracy.setting import Choice
from restshape_studies.accuracy.state import State
from restshape_studies.accuracy.study import Asked, Case, study
from restshape_studies.bench.job import Outcome
from restshape_studies.bench.process import request
from small_scenes import write_script

from restshape.errors import UserError
from restshape.scene.load import load_scene, revise

STRIP = Path(__file__).parents[2] / "scenes" / "cloth_strip.toml"
C, D = np.diag([300.0, 200.0, 50.0]), np.diag([3e-5, 2e-5, 1e-5])
NONE = np.empty(0)


def sheet(places, curvature):
    """Cloth on two triangles of a unit square, with its corners at `places` (4, 3), curved alike everywhere."""
    X = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    grid = Grid(X, np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32), np.zeros(2))
    u = places - np.column_stack([X, np.zeros(4)])
    stiffness, bent = np.tile([C, D], (2, 1, 1, 1)), np.tile(curvature, (2, 1, 1))
    none = np.empty((0, 4, 3))
    return State(grid, np.zeros((4, 2)), u, None, "", NONE, none, None, True, {"q_a": 1.0}, bent, stiffness)


FLAT = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]])


def test_distances_of_sheets_are_those_of_strains_and_curvatures():
    curved = np.zeros((3, 3))
    curved[2] = [4.0, 1.0, 2.0]
    held = Reference.of(sheet(FLAT * (1.2, 1.0, 1.0), curved))
    less = curved.copy()
    less[2] = [3.0, 1.0, 2.0]
    found = held.distances(held.solution, held.sampled(sheet(FLAT * (1.1, 1.0, 1.0), less)))
    # Green's strain of a stretch s is (s^2 - 1)/2.
    apart = 300.0 * (0.22 - 0.105) ** 2 + 3e-5
    whole = 300.0 * 0.22**2 + 3e-5 * 16.0 + 2e-5 + 1e-5 * 4.0
    assert list(found) == ["strain", "l2"] and found["strain"] == pytest.approx(np.sqrt(apart / whole), rel=1e-12)


def test_turns_in_space_are_no_error_of_strains():
    tilt = np.array([[0.6, 0.0, -0.8], [0.0, 1.0, 0.0], [0.8, 0.0, 0.6]])
    stretched = FLAT * (1.2, 1.0, 1.0)
    held = Reference.of(sheet(stretched, np.zeros((3, 3))))
    found = held.distances(held.solution, held.sampled(sheet(stretched @ tilt.T, np.zeros((3, 3)))))
    assert found["strain"] < 1e-12 and found["l2"] > 0.5


def test_a_reference_of_cloth_survives_its_file(tmp_path):
    held = Reference.of(sheet(FLAT, np.ones((3, 3))))
    held.save(tmp_path / "0.npz")
    again = Reference.load(tmp_path / "0.npz")
    assert np.array_equal(again.sheet, held.sheet) and again.solution.u.shape == (2, 3)
    assert np.array_equal(again.solution.curvature, held.solution.curvature)


def play(job, seconds):
    """What a job reports, run here."""
    return Outcome([], found=json.loads(json.dumps(measure(request(job), **job.details))))


def afford(patch, unknowns: float) -> None:
    """Let a reference have so many unknowns."""
    usual = reference.scale_of
    patch.setattr(reference, "scale_of", lambda *args: replace(usual(*args), reference=unknowns))


@pytest.fixture(scope="module")
def strip(tmp_path_factory):
    """A study of the strip, coarse, while its fabric grows softer."""
    edits = write_script(
        tmp_path_factory.mktemp("strip"),
        [{"do": "set", "key": "material.canvas.bending", "value": "3e-5 N m", "frames": 3}],
    )
    choice = Choice((3.0, 2.0), (1,), (1e-2,), ("auto", "rebuild"))
    with pytest.MonkeyPatch.context() as patch:
        afford(patch, 5e3)
        return study(Case("strip", STRIP, edits), Asked(choice, samples=2), lambda words: None, play)


@pytest.mark.slow
def test_all_ways_of_bending_are_held_against_morleys_triangles(strip):
    assert strip.measure == "strain" and strip.plan.turned["effects.cloth.bending"] == "morley"
    assert not strip.omissions and not any(record["problem"] for record in strip.records)
    by = {(r["given"], r["size_factor"]): r["error"] for r in strip.records if r["policy"] == "auto"}
    for kind in ("hinge", "nonlinear"):
        assert by[kind, 2.0] > by[None, 2.0]
    # Two thirds of the size, and about two thirds of the error: Morley's triangles are of first order.
    assert by[None, 2.0] / by[None, 3.0] == pytest.approx(2.0 / 3.0, abs=0.2)
    # The clock of a busy machine shows nothing: let a frame take as long as it has triangles.
    timed = replace(strip, records=[r | {"frame_ms": 1e-2 * r["elements"]} for r in strip.records])
    (key, finest), *_ = compared_values(timed)
    assert key == "effects.cloth.bending, finest meshes"
    assert finest.startswith("morley ") and "hinge " in finest and "nonlinear " in finest


def test_reuse_and_the_tolerance_leave_next_to_nothing(strip):
    assert all(record["reuse_holds"] for record in strip.records)
    loose = next(record for record in strip.records if record["varied"] == "solve.tolerance")
    assert loose["tolerance"] == 1e-2 and loose["parts"]["algebraic"] < 1e-2


def test_the_tip_is_counted_from_the_heavy_elastica(strip):
    # The ordinary differential equation of an inextensible strip, w L^3/D = 8, hangs by 0.640631 L.
    assert strip.truth.values["0"]["tip_down"] == pytest.approx(-0.640631 * 0.05, rel=3e-3)
    assert all(0.5 < r["effectivity"]["median"] < 2.0 for r in strip.records)


@pytest.mark.parametrize(
    ("sizes", "affordable", "coarser"), [((2.0, 1.0), 4e6, False), ((1.0, 0.25), 4e6, True), ((1.0, 0.25), 4e4, False)]
)
def test_a_reference_that_is_not_finished_asks_for_what_differs(tmp_path, monkeypatch, sizes, affordable, coarser):
    events = [{"do": "set", "key": "material.canvas.bending", "value": "3e-5 N m", "frames": 3}]
    asked = Asked(Choice(sizes, (1,), (1e-2,), ("auto",)), frames=4, samples=2, reference_seconds=20.0)
    case = Case("strip", STRIP, write_script(tmp_path, events))
    afford(monkeypatch, affordable)

    def refused(problem):
        with pytest.raises(UserError) as reported:
            study(case, asked, lambda words: None, lambda job, seconds: Outcome([], problem))
        return reported.value

    late = refused("stopped after 20 s")
    assert late.what == "the reference was not finished after 20 s (--reference-seconds)"
    assert "--frames 2" in late.do and "--reference-seconds 60" in late.do
    # of no use where they are given, nor where the reference is as fine as is affordable with them or without
    assert ("--sizes 2,1" in late.do) is coarser
    torn = refused("frame 2: the mesh is torn")
    assert "no solution: frame 2: the mesh is torn" in torn.what and "--reference-seconds" not in torn.do


def test_the_tolerance_of_rest_is_that_of_the_solver():
    plain = load_scene(STRIP)
    assert plain.solve.tolerance == 1e-4
    assert load_scene(STRIP, ("effects.drape.tolerance=1e-6",)).solve.tolerance == 1e-6
    assert revise(plain, "effects.drape.tolerance", 1e-5).solve.tolerance == 1e-5
    assert revise(plain, "solve.tolerance", 1e-5).solve.tolerance == 1e-5
    with pytest.raises(UserError, match="both are one number"):
        load_scene(STRIP, ("effects.drape.tolerance=1e-6", "solve.tolerance=1e-5"))
