"""Hard cases of flow: jumps, coarse meshes, long and tiny steps, gaps, vessels, outflows that draw in, rest."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from restshape_studies.stability.case import Case, Row, Statement, Trial, below, near, valid
from restshape_studies.stability.known_bounds import EXACT
from restshape_studies.stability.scenery import across, block, drag, head, rows_of, set_value
from restshape_verification.flow.scenes import STEADY, channel, disc, in_time

from restshape.policy import POLICIES

EVERY = tuple(POLICIES)
OBSERVED = "[quantities]\nkinetic = { kinetic = true }\nfast = { speed = true }\n"
ASKED = OBSERVED + 'drag = { drag = true, at = "body" }\nlift = { lift = true, at = "body" }\n'
MESH = "[mesh]\nsize = 0.12\nnear = { body = 0.05 }\nedges_per_circle = 12\n"
SETTLED = 1e-5
"""Of a flow that changes by as much in a millisecond."""
STREAM = 0.5 * 3.0
"""Kinetic energy [J] of the channel's fluid at 1 m/s, the largest velocity that enters; what enters has 8/15 of it."""


def stream(mu: float, effects: str) -> str:
    """A channel of 3 m x 1 m with a body in it, through which a fluid of density 1 flows at 1 m/s at most."""
    holes = "[parameters]\nU = 1\n" + disc("body", (0.8, 0.48), 0.12)
    return channel(3.0, 1.0, f"rho = 1\nmu = {mu!r}\n", "4*U*y*(1 - y)", holes) + effects + MESH + ASKED


def idle(frames: int) -> dict[str, Any]:
    """Frames in which nothing is edited."""
    return {"do": "idle", "frames": frames}


def bounded(rows: list[Row], most: float = 1.0) -> Iterator[Statement]:
    """The statements that all frames are shown, and that the fluid has no more energy than at the largest velocity."""
    yield from valid(rows)
    yield below("kinetic energy over that of the stream", max(row["q_kinetic"] for row in rows) / STREAM, most)


def jump(trial: Trial) -> Iterator[Statement]:
    """A body that is dragged across half the channel in one frame, and back."""
    events = [
        idle(8),
        *drag("body", (0.8, 0.48), [(2.2, 0.52)]),
        idle(6),
        *drag("body", (2.2, 0.52), [(0.8, 0.48)]),
        idle(6),
    ]
    rows, same = trial.compared(stream(0.01, in_time(0.1)), events, every=3)
    yield from bounded(rows)
    yield from same


def coarse(trial: Trial) -> Iterator[Statement]:
    """A Reynolds number of 10,000 on a coarse mesh, while the body is dragged."""
    events = [idle(trial.count(40, 10)), *drag("body", (0.8, 0.48), across((0.8, 0.48), (1.1, 0.55), 10)), idle(10)]
    yield from bounded(trial.rows(stream(1e-4, in_time(0.05)), events))


def long_steps(trial: Trial) -> Iterator[Statement]:
    """Steps in which the fluid passes fifty elements."""
    events = [idle(10), *drag("body", (0.8, 0.48), across((0.8, 0.48), (1.0, 0.5), 4)), idle(4)]
    yield from bounded(trial.rows(stream(0.01, in_time(6.0)), events))


def tiny_steps(trial: Trial) -> Iterator[Statement]:
    """Steps of a microsecond after such of two milliseconds: a flow that has settled stays what it is."""
    still = trial.replay(stream(0.02, STEADY))
    rows_of(still)
    events = [idle(60), *set_value("effects.flow.time_step", 1e-6), idle(5)]
    run, rows, settled = trial.replay(stream(0.02, in_time(2e-3)), events), [], still.replay.analysis.x
    made = run.replay
    for row in run.rows():
        if row["index"] == 0:
            made.analysis.begin(settled)
        if row["index"] == 60:
            settled = made.analysis.x.copy()
        rows.append(dict(row))
    yield from valid(rows)
    change = np.abs(made.analysis.x - settled).max(axis=0)
    yield below("largest change of the velocity [m/s]", change[:2].max(), SETTLED)
    yield below("largest change of the pressure over its range", change[2] / np.ptp(settled[:, 2]), 10 * SETTLED)


def gap(trial: Trial) -> Iterator[Statement]:
    """A gap beside a wall that closes to two elements and opens again."""
    path = [*across((0.8, 0.48), (0.8, 0.2), 8), *across((0.8, 0.2), (0.8, 0.48), 8)]
    rows, same = trial.compared(stream(0.02, in_time(0.1)), [idle(4), *drag("body", (0.8, 0.48), path)], every=4)
    yield from bounded(rows)
    yield from same


def squeezed(trial: Trial) -> Iterator[Statement]:
    """A closed vessel in which a lid turns the fluid, squeezed to half of its volume."""
    lid = '[boundary.lid]\non = "top"\nvelocity = [1, 0]\n'
    lid += "[quantities]\nkinetic = { kinetic = true }\narea = { area = true }\n"
    text = head("flow") + block() + "[fluid]\nrho = 1\nmu = 0.01\n" + lid + in_time(0.1) + "[mesh]\nsize = 0.12\n"
    rows = trial.rows(text, [idle(10), *drag("top", (0.5, 1.0), across((0.5, 1.0), (0.5, 0.5), 10)), idle(5)])
    yield from bounded(rows)
    yield near("area of the vessel [m^2]", rows[-1]["q_area"], 0.5, EXACT)


