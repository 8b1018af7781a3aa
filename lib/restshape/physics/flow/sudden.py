"""Fields that begin suddenly: what a flow goes on from, made to fit values at the border that have jumped."""

from __future__ import annotations

import logging
from dataclasses import replace

import numpy as np

from restshape.physics.flow.carry import VelocityCorrection, divergence, prescribe
from restshape.physics.flow.history import Level, Past
from restshape.physics.flow.incompressible_flow import IncompressibleFlow

JUMP = 1e-9
"""Change of a prescribed value, over the largest value of its field, from which it has jumped."""
LOST = 0.05
"""Largest share of a node in the divergence, over speed and cell size, of a velocity without an impulse."""
IMPULSE = "the flow began suddenly in this step: forces hold the impulse of it, over the step"
"""The note of a frame's row whose last step was an impulse."""

PROJECTED = 0.2
"""Pressures that a new mesh adds, over those of the flow, from which on forces are doubted."""

log = logging.getLogger("restshape.analysis")


def with_jumps(past: Past, problem: IncompressibleFlow) -> Past:
    """The past with the prescribed values of now, where these have jumped; the next step is one of first order then.

    Source: docs/theory/flow.md.
    """
    last = past.last
    values = last.values.copy()
    prescribe(problem, values, last.X, past.time)
    if not np.any(np.abs(values - last.values) > JUMP * np.abs(values).max(axis=0)):
        return past
    log.info("Prescribed values have jumped: the next step is of first order")
    return Past(past.time, replace(last, values=values))


def projected_note(share: float) -> dict[str, str]:
    """The note of a frame's row on a new mesh that has added such a share of pressures to those of the flow."""
    if share < PROJECTED:
        return {}
    what = "the mesh is new: what makes the velocity on it free of divergence is in the forces, with"
    do = "longer time steps, finer meshes, and meshes that last have less of it"
    return {"note": f"{what} {100 * share:.0f} % of the pressures; {do}"}


def is_sudden(before: Level, last: Level, problem: IncompressibleFlow) -> bool:
    """Whether the step between two levels was an impulse: it has taken away most of the divergence that there was."""
    speed = float(np.abs(before.values[:, :2]).max())
    had, has = (float(np.abs(divergence(level)[0]).max()) for level in (before, last))
    return had > LOST * speed * problem.size and had > 2.0 * has


def after_impulse(past: Past, correct: VelocityCorrection) -> Past:
    """The past with the velocity just after the impulse in place of that before it.

    Args:
        past: after one step of first order from fields that began suddenly.
        correct: makes velocities divergence-free.

    Source: docs/theory/flow.md.
    """
    if past.before is None:
        return past
    lost, area = divergence(past.last)
    _, before = correct(past.before, lost / area, past.times[1])
    log.info("The velocity before the impulse is replaced by that after it")
    return replace(past, before=before, sudden=False)
