"""A scene tuned to a tone: its freedoms, its modes, the descent."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from restshape_apps.metallophone.rasping.tolerances import Tolerances, tolerances
from restshape_apps.metallophone.tuning.bar import Bar
from restshape_apps.metallophone.tuning.bending import bending_modes
from restshape_apps.metallophone.tuning.descent import Descent, Tuned, TuningStep
from restshape_apps.metallophone.tuning.freedoms import (
    Freedom,
    fixed_curves,
    freedoms_of,
    keys_of,
    with_fixed_curves,
    with_values,
)
from restshape_apps.metallophone.tuning.wanted import Wanted
from restshape_apps.metallophone.tuning.written import written

from restshape.analysis.settings import modal_settings
from restshape.application import application_of
from restshape.errors import UserError
from restshape.scene.load import revise
from restshape.scene.model import Scene
from restshape.scene.plan import plan
from restshape.scene.units import UnitError, quantity

SOLVES = 12
"""Most solves for one tone."""
SOLVES_OF_RATIOS = 25
"""Most solves for ratios."""
ABOVE = 3
"""Modes beyond the tuned one that are computed at least: it may rise across them."""
MOST_MODES = 40


@dataclass(frozen=True, eq=False)
class Tuning:
    """A tuned scene.

    Args:
        scene: as it was; wanted: tones; freedoms: that changed; found: what came of it.
        ranks: of the tuned modes at the start, from 1.
        solves: of eigenproblems in all.
        tolerances: of the tuned bar, for these modes.
        errors: (m,) [cents] estimated of the mesh, of the tuned modes.
        below: frequencies [Hz] of its modes below the first of them.
    """

    scene: Scene
    wanted: Wanted
    freedoms: tuple[Freedom, ...]
    found: Tuned
    ranks: tuple[int, ...]
    solves: int
    tolerances: Tolerances
    errors: tuple[float, ...]
    below: tuple[float, ...]

    def changes(self) -> list[tuple[tuple[str, ...], object]]:
        """Keys of the scene's file with their new values; curves of edges are written out where the outline moves."""
        moves = any(freedom.key[0] in ("shape", "parameters") for freedom in self.freedoms)
        curves = fixed_curves(self.scene) if moves else []
        values = zip(self.freedoms, self.found.last.values)
        return [*curves, *((one.key, written(self.scene, one.key, float(value))) for one, value in values)]


def tuned(
    scene: Scene,
    wanted: Wanted,
    by: Sequence[str] = (),
    bounds: Sequence[str] = (),
    ranks: Sequence[int] = (),
    most: int | None = None,
    on_step: Callable[[TuningStep], None] = lambda step: None,
) -> Tuning:
    """Tune a scene.

    Args:
        scene: of a bar; wanted: tones.
        by: words for freedoms; none: all points of the outline.
        bounds: "KEY=LOW:HIGH".
        ranks: of the modes that are tuned, from 1; none: the first, and bending modes for overtones.
        most: solves; None: as many as the kind of tuning is given.
        on_step: called with each step.

    Raises:
        UserError: see `freedoms_of`, `Descent`; or the scene has not so many bending modes.
    """
    fixed = with_fixed_curves(scene)
    freedoms = freedoms_of(fixed, by)
    given = _bounds(freedoms, bounds, fixed)
    bar, indices = _started(fixed, freedoms, wanted, ranks)
    ids = [int(bar.analysis.state.modes.ids.ids[index]) for index in indices]
    most = most or (SOLVES if len(ids) == 1 else SOLVES_OF_RATIOS)
    descent = Descent(bar, ids, np.array(wanted.frequencies), given, most, on_step)
    found = descent.run()
    solves, order = bar.solves, _order(bar, found.last.values)
    ranks_now = [order.index(one) + 1 for one in descent.modes.ids if one in order]
    below = bar.analysis.frequencies[: min(ranks_now, default=1) - 1].tolist()
    return Tuning(
        scene=scene,
        wanted=wanted,
        freedoms=tuple(freedoms),
        found=found,
        ranks=tuple(int(index) + 1 for index in indices),
        solves=solves,
        tolerances=tolerances(bar.analysis).of(ranks_now),
        errors=bar.errors(ranks_now),
        below=tuple(below),
    )


def _order(bar: Bar, values: np.ndarray) -> list[int]:
    """Ids of the modes, by rank, at values (k,) of the freedoms."""
    if bar.now != with_values(bar.scene, bar.freedoms, values):
        bar.at(values)
    ids: list[int] = bar.analysis.state.ids.tolist()
    return ids


def _started(scene: Scene, freedoms: Sequence[Freedom], wanted: Wanted, ranks: Sequence[int]) -> tuple[Bar, list[int]]:
    """The bar with enough modes, and the indices of those that are tuned."""
    count = len(wanted.ratios)
    asked = modal_settings(plan(scene, application_of(scene))).modes
    if ranks and len(ranks) != count:
        raise UserError(f"{len(ranks)} modes for {count} tones", "--modes", "name a mode for each tone")
    modes = max(asked, max(ranks, default=1) + ABOVE, 1 if count == 1 else 3 * count + ABOVE)
    while True:
        bar = Bar(revise(scene, "effects.modal.modes", min(modes, MOST_MODES)), freedoms)
        chosen = bar.analysis.state.modes.chosen
        if ranks:
            return bar, [int(chosen[rank - 1]) for rank in ranks]
        if count == 1:
            return bar, [int(chosen[0])]
        bending = [index for index in bending_modes(bar.analysis) if index in chosen]
        if len(bending) > count or (len(bending) == count and bending[-1] < chosen[-ABOVE]):
            return bar, bending[:count]
        if modes >= MOST_MODES:
            what = f"only {len(bending)} of the {MOST_MODES} lowest modes bend the bar along its length"
            raise UserError(what, "--overtones", "say which modes are tuned, by rank: --modes 1:3:6")
        modes = min(2 * modes, MOST_MODES)


def _bounds(freedoms: Sequence[Freedom], words: Sequence[str], scene: Scene) -> np.ndarray:
    """The bounds (k, 2) that are given; not a number elsewhere.

    Raises:
        UserError: one cannot be read, crosses, or is of no freedom.
    """
    found = np.full((len(freedoms), 2), np.nan)
    for word in words:
        where = f"--bound {word}"
        name, _, interval = word.partition("=")
        ends = interval.split(":")
        keys = keys_of(scene, name) if len(ends) == 2 else []
        places = [k for k, one in enumerate(freedoms) if one.key in keys]
        if not places:
            what = f"{name!r} is no freedom of this tuning" if keys else "this is no bound"
            names = ", ".join(one.name for one in freedoms[:6])
            raise UserError(what, where, f"write KEY=LOW:HIGH, with a key such as {names}")
        try:
            dimension = "length" if freedoms[places[0]].key[0] in ("shape", "material") else None
            low, high = (quantity(end, dimension) for end in ends)
        except UnitError as error:
            raise UserError(str(error), where, "write KEY=LOW:HIGH, such as 2 mm:5 mm") from error
        if low >= high:
            raise UserError(f"the bounds cross: {ends[0]} is not below {ends[1]}", where, "write the lower one first")
        beyond = [k for k in places if not low <= freedoms[k].start <= high]
        if 0 < len(beyond) < len(places):
            first = freedoms[beyond[0]]
            names = ", ".join(freedoms[k].name for k in places if k not in beyond)
            what = f"this binds {len(places)} numbers, and {first.name} is {first.start:g}"
            raise UserError(what, where, f"bind one alone: --bound {names.split(', ')[0]}={interval}")
        found[places] = low, high
    return found
