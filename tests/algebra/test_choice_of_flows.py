"""What is chosen for flows costs as little, by counted work, as the best candidate alone."""

from pathlib import Path

import pytest
from restshape_studies.stability.scenery import across, drag, make_replay, write_scene, write_script
from restshape_verification.flow.scenes import STEADY, channel, disc, in_time

from restshape.algebra.reuse.candidates import STEADY_FLOW
from restshape.algebra.reuse.counted_work import EVENTS, counted_seconds
from restshape.replay.event_counts import EventCounts, begin_log

BODY = channel(3, 1, "rho = 1.5\nmu = 0.1\n", holes=disc("body", (1, 0.5), 0.15))
MESH = "[mesh]\nsize = 0.09\n"
STEPS = [{"do": "idle", "frames": 12}, *drag("body", (1.0, 0.5), across((1.0, 0.5), (1.1, 0.52), 8))]


def counted(folder: Path, effects: str, name: str = "") -> tuple[float, set[str]]:
    """Seconds by the calibration of a replay with one candidate alone, or with the choice, and what was used."""
    script = write_script(folder, STEPS if "time_step" in effects else STEPS[1:])
    made = make_replay(write_scene(folder, BODY + effects + MESH), script)
    solver = made.analysis.solver
    for other in STEADY_FLOW:
        if name not in ("", other.name):
            solver.kept.choice.exclude(other)
    counts, seconds, used = EventCounts(EVENTS), 0.0, set()
    counts.since_last()
    for row in made.frames():
        seconds += counted_seconds(counts.since_last(), int(row["iterations"]), solver)
        if row["iterations"]:
            used.add(str(row["preconditioner"]))
    return seconds, used


@pytest.mark.slow
@pytest.mark.parametrize("effects", [STEADY, in_time(0.05)])
def test_the_choice_costs_as_little_as_the_best_candidate(tmp_path, effects):
    begin_log()
    alone = {}
    for name in ("lu", "ilu(0)", "ilu(1)", "ilu(2)", "bicgstab+ilu(1)"):
        alone[name], used = counted(tmp_path, effects, name)
        assert used == {name}
    chosen, _ = counted(tmp_path, effects)
    assert chosen < 1.1 * min(alone.values()) and chosen < 0.7 * max(alone.values()), (chosen, alone)
