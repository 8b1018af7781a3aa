"""Hard cases of cloth on cloth: many layers, rolled up, folded twice, without friction between layers and with much."""

from collections.abc import Iterator

import numpy as np
from restshape_studies.stability.case import Case, Statement, Trial, above, below, near, true
from restshape_studies.stability.known_bounds import Known
from restshape_studies.stability.scenery import block, meshed
from restshape_verification.couture.hard_scenes import (
    CONTACT,
    GRAVITY,
    HEAD,
    QUANTITIES,
    REST,
    cloth,
    cotton,
    differenced,
    floor,
    played,
    start,
)
from restshape_verification.couture.placed_strips import Curve, along, heights_at, placed, rested

from restshape.replay.loop import Replay

WAY = 1e-8
"""Half of the distance [m] between two energies: layers are pressed to some micrometres of each other."""
LENGTH, WIDTH, THICKNESS = 0.3, 0.02, 5e-4
"""Length and width [m] of a strip, and the distance [m] at which its layers touch."""
LEAST_SHARE = 0.6
"""Of that length, which gives three layers."""
INSIDE, PITCH = 8e-3, 3.0 * THICKNESS
"""Inner radius [m] of a roll, and how far its layers are apart at first."""
FOLDS, FOLD = 50e-3, 3e-3
"""Length of a layer, and radius of the folds between them at first [m]."""


def strip(length: float, width: float, size: float, bending: float, friction: float) -> str:
    """A strip of cotton that lies flat on a floor, with a coefficient of friction for both."""
    text = HEAD + block(length, width) + cotton(bending) + cloth() + GRAVITY + meshed(size) + QUANTITIES
    text += floor(0.0).replace("friction = 0.3", f"friction = {friction}")
    text += f"{CONTACT}thickness = {THICKNESS}\nself_friction = {friction}\n"
    return text + start(move=(0, 0, 0.8 * THICKNESS))


def settled(made: Replay, curve: Curve) -> Iterator[Statement]:
    """Let the strip of a replay come to rest from a curve; the statements that it does, and does not cross itself."""
    sheet = made.analysis.problem
    bottom = sheet.corners(made.analysis.x)[:, 2].mean()
    x = placed(sheet, curve)
    x[:, 2] += bottom - x[:, 2].min()
    corners, report = rested(made.analysis, x)
    yield true("at rest", report.converged, report.why)
    yield below("residual by differences of the energy", differenced(made, way=WAY), 1.5 * REST)
    yield below("crossings", len(sheet.surface.crossed(corners)), 0)


def spiral(length: float) -> Curve:
    """A strip of a length [m] rolled up from inside."""
    parts, radius, left = [], INSIDE, length
    while left > 0.0:
        part = min(left, radius * np.pi / 8.0)
        parts.append((part, 1.0 / radius))
        radius, left = radius + PITCH * part / (2.0 * np.pi * radius), left - part
    return along(parts)


def rolled_up(trial: Trial) -> Iterator[Statement]:
    """A strip that starts rolled up, with four layers, comes to rest: without friction, and with a coefficient of 2."""
    length = max(LEAST_SHARE, trial.share) * LENGTH
    for friction in (0.0, 2.0):
        made, _ = played(trial, strip(length, WIDTH, 5e-3, 5e-6, friction))
        yield from settled(made, spiral(length))
        x = made.analysis.problem.corners(made.analysis.x)
        yield above(f"way from end to end over that of the roll, friction {friction:g}", float(np.ptp(x[:, 0])), 0.06)


def many_layers(trial: Trial) -> Iterator[Statement]:
    """A strip that is folded to and fro in 20 layers falls together and rests; the floor bears its weight."""
    layers = trial.count(20, 5)
    length = layers * FOLDS + (layers - 1) * np.pi * FOLD
    parts = [(FOLDS, 0.0)]
    for k in range(layers - 1):
        parts += [(np.pi * FOLD, (1.0 - 2.0 * (k % 2)) / FOLD), (FOLDS, 0.0)]
    made, _ = played(trial, strip(length, WIDTH, 6e-3, 2e-7, 0.3))
    yield from settled(made, along(parts))
    sheet = made.analysis.problem
    x = sheet.corners(made.analysis.x)
    heights = heights_at(sheet, x, (0.5 * FOLDS, 0.52 * WIDTH))
    yield above("layers on a line upwards", len(heights), layers - 1)
    lowest = float(np.diff(heights).min()) / THICKNESS
    yield true("layers do not touch nearer than a tenth of where contact begins", lowest > 0.1, f"{lowest:.3g}")
    borne = sheet.contact.forces(sheet.contact.place(x))[:, 2].sum()
    bound = Known(1e-3, "the norm of the residual bounds a sum by the root of the number of nodes")
    yield near("force of the floor over the weight", -borne / (sheet.lumped.mass.sum() * 9.81), 1.0, bound)


CASES = {
    "rolled_up": Case(rolled_up, share=0.67, weekly=("auto",)),
    "many_layers": Case(many_layers, share=0.25),
}