def new_meshes(trial: Trial) -> Iterator[Statement]:
    """A mesh that is new in every third frame, once with steps of a hundredth, once of a ten thousandth of a second."""
    for dt, before in ((0.05, 40), (1e-4, 60)):
        sizes = [0.12 - 0.001 * (k % 2 + 1) for k in range(6)]
        news = [event for size in sizes for event in (*set_value("mesh.size", size), idle(2))]
        text = stream(0.004, in_time(dt))
        kept = trial.rows(text, [idle(before + 18)])
        remade = trial.rows(text, [idle(before), *news])
        yield from bounded(remade)
        was, now = (np.array([row["q_drag"] for row in rows[before + 1 :]]) for rows in (kept, remade))
        yield below(
            "largest change of the drag by new meshes, over the drag", np.abs(now - was).max() / was.max(), 0.05
        )


def every_carry(trial: Trial) -> Iterator[Statement]:
    """A body that goes across half the channel in a frame, and in steps of several elements, however it is followed."""
    far = [*drag("body", (0.8, 0.48), [(2.2, 0.52)]), idle(5)]
    leaps = [*drag("body", (2.2, 0.52), across((2.2, 0.52), (0.8, 0.48), 5)), idle(5)]
    for carry in ("ale", "remap", "auto"):
        yield from bounded(trial.rows(stream(0.005, in_time(0.1, carry=carry)), [idle(8), *far, *leaps]))


def leaving_vortex(trial: Trial) -> Iterator[Statement]:
    """A vortex twice as fast as the stream that takes it out: the outflow draws in while it leaves."""
    slip = '[boundary.sides]\non = ["bottom", "top"]\nslip = true\n'
    text = channel(3.0, 1.0, "rho = 1\nmu = 1e-4\n", "1") + slip + in_time(0.05) + "[mesh]\nsize = 0.1\n"
    run, rows, drew_in = trial.replay(text + OBSERVED, [idle(60)]), [], False
    for row in run.rows():
        analysis = run.replay.analysis
        if row["index"] == 0:
            away = analysis.space.X - [2.3, 0.5]
            spin = 2.0 * np.exp(0.5 - (away**2).sum(axis=1) / 0.08) / 0.2
            x = np.column_stack([1.0 - spin * away[:, 1], spin * away[:, 0], 0.0 * spin])
            analysis.problem.boundary.apply(x)
            analysis.begin(x)
        drew_in = drew_in or analysis.problem.drawing_in
        rows.append(dict(row))
    yield from bounded(rows, 1.4)
    yield Statement("the outflow has drawn in", str(drew_in), drew_in)
    yield near("kinetic energy over that of the stream, after it has left", rows[-1]["q_kinetic"] / STREAM, 1.0, 1e-6)


def drawn_in(trial: Trial) -> Iterator[Statement]:
    """A fluid that is drawn in by an outflow, since it is taken out at the inlet: without a term there it blows up."""
    text = channel(3.0, 1.0, "rho = 1\nmu = 1e-4\n", "-4*y*(1 - y)") + in_time(0.1) + "[mesh]\nsize = 0.1\n"
    yield from bounded(trial.rows(text + OBSERVED, [idle(trial.count(120, 60))]), 0.6)


def switched_off(trial: Trial) -> Iterator[Statement]:
    """An inflow that is switched off: what moves comes to rest."""
    events = [idle(10), *set_value("parameters.U", 0.0), idle(8)]
    rows = trial.rows(stream(0.1, in_time(0.5)), events)
    yield from bounded(rows)
    yield below("energy that is left over that of the stream", rows[-1]["q_kinetic"] / STREAM, 1e-9)


def rest(trial: Trial) -> Iterator[Statement]:
    """A fluid that nothing moves, steady and in time, while a body in it is dragged."""
    for effects in (STEADY, in_time(0.1)):
        text = stream(0.01, effects).replace("U = 1", "U = 0")
        rows = trial.rows(text, [idle(2), *drag("body", (0.8, 0.48), across((0.8, 0.48), (1.0, 0.5), 4))])
        yield from valid(rows)
        yield below("largest speed [m/s]", max(row["q_fast"] for row in rows), 0.0)


CASES: dict[str, Case] = {
    "jump": Case(jump, EVERY),
    "coarse": Case(coarse, share=0.5),
    "long_steps": Case(long_steps),
    "tiny_steps": Case(tiny_steps),
    "gap": Case(gap, EVERY),
    "squeezed": Case(squeezed),
    "new_meshes": Case(new_meshes),
    "every_carry": Case(every_carry),
    "leaving_vortex": Case(leaving_vortex),
    "drawn_in": Case(drawn_in, share=0.5),
    "switched_off": Case(switched_off),
    "rest": Case(rest),
}
