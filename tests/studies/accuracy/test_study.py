"""Studies of small scenes, in this process: known rates, parts that sum, closed forms."""

import json
import weakref
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from restshape_studies.accuracy import reference as study_reference
from restshape_studies.accuracy.facts import reuse_fact, solver_fact
from restshape_studies.accuracy.front import finite, rates
from restshape_studies.accuracy.replays import measure
from restshape_studies.accuracy.setting import Choice
from restshape_studies.accuracy.study import Asked, Case, study
from restshape_studies.bench.job import Job, Outcome
from restshape_studies.bench.process import request
from small_scenes import HEAD, across, block, drag, head, meshed, plate, write_scene, write_script

from restshape.algebra.operator import Operator

MATERIAL = '[material.unit]\nE = 2.5\nnu = 0.25\n[effects.solid]\nmodel = "plane_strain"\n'
HELD = '[supports.round]\non = "outline"\nfix = { x = 0, y = 0 }\n'
BODY = """[loads.body]
on = "all"
body = [
  "1e-3*(4*pi^2*sin(pi*x)*sin(pi*y) - 2*(1 - 2*x)*(1 - 2*y))",
  "1e-3*(6*x*(1 - x) + 2*y*(1 - y) - 2*pi^2*cos(pi*x)*cos(pi*y))",
]
"""
KEYS = ["size", "order", "policy", "tolerance", "error", "parts", "frame_ms", "total_s", "pareto"]


def play(job: Job, seconds: float) -> Outcome:
    """What a job reports, run here."""
    reported = json.loads(json.dumps(measure(request(job), **job.details)))
    return Outcome([], found=reported)


def energy() -> float:
    """Strain energy of the manufactured solution on the unit square: half the work of its body force, by Gauss."""
    s, w = np.polynomial.legendre.leggauss(40)
    (x, y), weight = np.meshgrid(0.5 * (s + 1.0), 0.5 * (s + 1.0)), 0.25 * np.outer(w, w)
    sine, cosine = np.sin(np.pi * x) * np.sin(np.pi * y), np.cos(np.pi * x) * np.cos(np.pi * y)
    bx = 4 * np.pi**2 * sine - 2 * (1 - 2 * x) * (1 - 2 * y)
    by = 6 * x * (1 - x) + 2 * y * (1 - y) - 2 * np.pi**2 * cosine
    return float(0.5e-6 * (weight * (bx * sine + by * x * y * (1 - x) * (1 - y))).sum())


def case(folder: Path, text: str, events: list) -> Case:
    """A scene and its script."""
    return Case("small", write_scene(folder, text), write_script(folder, events))


@pytest.fixture(scope="module")
def manufactured(tmp_path_factory):
    """A square with a known solution, whose corner is dragged a little."""
    quantity = (
        f'[quantities]\nenergy = {{ energy = "strain", reference = "S*2" }}\n[parameters]\nS = {energy() / 2!r}\n'
    )
    text = HEAD + block() + MATERIAL + HELD + BODY + meshed(0.1) + quantity
    events = drag("c", (1.0, 1.0), [(1.01 + 0.01 * k, 1.0) for k in range(4)])
    choice = Choice((2.0, 1.41, 1.0), (1, 2), (1e-3,), ("refactor", "auto"))
    asked = Asked(choice, samples=3)
    return study(case(tmp_path_factory.mktemp("study"), text, events), asked, lambda words: None, play)


@pytest.mark.slow
def test_errors_fall_at_the_rates_of_the_elements(manufactured):
    found = rates(manufactured.records, "auto")
    # Degree p: h^p in the energy norm, h^(p + 1) in L2, h^2p in the energy.
    for order in (1, 2):
        assert found["energy"][str(order)] == pytest.approx(order, abs=0.35)
        assert found["l2"][str(order)] == pytest.approx(order + 1, abs=0.5)
        assert found["q_energy"][str(order)] == pytest.approx(2 * order, abs=0.8)


def test_a_closed_form_is_what_the_first_frame_is_counted_from(manufactured):
    exact = energy()
    assert manufactured.truth.values["0"]["energy"] == pytest.approx(exact, rel=1e-5)
    for record in manufactured.records:
        held = record["quantities"]["energy"]
        value = record["frames"][0]["quantities"]["energy"]
        scale = manufactured.truth.scale("energy")
        assert held["exact"] == pytest.approx(exact) and held["first"] == pytest.approx(abs(value - exact) / scale)
    assert manufactured.frames[0] == 0 and len(manufactured.frames) == 3


def test_the_parts_telescope(manufactured):
    for record in manufactured.records:
        for frame in record["frames"]:
            for measure_of, parts in frame["parts"].items():
                d, r, a = (parts[name] for name in ("discretisation", "reuse", "algebraic"))
                assert abs(d - r - a) * (1 - 1e-9) - 1e-14 <= frame["errors"][measure_of] <= (d + r + a) * (1 + 1e-9)
            signed = frame["quantity_parts"]["energy"]
            true = manufactured.truth.values[str(frame["index"])]["energy"]
            assert sum(signed.values()) == pytest.approx(
                true - frame["quantities"]["energy"], abs=1e-15 * abs(true) * 10
            )


