"""Hard cases of heat in fluids: strong buoyancy from rest, no difference of temperatures, a vessel that is squeezed."""

from collections.abc import Iterator

import numpy as np
from restshape_studies.stability.case import Case, Row, Statement, Trial, below, near, true, valid
from restshape_studies.stability.known_bounds import EXACT, Known
from restshape_studies.stability.scenery import across, drag
from restshape_verification.flow.heated_scenes import BUOYANT, CAVITY, in_time

from restshape.policy import POLICIES

EVERY = tuple(POLICIES)
WATCHED = (
    'warmest = { temperature = true, reduce = "max" }\ncoldest = { temperature = true, reduce = "min" }\n'
    "kinetic = { kinetic = true }\nfast = { speed = true }\narea = { area = true }\n"
)
RAYLEIGH, PRANDTL = 1e6, 0.71
FALLEN = 0.5 * RAYLEIGH * PRANDTL
"""Kinetic energy [J] of fluid that has risen by the height of the vessel, pulled by half the difference."""
OVERSHOT = Known(0.05, "SUPG is not monotone: layers thinner than an element overshoot by some percent of a kelvin")
"""Kelvins by which temperatures may leave those of the walls, which are a kelvin apart."""
LID = [*drag("top", (0.5, 1.0), across((0.5, 1.0), (0.5, 0.5), 10))]


def idle(frames: int) -> dict[str, object]:
    """Frames in which nothing is edited."""
    return {"do": "idle", "frames": frames}


def vessel(time_step: float, size: float, heat: str = "") -> str:
    """A vessel at rest whose left wall is a kelvin warmer than the right one, from now on."""
    text = CAVITY.replace("Ra = 1e4", f"Ra = {RAYLEIGH!r}") + WATCHED + in_time(time_step, heat=heat) + BUOYANT
    return f"{text}[mesh]\nsize = {size!r}\nnear = {{ left = {size / 3!r}, right = {size / 3!r} }}\n"


def between(rows: list[Row], low: float = 299.5, high: float = 300.5) -> Iterator[Statement]:
    """The statements that temperatures stay between those of the walls [K], and energy below that of falling."""
    yield from valid(rows)
    yield below("largest temperature above the warm wall [K]", max(r["q_warmest"] for r in rows) - high, OVERSHOT)
    yield below("largest temperature below the cold wall [K]", low - min(r["q_coldest"] for r in rows), OVERSHOT)
    yield below("kinetic energy over that of falling", max(r["q_kinetic"] for r in rows) / FALLEN, 1.0)


def from_rest(trial: Trial) -> Iterator[Statement]:
    """Air that is at rest when one wall of its vessel becomes warm and one cold, at Ra = 1e6."""
    rows, same = trial.compared(vessel(5e-4, 0.06), [idle(trial.count(80, 30))], every=8)
    yield from between(rows)
    yield from same
    yield true("the fluid moves", rows[-1]["q_fast"] > 50.0, rows[-1]["q_fast"])


def squeezed(trial: Trial) -> Iterator[Statement]:
    """A closed vessel with plumes in it, squeezed to half of its volume."""
    rows = trial.rows(vessel(5e-4, 0.07), [idle(20), *LID, idle(5)])
    yield from between(rows)
    yield near("area of the vessel [m^2]", rows[-1]["q_area"], 0.5, EXACT)


def no_difference(trial: Trial) -> Iterator[Statement]:
    """A vessel whose walls are as warm as the fluid, with buoyancy: no temperature is looked for, and nothing moves."""
    text = vessel(5e-4, 0.1).replace("300.5 K", "300 K").replace("299.5 K", "300 K")
    run = trial.replay(text, [idle(3), *LID, idle(2)])
    made = run.replay
    rows, columns = [], set()
    for row in run.rows():
        rows.append(dict(row))
        columns.add(made.analysis.x.shape[1])
    yield from valid(rows)
    yield true("unknowns are velocity and pressure alone", columns == {3}, str(sorted(columns)))
    yield below("largest speed [m/s]", max(row["q_fast"] for row in rows), 0.0)
    temperatures = np.array([[row["q_warmest"], row["q_coldest"]] for row in rows])
    yield below("largest difference from 300 K [K]", np.abs(temperatures - 300.0).max(), 0.0)


CASES: dict[str, Case] = {
    "from_rest": Case(from_rest, EVERY, share=0.4),
    "squeezed": Case(squeezed),
    "no_difference": Case(no_difference),
}
