"""What a vibrating body shows at the hand: resonance curve with its modes, and the motion of the last frames."""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING, cast

import numpy as np
from restshape_apps.vibration.harmonic_sweep import modal_sweep
from restshape_apps.vibration.stage import structure_of

from restshape.analysis.motion.modes_beside import present_modes
from restshape.live.kept_marks import kept, of_answers
from restshape.live.shape_marks import shape_marks
from restshape.live.shown_marks import Chart, Mark
from restshape.replay.columns import SIMULATED, quantity_column

if TYPE_CHECKING:
    from restshape.analysis.motion.transient import TransientAnalysis
    from restshape.analysis.row_values import RowValues
    from restshape.arrays import Reals
    from restshape.interface.simulation import Simulation
    from restshape.scene.model import Scene

MODES, SHOWN = 8, 3
"""Modes that the curve adds up, and those that are marked."""
POINTS = 160
"""Frequencies of the curve that are evenly spaced."""
FRAMES = 240
"""Frames of the motion that are shown."""
ROOM = 1.25
"""How far the curve goes beyond the last frequency that is marked."""


@of_answers
def resonance_marks(simulation: Simulation) -> list[Mark]:
    """The marks of the last frame of a body that vibrates."""
    return [*shape_marks(simulation), *kept(simulation, ResonanceMarks)(simulation)]


class ResonanceMarks:
    """Makes the charts of each frame.

    The resonance curve is that of the shape when no hand held it last: its modes take longer than a frame.
    """

    def __init__(self) -> None:
        self._of: tuple[object, ...] = ()
        self._curve: list[Mark] = []
        self._motion: deque[tuple[float, ...]] = deque(maxlen=FRAMES)

    def __call__(self, simulation: Simulation) -> list[Mark]:
        """The charts of the last frame."""
        replay, row = simulation.replay, simulation.frame.row
        if not replay.solver.known:
            return self._curve
        analysis, scene = cast("TransientAnalysis", replay.analysis), replay.session.scene
        state = analysis.state
        of = state.body, scene, state.topology, state.geometry
        if replay.session.grabbed is None and row["event"] != "set" and not _equal(of, self._of):
            self._of, self._curve = of, _resonance(analysis, scene)
        return [*self._curve, *self._response(scene, row)]

    def _response(self, scene: Scene, row: RowValues) -> list[Mark]:
        """The displacements of the last frames over the simulated time."""
        names = [name for name, one in scene.quantities.items() if one.displacement in ("x", "y")]
        now = float(row[SIMULATED])
        while self._motion and self._motion[-1][0] >= now:
            self._motion.pop()
        self._motion.append((now, *(float(row[quantity_column(name)]) for name in names)))
        if not names or len(self._motion) < 2 or len(self._motion[0]) != len(names) + 1:
            return []
        time, *values = np.array(self._motion).T
        curves = {name: (time, value) for name, value in zip(names, values)}
        return [Chart("motion of the last frames", "time [s]", "displacement [m]", curves)]


def _equal(these: tuple[object, ...], those: tuple[object, ...]) -> bool:
    return len(these) == len(those) and all(a is b or (isinstance(a, int) and a == b) for a, b in zip(these, those))


def _resonance(analysis: TransientAnalysis, scene: Scene) -> list[Mark]:
    """Amplitudes under a ground acceleration of 1 m/s^2; nothing of large deformations, which have no such curve."""
    if "large_deformation" in scene.effects:
        return []
    if not any(one.displacement in ("x", "y") for one in scene.quantities.values()):
        return []
    shape, modes = structure_of(analysis, scene), present_modes(analysis, MODES)
    ground = analysis.state.plan.settings("ground")
    driven = None if ground is None else ground.frequency
    marked = {f"mode {k}": float(f) for k, f in enumerate(modes.frequencies[:SHOWN], 1)}
    if driven:
        marked["excitation"] = float(driven)
    found = modal_sweep(shape, modes, 0.0, ROOM * max(marked.values()), POINTS)
    sizes = _different({name: np.abs(values) for name, values in found.relative.items()})
    shown = {name: (one > 0.0) & np.isfinite(one) for name, one in sizes.items()}
    curves = {name: (found.frequencies[own], sizes[name][own]) for name, own in shown.items() if own.any()}
    label = "amplitude [m] under 1 m/s² of the ground"
    return [Chart("resonance curve", "frequency of the ground [Hz]", label, curves, marked, logarithmic=True)]


def _different(curves: dict[str, Reals]) -> dict[str, Reals]:
    """Curves of which no two are the same, as those of a quantity and of its peak are; the names of both are kept."""
    found: dict[str, Reals] = {}
    for name, values in curves.items():
        same = next((other for other, one in found.items() if np.array_equal(one, values)), None)
        if same is None:
            found[name] = values
        else:
            found = {f"{other}, {name}" if other == same else other: one for other, one in found.items()}
    return found
