"""Predicted frames of a slender beam beside Euler and Bernoulli's formula, y = 4 F l^3 / (E b h^3)."""

from collections.abc import Sequence
from typing import Any

from petsc4py import PETSc
from restshape_studies.validation.case import CLOSED_FORM, Check

from restshape.application import application
from restshape.interface.replays import replay_files

HERE = application("solid").folder
SCRIPT = HERE / "scenes/slender.toml", HERE / "edits/slender.jsonl"
GROWTH, FRAMES = 0.1, 20
"""Part by which the script makes the beam longer, then higher, in so many equal frames."""
SOURCE = "Euler and Bernoulli's beam; shear adds 0.15 %"


def slender(comm: PETSc.Comm) -> list[Check]:
    """The deflection that is predicted for a longer and a higher beam, the solved one, and the error between them.

    Frames are predicted from the first beam, and, once the error estimate doubts them, from the last one solved.
    """
    predicted, solved = (replay_files(*SCRIPT, "auto", predict=way)["rows"] for way in ("linear", "none"))
    first = solved[0]["q_tip"]
    found = [Check("tip of the first beam [m]", first, -4 * 100 / (210e9 * 0.02 * 0.05**3), 0.005, SOURCE, CLOSED_FORM)]
    releases = [i for i, row in enumerate(solved) if row["event"] == "release"]
    for release, side, power in zip(releases, ("longer", "higher"), (3, -3)):
        z = predicted[release]["q_tip"] / first
        quantity = f"solved tip, beam {side} by a tenth [first]"
        found.append(Check(quantity, z, (1.0 + GROWTH) ** power, 0.002, SOURCE, CLOSED_FORM))
        drag = slice(release - FRAMES, release)
        found += _drag(predicted[drag], solved[drag], first, side, power)
    return found


def _drag(
    predicted: Sequence[dict[str, Any]], solved: Sequence[dict[str, Any]], first: float, side: str, power: int
) -> list[Check]:
    """The checks of the last frame that is predicted from the first beam, and of the last one of all.

    Args:
        predicted: the frames of a drag; solved: the same, solved.
        first: deflection of the first beam [m].
        side: that grows.
        power: of the deflection's dependence on it.
    """
    shown = [i for i, row in enumerate(predicted) if row["predicted"]]
    doubted = [i for i, row in enumerate(predicted) if not row["predicted"]] or [FRAMES]
    found = []
    for last in sorted({doubted[0] - 1, shown[-1]}):
        start = max((i for i in doubted if i < last), default=-1)
        a, b = (1.0 + GROWTH * (i + 1) / FRAMES for i in (start, last))
        linear, exact = a**power + power * a ** (power - 1) * (b - a), b**power
        y, z = predicted[last]["q_tip"] / first, solved[last]["q_tip"] / first
        name = f"beam {side} by {100 * (b - 1):.2g} %, from {100 * (a - 1):.2g} %"
        error, expected = y / z - 1.0, linear / exact - 1.0
        found += [
            Check(f"predicted tip, {name} [first]", y, linear, 0.002, SOURCE, CLOSED_FORM),
            Check(f"error of the prediction, {name} [solved]", error, expected, 0.02, SOURCE, CLOSED_FORM),
        ]
    return found
