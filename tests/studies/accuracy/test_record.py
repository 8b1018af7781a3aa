"""What is said of points from what their processes reported: failures, doubts, effectivity."""

from types import SimpleNamespace

import pytest
from restshape_studies.accuracy.facts import left_out, reuse_fact, row, solver_fact
from restshape_studies.accuracy.front import finite, mark_pareto
from restshape_studies.accuracy.record import Truth, effectivity, nameless, record
from restshape_studies.accuracy.setting import Omission, Setting
from restshape_studies.bench.job import Outcome
from restshape_studies.commands.accuracy import reuse_holds

SCENE = SimpleNamespace(mesh=SimpleNamespace(size=0.05))
SETTING = Setting(0.5, 2, "auto", 1e-6, overrides=("mesh.size=0.025",))
TRUTH = Truth(
    {"0": {"sag": 2.0}, "7": {"sag": -4.0}}, {"0": {"sag": 2.0}, "7": {"sag": -4.02}}, {"sag": 2.5}, {"energy": 0.01}
)


def frame(index: int, error: float, reuse: float, sag: float, estimate: float | None = None) -> dict:
    """A sampled frame as a process reports it."""
    parts = {"discretisation": error, "reuse": reuse, "algebraic": 0.0}
    own = {"discretisation": 0.1, "reuse": -0.02, "algebraic": 0.01}
    printed = {"index": index, "errors": {"energy": error}, "parts": {"energy": parts}, "quantities": {"sag": sag}}
    return printed | {"quantity_parts": {"sag": own}, "estimate": estimate}


def printed(*frames: dict, **other: object) -> Outcome:
    """What a process reported of its point."""
    found = {"frames": list(frames), "refused": {}, "lost": {}, "tight_tolerance": 1e-9}
    found |= {"frame_ms": 3.0, "total_s": 0.1, "unknowns": 10, "elements": 9, "timed_frames": 4, "replayed": 8}
    return Outcome([], found=found | other)


def made(outcome: Outcome, of: str = "field") -> dict:
    """The record of a point."""
    return record("small", SCENE, SETTING, outcome, TRUTH, of)


def test_the_worst_frame_counts_and_closed_forms_come_first():
    found = made(printed(frame(0, 0.02, 1e-8, 2.4), frame(7, 0.04, 1e-7, -4.2)))
    assert (found["error"], found["error_median"]) == (0.04, pytest.approx(0.03))
    assert found["size"] == 0.025 and found["measure"] == "energy" and not found["below_reference"]
    assert found["parts"] == {"discretisation": 0.04, "algebraic": 0.0, "reuse": 1e-7} and found["reuse_holds"]
    sag = found["quantities"]["sag"]
    # Relative to 4, the largest: 0.1 from the closed form 2.5 at frame 0, 0.2 from the reference at frame 7.
    assert (sag["first"], sag["worst"]) == (pytest.approx(0.025), pytest.approx(0.05))
    assert sag["uncertainty"] == pytest.approx(0.005) and sag["solver"] == pytest.approx(0.03 / 4)


def test_a_quantity_may_be_what_counts():
    found = made(printed(frame(0, 0.02, 0.0, 2.5), frame(7, 0.04, 0.0, -4.01)), "sag")
    assert found["measure"] == "q_sag" and found["error"] == pytest.approx(0.0025) and found["below_reference"]
    assert found["parts"] == {
        name: pytest.approx(v / 4) for name, v in (("discretisation", 0.1), ("algebraic", 0.01), ("reuse", 0.02))
    }


def test_reuse_beyond_the_tolerance_is_a_failure():
    good, bad = (made(printed(frame(0, 0.02, reuse, 2.4))) for reuse in (1e-6, 2e-6))
    assert good["reuse_holds"] is True and bad["reuse_holds"] is False
    assert reuse_holds(SimpleNamespace(records=[good])) and not reuse_holds(SimpleNamespace(records=[good, bad]))
    assert "FAILURE" in reuse_fact(SimpleNamespace(records=[good, bad]))


def test_reuse_that_is_known_nowhere_does_not_hold():
    unknown = SimpleNamespace(records=[made(Outcome([], "stopped"))])
    assert not reuse_holds(unknown) and "not known at any point" in reuse_fact(unknown)
    assert "not known at any point" in solver_fact(unknown)
    unknown.records.append(made(printed(frame(0, 0.02, 1e-6, 2.4))))
    assert reuse_holds(unknown) and "at 1 of 2 points" in reuse_fact(unknown)


def test_what_failed_is_reported_with_its_reason_and_without_folders():
    stopped = made(Outcome([], "ended with code 1: /somewhere/deep/inside/loop.py broke"))
    assert stopped["error"] is None and stopped["parts"] is None and stopped["problem"].endswith(": loop.py broke")
    lost = made(
        printed(frame(0, 0.02, 0.0, 2.4), {"index": 7, "problem": "refused: too thin"}, refused={"3": "thin\n  try: x"})
    )
    assert lost["problem"].startswith("frame 7: refused: too thin") and lost["problem"].endswith("3: thin")
    assert "1 frame without a solution" in lost["problem"] and "try" not in lost["problem"]
    mark_pareto([stopped, lost])
    assert [r["pareto"] for r in (stopped, lost)] == [False, True] and row(lost)[-1] == "front"
    lines = left_out(SimpleNamespace(records=[stopped, lost], omissions=[Omission("order 2", "no such elements")]))
    assert len(lines) == 3 and lines[0] == "order 2: no such elements"
    assert nameless("a/b of /x/y.toml, 3 m/s") == "a/b of y.toml, 3 m/s"
    assert finite({"a": [float("inf"), 1.0]}) == {"a": [None, 1.0]}


def test_effectivity_is_estimate_over_true_error():
    frames = [frame(0, 0.02, 0.0, 1.0, 0.03), frame(5, 0.02, 0.0, 1.0, 0.05), frame(7, 0.04, 0.0, 1.0)]
    assert effectivity(frames, "energy") == {
        "measure": "energy",
        "least": pytest.approx(1.5),
        "median": pytest.approx(2.0),
        "largest": pytest.approx(2.5),
        "within": False,
    }
    assert effectivity(frames[:1], "energy")["within"] and effectivity(frames[2:], "energy") is None
