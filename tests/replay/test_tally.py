"""What a summary reports is exact, but for quantiles of many frames, and takes memory that does not grow with them."""

import tracemalloc

import numpy as np
import pytest

from restshape.cli.replay import _print_reasons
from restshape.replay.columns import STAGES
from restshape.replay.reservoir import SIZE, Reservoir
from restshape.replay.summary import summarise
from restshape.replay.tally import Tally


def make_row(index: int, rng: np.random.Generator) -> dict:
    """A row of a frame, with numbers drawn at random."""
    level = int(rng.integers(4))
    stages = {f"ms_{name}": float(rng.random()) for name in STAGES}
    return {
        **{"index": index, "line": index // 2, "level": level, "iterations": int(rng.integers(3)), "newton": 1},
        **{
            "pc_rebuilt": int(rng.integers(2)),
            "unknowns": 10 + index,
            "elements": 5 + index,
            "ms": float(rng.random()),
        },
        **{"predicted": int(rng.integers(2)), "residual": float(rng.random()), "ms_python": float(rng.random())},
        **{"estimate": float(rng.random()) if level else np.nan, "estimate_time": np.nan, "prediction_error": np.nan},
        **{"preconditioner": f"p{level}", "refused": "no" if rng.random() < 0.1 else "", "note": f"note {index % 7}"},
        **{"constraint_status": ("", "holds", "fails")[index % 3], "violated_constraints": f"v{index}"},
        **{"converged": int(rng.integers(-1, 2)), "tangent_positive_definite": 1, "q_sag": float(rng.random())},
        **stages,
    }


def test_up_to_as_many_as_are_kept_all_is_exact():
    rng = np.random.default_rng(0)
    rows = [make_row(i, rng) for i in range(500)]
    found, later = summarise(rows, "auto", 1, "u"), rows[1:]
    level = np.array([row["level"] for row in later])
    times = np.array([row["ms"] for row in later])
    for name, chosen in {"all": level > 0, "1": level == 1, "2": level == 2, "3": level == 3}.items():
        assert list(found["ms"][name].values()) == pytest.approx(np.percentile(times[chosen], (50, 95, 99)), rel=1e-14)
    assert found["levels"] == {str(k): int((level == k).sum()) for k in (1, 2, 3)}
    stopped = np.array([bool(row["refused"]) for row in later])
    assert stopped[level == 0].any() and found["idle"] == int((~stopped[level == 0]).sum())
    assert found["predicted"] == sum(row["predicted"] for row in later)
    assert found["iterations"] == sum(row["iterations"] for row in rows)
    for key, column in {"iterations_by_level": "iterations", "refreshes_by_level": "pc_rebuilt"}.items():
        totals = {str(k or "still"): sum(row[column] for row in later if row["level"] == k) for k in range(4)}
        assert found[key] == totals
    assert found["refused"] == sum(bool(row["refused"]) for row in rows)
    assert found["stages"]["krylov"] == pytest.approx(sum(row["ms_krylov"] for row in rows))
    assert found["quantities"] == {"sag": [row["q_sag"] for row in rows]}
    solved = [row["estimate"] for row in rows if not row["predicted"] and np.isfinite(row["estimate"])]
    assert found["estimate"] == {"p50": pytest.approx(np.median(solved)), "max": max(solved), "of": "u"}
    assert found["estimate_time"] == {"p50": None, "max": None}
    holds = sum(row["constraint_status"] == "holds" for row in rows)
    assert found["constraint_status"]["holds"] == holds and found["constraint_status"]["violated_constraints"] == "v499"
    judged = [row for row in rows if row["converged"] >= 0 and not row["refused"]]
    assert found["rest"]["converged"] == sum(row["converged"] for row in judged)
    assert found["rest"]["residual"] == max(row["residual"] for row in judged)
    assert (found["unknowns"], found["elements"]) == (509, 504)


def test_quantiles_of_many_numbers_are_within_the_error_of_the_sample():
    sample, numbers = Reservoir(), np.random.default_rng(1).random(50_000)
    for number in numbers:
        sample.add(float(number))
    assert sample.count == 50_000 and sample.largest == numbers.max()
    for p, found in zip((50.0, 95.0), sample.quantiles((50.0, 95.0))):
        assert abs(found - p / 100) < 4 * np.sqrt(p / 100 * (1 - p / 100) / SIZE)


@pytest.mark.slow
def test_memory_does_not_grow_with_frames():
    rng, tally = np.random.default_rng(0), Tally()
    row = make_row(0, rng)
    for _ in range(8_000):
        tally.add(row | {"level": 1})
    tracemalloc.start()
    try:
        for _ in range(8_000):
            tally.add(row | {"level": 1})
        grown, _ = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    # One quantity: 8 bytes a frame, and what an array reserves for its growth. What else the process allocates in the
    # meantime is little beside so many frames.
    assert grown / 8_000 < 20


def test_notes_that_differ_by_numbers_alone_are_one_with_its_frames(capsys):
    """Numbers of names are none: of `rail_1` and `rail_2` there are two."""
    rng, tally = np.random.default_rng(0), Tally()
    said = ("", "residual 5.48e-03 after 30 steps", "rail_1 bends", "residual 0.2 after 4 steps", "rail_2 bends", "")
    for index, note in enumerate(said):
        tally.add(make_row(index, rng) | {"note": note, "refused": ""})
    tally.add(make_row(6, rng) | {"note": "residual 0.1 after 9 steps", "refused": ""})
    found = [(one.text, one.frame, one.last, one.count) for one in tally.reasons["note"].values()]
    assert found == [(said[3], 1, 6, 3), (said[2], 2, 2, 1), (said[4], 4, 4, 1)]
    _print_reasons("note", tally.reasons["note"])
    assert capsys.readouterr().out.splitlines() == [
        "  note, line 0, frame 1 (3 frames up to 6, worst in 3): residual 0.2 after 4 steps",
        "  note, line 1, frame 2: rail_1 bends",
        "  note, line 2, frame 4: rail_2 bends",
    ]


def test_of_refused_frames_the_first_reason_is_kept():
    rng, tally = np.random.default_rng(0), Tally()
    for index, why in enumerate(("radius is -1 mm", "radius is -2 mm")):
        tally.add(make_row(index, rng) | {"note": "", "refused": why})
    (one,) = tally.reasons["refused"].values()
    assert (one.text, one.frame, one.worst, one.last) == ("radius is -1 mm", 0, 0, 1)
