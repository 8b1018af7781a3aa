"""Hard cases of columns at and over the loads at which they buckle, of large deformation."""

from collections.abc import Iterator

import numpy as np
from restshape_studies.stability.case import Case, Statement, Trial, above, below, refused_for, true, valid
from restshape_studies.stability.known_bounds import CONDITIONED, Known
from restshape_studies.stability.rubber import LARGE, solid
from restshape_studies.stability.scenery import across, block, drag, meshed, set_value
from restshape_verification.solid.hard_scenes import HEAD
from restshape_verification.solid.stability_large import SPRINGS, UNVERIFIED, reached
from scipy.optimize import brentq
from scipy.special import ellipk

NEAR_THE_LIMIT = Known(1e-7, "rounding, 25 times as large in a column at 0.98 of the length at which it buckles")
E, THICKNESS, DEPTH = 1e6, 0.05, 0.1
EULER = np.pi**2 * E * THICKNESS * DEPTH**3 / 12 / 4
"""What a clamped column of length 1 with a free end bears [N]."""


def column(dead: float, following: float = 0.0) -> str:
    """The scene of a clamped column under a dead force down [N] and the force of a pressure [N] on its top."""
    return (
        HEAD
        + block(DEPTH, 1.0)
        + f"[material.r]\nE = {E}\nnu = 0\nthickness = {THICKNESS}\n"
        + solid("plane_stress")
        + LARGE
        + '[supports.foot]\non = "bottom"\nfix = ["x", "y"]\n'
        + (f'[loads.weight]\non = "top"\nforce = [0, {-dead!r}]\n' if dead else "")
        + (f'[loads.jet]\non = "top"\npressure = {following / (DEPTH * THICKNESS)!r}\n' if following else "")
        + meshed(0.05, 2)
        + '[quantities]\nsway = { displacement = "x", at = "top", reduce = "mean" }\n'
    )


def loaded_at_once(trial: Trial) -> Iterator[Statement]:
    """0.97, 1.05 and 3 times Euler's load are put on a column at once: shown below, refused above."""
    limits, statements = [], []
    for share in (0.97, 1.05, 3.0):
        events = set_value("loads.weight.force", [0, -share * EULER])
        rows = trial.rows(column(1.0), events, overrides=["loads.weight.force=[0, -1]"])
        statements += valid(rows, int(share > 1))
        if share > 1:
            limits.append(share * reached(rows[-1]["refused"]))
    # The shear of so thick a column lowers Euler's load by about a hundredth.
    yield above("limit of the refusals over Euler's load", min(limits), 0.97)
    yield below("limit of the refusals over Euler's load", max(limits), 1.0)
    yield from statements


def loaded_by_what_follows(trial: Trial) -> Iterator[Statement]:
    """A third of the load turns with the column's top, which then bears more: shown up to there."""
    # A share f < 1/2 of the force N turns with the top: at the limit cos(k L) = f / (f - 1), k^2 = N / (E I).
    f = 1 / 3
    limit = EULER * (np.arccos(f / (f - 1)) / (np.pi / 2)) ** 2
    for share in (0.95, 1.05):
        dead, pressure = (1 - f) * share * limit, f * share * limit / (DEPTH * THICKNESS)
        events = [*set_value("loads.jet.pressure", pressure), *set_value("loads.weight.force", [0, -dead])]
        rows = trial.rows(column((1 - f) * 0.3 * limit, f * 0.3 * limit), events)
        yield true(f"the last frame is {'refused' if share > 1 else 'shown'}", bool(rows[-1]["refused"]) == (share > 1))
        yield from valid(rows, int(share > 1))


def wholly_following(trial: Trial) -> Iterator[Statement]:
    """Twice and five times Euler's load that turn with the top bend no column: Beck 1952."""
    for share in (2.0, 5.0):
        rows = trial.rows(column(0.0, share * EULER))
        yield below(f"sway at {share:g} times Euler's load [m]", abs(rows[0]["q_sway"]), trial.solved(CONDITIONED))
        yield from valid(rows)


