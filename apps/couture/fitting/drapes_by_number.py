"""Drapes of one scene by numbers of it: each goes on from the last that was kept, with its derivatives."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from restshape.analysis.frame import Frame
from restshape.errors import ReplayProblem, UserError
from restshape.interface.first_frame import replayed_to
from restshape.mesh.mesh import Mesh
from restshape.physics.cloth.drape_shadow import DrapeShadow, ShadowEdge
from restshape.physics.cloth.relaxation.relaxation_analysis import RelaxationAnalysis
from restshape.physics.cloth.relaxation.state import RelaxationState
from restshape.physics.cloth.sensitivity.scene_numbers import ChangingNumber
from restshape.scene.given_numbers import unit_at, value_below
from restshape.scene.load import revise
from restshape.scene.model import Scene
from restshape.scene.source import split_key

TOLERANCE = 1e-6
"""Of derivatives, relative to their right sides."""
STEP = 1e-3
"""Of differences, a share of a number."""
TIGHT = 1e-6
"""Residual over the weight at rest: misfits are compared beyond what the usual tolerance leaves."""
NO_CELLS = np.empty(0, dtype=np.int32)


@dataclass(frozen=True, eq=False)
class Drape:
    """A drape at rest.

    Args:
        values: (k,) of the numbers [SI].
        edge: of its shadow; area: of the shadow [m^2]; folds: around it.
        state: to go on from.
    """

    values: np.ndarray
    edge: ShadowEdge
    area: float
    folds: int
    state: RelaxationState


class SetByEdits(UserError):
    """Edits set a number that drapes are asked for by."""


class DrapesByNumber:
    """Drapes of a scene, or of a frame of its edits, by numbers of it.

    Args:
        scene: of cloth; edits: script, or None; frame: number of its frame, None: the last one.
        keys: of the numbers.

    Attributes:
        start: (k,) the values in the scene.
        count: of drapes that were solved for; by_differences: keys that had no derivative, with the reason.

    Raises:
        UserError: one of the keys names no number, or one that changes the pattern, or is there twice.
    """

    def __init__(self, scene: Scene, keys: Sequence[str], edits: Path | None = None, frame: int | None = None) -> None:
        twice = next((key for key in keys if list(keys).count(key) > 1), None)
        if twice:
            raise UserError(f"{twice} is named twice", "--by", "name each number once")
        self.scene, self.keys, self.edits, self.frame = _resting(scene), tuple(keys), edits, frame
        self.count, self.by_differences = 0, dict[str, str]()
        self._analysis: RelaxationAnalysis | None = None
        self._shadow: DrapeShadow | None = None
        self._shown: RelaxationState | None = None
        self._middle = np.zeros(2)
        self.start = np.array([number.value for number in self._numbers(self.scene)])

    def _changing(self, scene: Scene) -> list[ChangingNumber]:
        from restshape.application import application_of
        from restshape.scene.plan import plan

        own = plan(scene, application_of(scene))
        return [ChangingNumber(scene, own, key) for key in self.keys]

    def _numbers(self, scene: Scene) -> list[ChangingNumber]:
        found = self._changing(scene)
        for number in found:
            other = number.scene_with(number.value * (1.0 + STEP))
            if (other.shape, other.panels, other.mesh) != (scene.shape, scene.panels, scene.mesh):
                what = f"{number.key} changes the pattern or its mesh, and not the fabric"
                raise UserError(what, "--by", "name a number such as material.cotton.bending")
        return found

    def with_values(self, scene: Scene, values: Sequence[float]) -> Scene:
        """A scene with values of the numbers."""
        from restshape.application import application_of
        from restshape.scene.plan import plan

        for key, value in zip(self.keys, values):
            scene = ChangingNumber(scene, plan(scene, application_of(scene)), key).scene_with(float(value))
        return scene

    def changes(self, values: Sequence[float]) -> list[tuple[tuple[str, ...], Any]]:
        """Keys of the scene with values of the numbers; whole lists where it has none, as with fabrics by name."""
        found, after = dict[tuple[str, ...], Any](), self.with_values(self.scene, values)
        for key, value in zip(self.keys, values):
            *whole, last = key.split(".")
            new = last.isdigit() and value_below(self.scene.raw, tuple(whole)) is None
            found[tuple(whole) if new else (*whole, last)] = value_below(after.raw, tuple(whole)) if new else value
        return list(found.items())

    def cold(self, values: np.ndarray) -> Drape:
        """The drape that a replay of the scene with these values finds.

        Raises:
            UserError: it is not at rest, or the values do not suit the scene.
            SetByEdits: the edits set one of the numbers.
        """
        replay = replayed_to(self.with_values(self.scene, values), self.edits, self.frame)
        self._analysis = replay.analysis
        state, mesh = replay.analysis.state, replay.analysis.space
        self._refuse_edits(state.scene, values)
        self._shadow = DrapeShadow.of(mesh)
        self._middle = self._shadow.middle(state.problem.corners(state.x))
        self.count += 1
        if not state.report.converged:
            what = f"the drape at {self.words(values)} does not come to rest: {state.report.why}".rstrip(": ")
            raise UserError(what, str(self.scene.path), "begin at other values (--set), or make it rest in a replay")
        return self._seen(values)

    def _refuse_edits(self, scene: Scene, values: np.ndarray) -> None:
        """Refuse edits after which the numbers of the scene are not those that were given."""
        for number, value in zip(self._changing(scene), values):
            if not np.isclose(number.value, value, rtol=1e-9, atol=0.0):
                what = f"the edits set {number.key}, which is to be fitted"
                raise SetByEdits(what, str(self.edits), "take that event out, or name an earlier frame (--frame)")

    def near(self, drape: Drape, values: np.ndarray) -> Drape | None:
        """The drape with other values that is found from one; None: they do not suit, or it does not come to rest."""
        self._show(drape)
        self.count += 1
        try:
            scene = self.with_values(self._analysis.state.scene, values)
            self._analysis.solve(self._frame_of(scene))
        except (UserError, ReplayProblem):
            self._shown = None
            return None
        if not self._analysis.state.report.converged:
            self._shown = None
            return None
        return self._seen(values)

    def rates(self, drape: Drape) -> np.ndarray:
        """Rates (directions, k) of the radii of a drape's shadow, a unit of each number."""
        found = []
        for k, key in enumerate(self.keys):
            self._show(drape)
            try:
                s = self._analysis.number_derivatives([key], TOLERANCE).s[0]
            except (UserError, ReplayProblem) as problem:
                self.by_differences[key] = problem.what if isinstance(problem, UserError) else str(problem)
                found.append(self._difference(drape, k))
                continue
            found.append(drape.edge.radius_rates(self._analysis.problem.corners(s)))
        return np.stack(found, axis=1)

    def _difference(self, drape: Drape, k: int) -> np.ndarray:
        """Rates of the radii by one number, by central differences.

        Raises:
            UserError: there is no drape beside this one.
        """
        step = STEP * abs(drape.values[k])
        ends = [self.near(drape, drape.values + sign * step * np.eye(len(self.keys))[k]) for sign in (1.0, -1.0)]
        if ends[0] is None or ends[1] is None:
            what = f"there is no derivative by {self.keys[k]}, and no drape beside {self.words(drape.values)}"
            raise UserError(what, "--by", "name another number, or begin elsewhere")
        return (ends[0].edge.radii - ends[1].edge.radii) / (2.0 * step)

    def words(self, values: Sequence[float]) -> str:
        """The numbers with values [SI]."""
        units = [unit_at(self.scene, split_key(key)) for key in self.keys]
        return ", ".join(f"{key} = {value:.4g} {unit}".rstrip() for key, value, unit in zip(self.keys, values, units))

    def _seen(self, values: np.ndarray) -> Drape:
        state = self._analysis.state
        places = state.problem.corners(state.x)
        self._shown = self._analysis.kept_answer()
        edge = self._shadow.edge(places, self._middle)
        kept = self._shown
        return Drape(np.array(values, float), edge, self._shadow.area(places), self._shadow.folds(places), kept)

    def _show(self, drape: Drape) -> None:
        """Have a drape again."""
        if self._shown is not drape.state:
            self._analysis.restore(drape.state, self._frame_of(drape.state.scene))
            self._shown = drape.state

    def _frame_of(self, scene: Scene) -> Frame:
        return Frame(self._analysis.space, NO_CELLS, None, scene, (None, (0.0, 0.0)))

    @property
    def mesh(self) -> Mesh:
        """The flat cloth of the last drape."""
        return self._analysis.space

    @property
    def constrained(self) -> np.ndarray:
        """Places (k, 2) [m] of the nodes that supports hold along x and y."""
        state = self._analysis.state
        problem = state.problem
        return problem.corners(state.x)[problem.supports.mask[:, :2].all(axis=1), :2]


def _resting(scene: Scene) -> Scene:
    """The scene at rest as exactly as misfits ask for."""
    own = scene.raw.get("effects", {}).get("drape", {})
    key = "effects.drape.tolerance" if "tolerance" in own else "solve.tolerance"
    from restshape.application import application_of
    from restshape.scene.plan import plan

    now = plan(scene, application_of(scene)).settings("drape").tolerance
    return scene if now <= TIGHT else revise(scene, key, TIGHT)
