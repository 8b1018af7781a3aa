"""Prices: what has been put into the times of frames comes out again, and shares sum to one."""

from pathlib import Path

import numpy as np
import pytest
from restshape_studies.commands.explain import _line
from restshape_studies.explain.filled import of_kernels
from restshape_studies.explain.price import OVERLAP, prices
from restshape_studies.explain.variants import ALONE, Difference, Variants, variants
from small_scenes import plate, write_scene

from restshape.application import application_of
from restshape.scene.load import load_scene
from restshape.scene.plan import plan

SCENES = Path(__file__).parents[2] / "scenes"
NONE = frozenset()
FRAMES = 12
EDIT, MESH, OBSERVED, RECORD, SOLVE = 0.1, 0.4, 0.2, 0.3, 1.0
EFFECTS = {"a": 0.5, "b": 0.25, "c": 0.0}
TOTAL = EDIT + MESH + OBSERVED + RECORD + SOLVE + sum(EFFECTS.values())
TRIED = Variants(
    (NONE, *(frozenset([name]) for name in EFFECTS)),
    {name: Difference(NONE, frozenset([name])) for name in EFFECTS},
    {},
    NONE,
    {},
)


def frame(variant, index, left_out, slow, rng):
    """A row of a frame whose effects cost what `EFFECTS` says, on a machine that has slow spells."""
    spell = slow * rng.exponential() if rng.random() < 0.3 else 0.0
    solve = SOLVE + sum(ms for name, ms in EFFECTS.items() if name not in left_out) + spell
    calls = {"core": {"tangent": (2, 200)}} | {name: {"residual": (2, 80)} for name in EFFECTS if name not in left_out}
    return {
        "variant": variant,
        "index": index,
        "level": 1,
        "iterations": 1,
        "unknowns": 100 + (0 if "a" in left_out else 40),
        "elements": 50,
        "entries": 1000 + (0 if "a" in left_out else 300),
        "filled": {"core": 800, "own core": 200} | ({} if "a" in left_out else {"a": 300}),
        "calls": calls,
        "calls_beside": {"core": {"stress": (1, 50)}},
        "ms": EDIT + MESH + OBSERVED + RECORD + solve + (100.0 if index == 0 else 0.0),
        "ms_edit": EDIT,
        "ms_relocate": MESH / 4,
        "ms_map": MESH / 4,
        "ms_flip": MESH / 4,
        "ms_mesh": MESH / 4,
        "ms_observe": OBSERVED,
        "ms_estimate": RECORD / 2,
        "ms_record": RECORD / 2,
    }


def runs(number, slow):
    """Rows of several runs."""
    rng = np.random.default_rng(3)
    return [
        [frame(k, index, names, slow, rng) for index in range(FRAMES) for k, names in enumerate((*TRIED.sets, NONE))]
        for _ in range(number)
    ]


@pytest.mark.parametrize(("number", "slow", "error"), [(1, 0.0, 1e-12), (5, 2.0, 0.01)])
def test_shares_are_what_was_put_in_and_sum_to_one(number, slow, error):
    found = prices(runs(number, slow), TRIED)
    assert found.frames == FRAMES - 1
    assert sum(found.shares.values()) == pytest.approx(1.0, abs=1e-12)
    for name, ms in {
        **EFFECTS,
        "edit": EDIT,
        "mesh": MESH,
        "observation": OBSERVED,
        "record": RECORD,
        "": SOLVE,
    }.items():
        assert found.shares[name] == pytest.approx(ms / TOTAL, abs=max(error, 2.0 * found.spreads[name]))
    assert found.ms == pytest.approx(TOTAL, rel=10 * error)


def test_what_effects_take_from_each_other_leaves_no_negative_rest():
    """Without a the work of b is not done either, nor that of a without b: both have it in their price."""
    rows = runs(1, 0.0)[0]
    for row in rows:
        row["ms"] -= 1.2 * SOLVE * (row["variant"] in (1, 2))
    assert prices([rows], TRIED).shares[""] < -0.1
    core = {"effect": "core", "kind": "named", "on": True, "why": "always", "calls": 3, "solver": {}}
    numbers = {"unknowns": 9, "elements": 9, "entries": 9, "share": -0.5, "spread": 0.1}
    assert _line({**core, **numbers, "how": OVERLAP})[-2:] == ["-", f"always ({OVERLAP})"]
    assert _line({**core, **numbers, "how": "all that is left"})[-2] == "-50.0 ± 10.0 %"


def test_a_rest_that_is_below_nothing_by_the_clock_alone_is_none():
    rows = runs(2, 0.0)
    for row in rows[0]:
        # In one of two runs less is observed without a, and without b: together more than there is.
        less = 0.75 * OBSERVED * (row["variant"] in (1, 2))
        row["ms"], row["ms_observe"] = row["ms"] - less, row["ms_observe"] - less
    found = prices(rows, TRIED)
    assert found.shares["observation"] == 0.0 and found.spreads["observation"] > 0.0
    assert found.shares[""] == pytest.approx((SOLVE - 0.5 * OBSERVED) / TOTAL) and sum(
        found.shares.values()
    ) == pytest.approx(1.0, abs=1e-12)