def bent(length: float) -> float:
    """Sway over the length of the elastica that the column under 0.8 of its limit is when it has grown to a length.

    With m = sin^2(a/2) of the slope a at its end K(m)^2 = (pi/2)^2 P/P_c, and its sway is 2 sqrt(m) / K(m) of its
    length (Timoshenko and Gere, Theory of elastic stability, 1961, 2.7). Shear lowers P_c by about a hundredth.
    """
    share = 1.01 * 0.8 * length**2
    if share <= 1.0:
        return 0.0
    m = brentq(lambda m: ellipk(m) - 0.5 * np.pi * np.sqrt(share), 0.0, 1.0 - 1e-12)
    return float(2.0 * np.sqrt(m) / ellipk(m))


def dragged_beyond(trial: Trial) -> Iterator[Statement]:
    """A column under 0.8 of its limit is dragged longer than it can stand, slowly and fast: reported in time."""
    for frames in (5, 40):
        path = across((DEPTH / 2, 1.0), (DEPTH / 2, 1.4), frames)
        rows = trial.rows(column(0.8 * EULER), drag("top", (DEPTH / 2, 1.0), path))
        first = 1 + next(k for k in range(1, frames + 1) if 1.0 + 0.4 * k / frames > np.sqrt(1 / 0.8))
        refused = [row["index"] for row in rows if row["refused"]]
        yield refused_for(rows, "not positive definite", "no equilibrium")
        # The shear of so thick a column makes it a little shorter: by a frame of the long drag.
        yield above("first refused frame less the first beyond the limit", refused[0] - first, -1)
        yield below("first refused frame less the first beyond the limit", refused[0] - first, 10)
        # Beyond the limit the straight column is no answer, the bent one is.
        lengths = {k: 1.0 + 0.4 * (k - 1) / frames for k in range(refused[0], frames + 2)}
        off = [abs(abs(rows[k]["q_sway"]) / L - bent(L)) for k, L in lengths.items() if not rows[k]["refused"]]
        found = max(off, default=0.0)
        bound = Known(0.01, "nothing is shown after that under some policies")
        yield below("sway of what is shown after that less the elastica's, over the length", found, bound)
        yield from valid(rows, None)


def predicted_beyond(trial: Trial) -> Iterator[Statement]:
    """The same drags, predicted: refused at release, or what is shown since is the last column that stands."""
    for frames in (5, 40):
        path = across((DEPTH / 2, 1.0), (DEPTH / 2, 1.4), frames)
        rows = trial.rows(column(0.8 * EULER), drag("top", (DEPTH / 2, 1.0), path), predict="linear")
        yield refused_for(rows, "not positive definite", "no equilibrium")
        yield from valid(rows, None)


def dragged_to_the_limit(trial: Trial) -> Iterator[Statement]:
    """The same column dragged to 0.98 of the length at which it buckles: no frame is refused."""
    path = across((DEPTH / 2, 1.0), (DEPTH / 2, 1.1), 30)
    for predict in ("none", "linear"):
        if predict == "none" or trial.policy not in SPRINGS:
            rows = trial.rows(column(0.8 * EULER), drag("top", (DEPTH / 2, 1.0), path), predict=predict)
            yield below("sway [m]", max(abs(row["q_sway"]) for row in rows), trial.solved(NEAR_THE_LIMIT))
            yield from valid(rows)


CASES: dict[str, Case] = {
    "loaded_at_once": Case(loaded_at_once, exempt=UNVERIFIED),
    "loaded_by_what_follows": Case(loaded_by_what_follows, exempt=UNVERIFIED),
    "wholly_following": Case(wholly_following),
    "dragged_beyond": Case(dragged_beyond, ("auto", "refactor", "rebuild"), UNVERIFIED, weekly=("rebuild",)),
    "predicted_beyond": Case(predicted_beyond, exempt=SPRINGS),
    "dragged_to_the_limit": Case(dragged_to_the_limit),
}
