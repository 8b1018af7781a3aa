"""Predicted frames of a slender beam beside Euler and Bernoulli's formula, y = 4 F l^3 / (E b h^3)."""

from itertools import pairwise

from petsc4py import PETSc
from restshape_studies.validation.case import CLOSED_FORM, Check

from restshape.application import application
from restshape.replay.replayed_files import replay_files

HERE = application("solid").folder
GROWTH = 0.1
"""Part by which the script makes the beam longer, then higher."""


def slender(comm: PETSc.Comm) -> list[Check]:
    """The deflection that is predicted for a longer and a higher beam, the solved one, and the error between them."""
    rows = replay_files(HERE / "scenes/slender.toml", HERE / "edits/slender.jsonl", "auto", predict="linear")["rows"]
    ends = [(before, after) for before, after in pairwise(rows) if after["event"] == "release"]
    source = "Euler and Bernoulli's beam; shear adds 0.15 %"
    first = rows[0]["q_tip"]
    found = [Check("tip of the first beam [m]", first, -4 * 100 / (210e9 * 0.02 * 0.05**3), 0.005, source, CLOSED_FORM)]
    for (predicted, solved), side, power in zip(ends, ("longer", "higher"), (3, -3)):
        linear, exact = 1.0 + power * GROWTH, (1.0 + GROWTH) ** power
        y, z = predicted["q_tip"] / first, solved["q_tip"] / first
        found += [
            Check(f"predicted tip, beam {side} by a tenth [first]", y, linear, 0.002, source, CLOSED_FORM),
            Check(f"solved tip, beam {side} by a tenth [first]", z, exact, 0.002, source, CLOSED_FORM),
            Check(
                f"error of the prediction, beam {side} [solved]",
                y / z - 1.0,
                linear / exact - 1.0,
                0.02,
                source,
                CLOSED_FORM,
            ),
        ]
    return found