def test_a_looser_tolerance_shows_in_the_algebraic_part_alone(manufactured):
    loose = next(record for record in manufactured.records if record["varied"] == "solve.tolerance")
    like = {key: loose[key] for key in ("size_factor", "order", "policy")}
    own = next(r for r in manufactured.records if not r["varied"] and like.items() <= r.items())
    assert loose["tolerance"] == 1e-3 and own["tolerance"] == 1e-6
    assert loose["parts"]["algebraic"] > 3.0 * own["parts"]["algebraic"]
    share = max((r["parts"]["algebraic"] + r["parts"]["reuse"]) / r["tolerance"] for r in manufactured.records)
    assert solver_fact(manufactured) == f"at most {share:.2g}"
    assert loose["parts"]["discretisation"] == pytest.approx(own["parts"]["discretisation"], rel=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("fault", [False, True])
def test_a_matrix_that_is_kept_though_the_nodes_have_moved_is_a_failure_of_reuse(tmp_path, monkeypatch, fault):
    assemble, kept = Operator.assemble, weakref.WeakKeyDictionary()

    def stale(self, terms, rhs):
        mat = assemble(self, terms, rhs)
        if self not in kept:
            kept[self] = mat.duplicate(copy=True)
        elif kept[self].getSize() == mat.getSize():
            kept[self].copy(mat)
        return mat

    if fault:
        monkeypatch.setattr(Operator, "assemble", stale)
    small = case(tmp_path, plate(0.2), drag("window", (0.5, 0.5), across((0.5, 0.5), (0.56, 0.5), 4)))
    asked = Asked(Choice((1.0,), (1,), (1e-7,), ("auto", "refactor")), samples=3)
    found = study(small, asked, lambda words: None, play)
    assert [record["reuse_holds"] for record in found.records] == [not fault] * len(found.records)
    for record in found.records:
        assert (record["parts"]["reuse"] > 0.01) == fault
        # The plain discretisation error of these meshes, whatever was kept.
        assert record["parts"]["discretisation"] == pytest.approx(0.149, abs=0.003)
    assert reuse_fact(found).startswith("FAILURE at " if fault else "at all 3 points")


def test_records_have_the_keys_that_programs_want(manufactured):
    assert len(manufactured.records) == 2 * 3 * 2 + 1 and not manufactured.omissions
    for record in finite(manufactured.records):
        assert set(KEYS) <= set(record) and set(record["parts"]) == {"discretisation", "algebraic", "reuse"}
        assert record["reuse_holds"] is True and record["frame_ms"] > 0.0 and record["total_s"] > 0.0
        assert record["problem"] == "" and record["error"] >= record["error_median"] > 0.0
    json.dumps(finite(manufactured.records), allow_nan=False)
    assert manufactured.uncertainty < min(record["error"] for record in manufactured.records)


@pytest.mark.slow
def test_motion_is_compared_with_finer_steps_and_keeps_its_frames_in_time(tmp_path):
    text = head("moving") + block(1.0, 2.0)
    text += '[material.rubber]\nE = "2 MPa"\nnu = 0.3\nrho = 1000\nthickness = 0.1\n'
    text += '[supports.foot]\non = "bottom"\nfix = ["x", "y"]\n[effects.dynamics]\ntime_step = 0.04\nsteps = 4\n'
    text += "[effects.ground]\nacceleration = 3.0\nfrequency = 4.0\n" + meshed(0.25, 2)
    events = drag("c", (1.0, 2.0), [(1.02, 2.0), (1.04, 2.0), (1.06, 2.0)])
    choice = Choice((1.0,), (2,), None, ("auto",))
    found = study(case(tmp_path, text, events), Asked(choice, samples=2), lambda words: None, play)
    assert found.plan.policy == "refactor" and found.plan.turned["effects.dynamics.steps"] == "16"
    by_step = {r["given"]: r for r in found.records if r["varied"] == "effects.dynamics.time_step"}
    own = next(record for record in found.records if not record["varied"])
    assert own["measure"] == "motion" and set(by_step) == {0.08, 0.02}
    # Newmark's method is of second order: half the step, a quarter of its part of the error.
    assert by_step[0.02]["error"] < 0.5 * own["error"] < 0.4 * by_step[0.08]["error"]
    lumped = next(record for record in found.records if record["given"] == "lumped")
    assert lumped["error"] is not None and 0 not in found.frames


@pytest.mark.slow
def test_modes_of_a_bar_are_compared_with_layers_of_second_order(tmp_path, monkeypatch):
    usual = study_reference.scale_of
    monkeypatch.setattr(study_reference, "scale_of", lambda *args: replace(usual(*args), reference=3e3))
    folder = Path(__file__).parents[2] / "scenes"
    edits = write_script(tmp_path, drag("c", (0.1, 0.03), [(0.101, 0.03), (0.102, 0.03)]))
    given = ('mesh.size="12 mm"', "mesh.layers=1", "mesh.order=2")
    bar = Case("bar", folder / "bar_100.toml", edits, given)
    choice = Choice((1.0,), (2,), (1e-4,), ("auto", "thesis"))
    found = study(bar, Asked(choice, samples=2), lambda words: None, play)
    assert found.measure == "frequencies" and found.plan.turned["mesh.layers"] == "2"
    plain = next(record for record in found.records if record["policy"] == "auto" and not record["varied"])
    # p-FEM of three-dimensional elasticity: the lowest mode of this bar has 2089.35 Hz.
    reference = found.truth.values["0"]["pitch"]
    assert (
        reference == pytest.approx(2089.35, rel=5e-3)
        and abs(plain["frames"][0]["quantities"]["pitch"] / 2089.35 - 1) < 0.03
    )
    assert all(record["reuse_holds"] is True for record in found.records)
    plates = [record for record in found.records if record["given"] == "plate"]
    assert len(plates) == 1 and plates[0]["order"] == 1 and "plates" in found.omissions[0].why
