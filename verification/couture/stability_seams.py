"""Hard cases of seams: far stiffer than the cloth, and sewn the wrong way round."""

from collections.abc import Iterator

from restshape_studies.stability.case import Case, Statement, Trial, below
from restshape_verification.couture.hard_scenes import pinned, played, resting, square

SIZE = 0.03
"""Mesh size [m]."""
MEMBRANE = 1e6 * 3e-4 / (1 - 0.3**2)
"""Stiffness of the cloth of these scenes [N/m]."""
SEAM = '\n[seams.side]\nfrom = "left"\nto = "right"\n'
LONGER = [
    {"do": "press", "on": "top", "at": [0.15, 0.12]},
    {"do": "drag", "to": [0.15, 0.14], "frames": 4},
    {"do": "release"},
]


def stiff_seams(trial: Trial) -> Iterator[Statement]:
    """A strip that a seam, 1e6 times stiffer than the cloth by its mesh size, makes a tube, while it becomes longer."""
    stiffness = 1e6 * MEMBRANE / SIZE
    text = square(SIZE, SEAM, f"stiffness = {stiffness}\n", pinned("d"), height=0.12)
    made, rows = played(trial, text, LONGER)
    # Two places of the energy must differ by more than its rounding, and by less than the seam's give.
    yield from resting(made, rows, way=1e-9)
    yield below("largest distance across the seam [m]", max(row["seam_gap"] for row in rows), 1e-7)
    yield below("crossings", max(row["crossings"] for row in rows), 0)


def sewn_the_wrong_way_round(trial: Trial) -> Iterator[Statement]:
    """A strip sewn to a band with one face rests, and stays apart from itself."""
    made, rows = played(trial, square(SIZE, SEAM, "reverse = true\n", pinned("d"), height=0.06, side=0.5))
    yield from resting(made, rows, way=1e-8)
    yield below("largest distance across the seam [m]", rows[-1]["seam_gap"], 1e-3)
    yield below("crossings", rows[-1]["crossings"], 0)


CASES = {
    "stiff_seams": Case(stiff_seams),
    "sewn_the_wrong_way_round": Case(sewn_the_wrong_way_round),
}