def test_counts_are_differences_and_the_rest_is_always_there():
    found = prices(runs(1, 0.0), TRIED)
    frames = FRAMES - 1
    assert found.counts["a"].unknowns == 40 and found.counts["a"].entries == 300
    assert found.counts["a"].filled == {"a": 300}
    assert found.counts["b"].calls == {"b": {"residual": [2 * frames, 80 * frames]}}
    assert found.counts["b"].elements == 40
    rest = found.counts[""]
    assert (rest.unknowns, rest.elements, rest.entries) == (100, 50, 1000)
    assert rest.filled == {"core": 800, "own core": 200}
    assert rest.calls == {"core": {"tangent": [2 * frames, 200 * frames]}}
    assert found.beside == {"core": {"stress": [frames, 50 * frames]}}


def test_a_matrix_is_that_of_an_effect_only_where_no_other_kernel_fills_it():
    filled = {"mass_tri3": 5, "lumped_mass_tri3 mass_tri3": 7, "linear_elastic_tri3 mass_tri3": 100, "": 1000}
    assert of_kernels(filled, ("mass_", "lumped_mass_")) == 12
    assert of_kernels(filled, ("mass_",)) == 5
    assert of_kernels(filled, ()) == 0


def test_an_effect_without_which_there_is_no_answer_has_no_price():
    rows = [row for row in runs(1, 0.0)[0] if row["variant"] != 2]
    rows.insert(1, {"variant": 2, "problem": "nothing holds the body"})
    found = prices([rows], TRIED)
    assert "b" not in found.counts and found.problems == {"b": "not determined: without it nothing holds the body"}
    assert sum(found.shares.values()) == pytest.approx(1.0, abs=1e-12)
    assert found.shares[""] == pytest.approx((SOLVE + EFFECTS["b"]) / TOTAL)


def test_a_solution_that_takes_longer_to_find_without_an_effect_says_nothing_of_it():
    rows = runs(1, 0.0)[0]
    for row in rows:
        # Without b the way is ten times as long.
        row["ms"] += 9.0 * TOTAL * (row["variant"] == 2)
    found = prices([rows], TRIED, nonlinear=True)
    assert "another state is found" in found.problems["b"] and "b" not in found.shares and "b" not in found.counts
    assert sum(found.shares.values()) == pytest.approx(1.0, abs=1e-12)
    assert found.shares["a"] == pytest.approx(EFFECTS["a"] / TOTAL)
    assert found.shares[""] == pytest.approx((SOLVE + EFFECTS["b"]) / TOTAL)
    # Of linear equations that is noise of the clock.
    assert "b" in prices([rows], TRIED).counts


def test_frames_in_which_an_edit_is_refused_in_one_replay_alone_do_not_count():
    rows = runs(1, 0.0)[0]
    for row in rows:
        # Without b nothing is done in the last half of the frames, which costs next to nothing.
        if row["variant"] == 2 and row["index"] >= FRAMES // 2:
            row |= {"refused": "no suggestion is chosen", "level": 0, "iterations": 0, "ms": MESH + OBSERVED + EDIT}
    found = prices([rows], TRIED)
    assert found.frames == FRAMES // 2 - 1
    assert found.shares["b"] == pytest.approx(EFFECTS["b"] / TOTAL)


def tried(path):
    """The variants of a scene."""
    scene = load_scene(path)
    app = application_of(scene)
    return variants(plan(scene, app), app)


def test_what_hangs_on_an_effect_goes_with_it_and_the_last_load_stays(tmp_path):
    found = tried(SCENES / "beam.toml")
    assert found.differences["following_pressure"] == Difference(NONE, frozenset(["following_pressure"]))
    assert set(found.differences) == {"gravity", "following_pressure", "stresses"}
    strip = tried(SCENES / "strip.toml")
    assert strip.kept["gravity"] == ALONE and "gravity" in strip.alone
    pushed = '[effects.large_deformation]\n[loads.push]\non = "right"\npressure = "1 MPa"\n'
    both = tried(write_scene(tmp_path, plate() + pushed))
    pressed = frozenset(["following_pressure"])
    assert both.differences["large_deformation"] == Difference(pressed, pressed | {"large_deformation"})


def test_where_another_state_is_found_a_newton_step_with_and_without_the_effect_is_compared():
    """Two steps with b, of 0.5 (SOLVE + a + b) each, and twenty without it, of half of (SOLVE + a)."""
    rows, step = runs(1, 0.0)[0], 0.5 * (SOLVE + EFFECTS["a"])
    for row in rows:
        row["newton"] = 20 if row["variant"] == 2 else 2
        row["ms"] += 18 * step * (row["variant"] == 2)
    found = prices([rows], TRIED, nonlinear=True)
    assert found.by_step == {"b"} and "b" not in found.problems and "b" not in found.counts
    assert found.shares["b"] == pytest.approx(EFFECTS["b"] / TOTAL)
    assert sum(found.shares.values()) == pytest.approx(1.0, abs=1e-12)


def test_runs_of_unequal_length_are_priced_by_the_frames_that_all_have():
    long, short = runs(2, 0.0)
    found = prices([long, [row for row in short if row["index"] < 6]], TRIED)
    assert found.frames == 5 and found.shares["a"] == pytest.approx(EFFECTS["a"] / TOTAL)
