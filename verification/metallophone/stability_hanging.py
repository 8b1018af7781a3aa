"""Hard cases of hanging points: a hole on the nodal line, frequencies that part, a fork, a foil."""

from collections.abc import Iterator, Sequence

import numpy as np
from restshape_studies.stability.case import Case, Row, Statement, Trial, above, below, near, true, valid
from restshape_studies.stability.scenery import across, drag

from restshape.application import application

SCENES = application("metallophone").folder / "scenes"
HUNG = ("effects.modal.model=plate", "effects.modal.modes=4", "effects.modal.hanging={}")
STILL = 1e-28
"""What hanging may take from the mode on whose lines it is, over its mean: the square of rounding."""


def places_of(rows: Sequence[Row]) -> np.ndarray:
    """The hanging points (k, 2, 2) [m] of frames."""
    return np.array([[[row[f"hang_{i}_{axis}"] for axis in "xy"] for i in (1, 2)] for row in rows])


def hole_on_the_line(trial: Trial) -> Iterator[Statement]:
    """A hole of 6 mm is dragged over the nodal line of a bar: where it covers the place, its rim or beyond is taken."""
    start, radius = (0.03, 0.015), 0.003
    hole = {"do": "hole", "name": "cord", "center": list(start), "radius": radius}
    events = [hole, *drag("cord", start, across(start, (0.06, 0.015), 12))]
    rows = trial.rows(SCENES / "bar_200.toml", events, overrides=[*HUNG, 'mesh.size="5 mm"'])
    found, dragged = places_of(rows), [row for row in rows if row["event"] == "drag"]
    centres = np.array([start[0] + 0.03 * k / 12 for k in range(1, 13)])
    away = np.hypot(places_of(dragged)[:, 0, 0] - centres, places_of(dragged)[:, 0, 1] - start[1])
    yield above("distance from the hole's centre over its radius", float(away.min()) / radius, 0.98)
    # The hole takes 0.5 % of the bar.
    yield near("places along the bar", found[:, :, 0] / 0.2, [[0.2242, 0.7758]], 1e-2)
    yield below("energy of mode 1 there over its mean", max(row["hang_loss_1"] for row in rows), STILL)
    before, over = rows[0], max(row["hang_loss_3"] for row in dragged)
    yield true("torsion is taken from where the middle is covered, else not", before["hang_loss_3"] < 1e-3 < over, over)
    yield from valid(rows)


def square_parts(trial: Trial) -> Iterator[Statement]:
    """A free square is stretched: the lines of one of its pair are not fixed, then they are."""
    asked = ("effects.modal.modes=5", "effects.modal.hanging={mode=4}", "mesh.size=0.6")
    events = drag("right", (10.0, 5.0), [(10.0, 5.0), (10.002, 5.0), (10.3, 5.0), (10.6, 5.0)])
    rows = trial.rows(SCENES / "square.toml", events, overrides=asked)
    fixed = [row["hang_note"] == "" for row in rows if row["event"] == "drag"]
    yield true("no places while two frequencies coincide", not any(fixed[:2]), rows[0]["hang_note"])
    yield true("places once they have parted", all(fixed[2:]))
    last = places_of(rows)[-1]
    yield near("centre of mass on the line through both, by symmetry", last.mean(axis=0), [5.3, 5.0], 5e-2)
    yield from valid(rows)


FORK = """
[shape]
outline = ["heel", "right", "t1", "i1", "gap", "i2", "t2", "left"]
[shape.vertices]
a = [0, 0]
b = [0.04, 0]
c = [0.04, 0.12]
d = [0.028, 0.12]
e = [0.028, 0.06]
f = [0.012, 0.06]
g = [0.012, 0.12]
h = [0, 0.12]
[shape.edges]
heel = { line = ["a", "b"] }
right = { line = ["b", "c"] }
t1 = { line = ["c", "d"] }
i1 = { line = ["d", "e"] }
gap = { line = ["e", "f"] }
i2 = { line = ["f", "g"] }
t2 = { line = ["g", "h"] }
left = { line = ["h", "a"] }
"""


def fork(trial: Trial) -> Iterator[Statement]:
    """A fork of two equal tines, one of which is dragged longer and back: places on its axis, then as they were."""
    text = (SCENES / "bar_200.toml").read_text()
    scene = trial.folder / "fork.toml"
    scene.write_text(text[: text.index("[shape]")] + FORK + text[text.index("[material.") :])
    longer = across((0.034, 0.12), (0.034, 0.135), 4)
    events = drag("t1", (0.034, 0.12), [*longer, *longer[-2::-1], (0.034, 0.12)])
    rows = trial.rows(scene, events, overrides=[*HUNG, 'mesh.size="4 mm"'])
    found = places_of(rows)
    yield near("both places on the axis of the equal fork, x", found[0, :, 0], 0.02, 1e-2)
    yield true("they are found in each frame", not any(row["hang_note"] for row in rows))
    yield below("places back at the start, apart by [m]", float(np.abs(found[-1] - found[0]).max()), 1e-7)
    yield from valid(rows)


def foil(trial: Trial) -> Iterator[Statement]:
    """A bar of 0.5 mm, dragged longer: places at the same share of its length as those of one of 0.1 mm."""
    events = drag("right", (0.2, 0.015), across((0.2, 0.015), (0.24, 0.015), 4))
    found = []
    for thickness in ("0.5 mm", "0.1 mm"):
        thin = [*HUNG, 'mesh.size="6 mm"', f'material.aluminium.thickness="{thickness}"']
        rows = trial.rows(SCENES / "bar_200.toml", events, overrides=thin)
        lengths = np.array([row["q_area"] for row in rows])[:, None] / 0.03
        found.append(places_of(rows)[:, :, 0] / lengths)
        yield from valid(rows)
    yield near("places along the bar", found[0], found[1], 1e-3)
    # Across the bar its lines are bent by lateral contraction.
    yield near("places of a free beam", found[0], [[0.2242, 0.7758]], 1e-2)


CASES: dict[str, Case] = {
    "hanging_hole_on_the_line": Case(hole_on_the_line),
    "hanging_square_parts": Case(square_parts),
    "hanging_fork": Case(fork),
    "hanging_foil": Case(foil),
}
