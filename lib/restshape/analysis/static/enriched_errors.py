"""Errors of quantities without a derivative: what they are away from their values on the next richer space."""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from restshape.analysis.static.enriched_solution import EnrichedSystem
from restshape.fem.enrichment import Enrichment
from restshape.fem.extremes import Extreme

if TYPE_CHECKING:
    from restshape.analysis.static.linear_state import Estimated
    from restshape.fem.observer import Function
    from restshape.mesh.lagrange_space import LagrangeSpace
    from restshape.mesh.mesh import Mesh
    from restshape.scene.model import Scene


class EnrichedErrors:
    """Estimates the errors of stresses, extremes, values at points and distances: one solution on an `Enrichment`.

    Args:
        analysis: whose state they are of.
    """

    def __init__(self, analysis: Estimated) -> None:
        self.analysis = analysis
        self._kept: tuple[tuple[Mesh | LagrangeSpace, int] | None, Enrichment | None] = (None, None)
        self._scene: Scene | None = None
        self._system: EnrichedSystem | None = None

    def follow(self, wanted: bool) -> Enrichment | None:
        """The problem of the scene on the next richer space, kept for as long as mesh topology stays, as the mesh lies.

        None where there is none, and where it is not wanted: at second order, if no load and no support varies.
        """
        state = self.analysis.state
        space = state.mesh
        if space is None or space is not state.problem.space or not self._useful(space, wanted):
            self._kept = (None, None)
            return None
        key, (known, kept) = (space, space.topology), self._kept
        make = partial(self.analysis.make, state.scene, state.plan)
        if kept is None or known != key:
            kept = Enrichment(space, make)
            self._kept = (key, kept)
        elif self._scene != state.scene:
            kept.pose(make)
        else:
            kept.follow()
        self._scene = state.scene
        return kept

    def _useful(self, space: Mesh | LagrangeSpace, wanted: bool) -> bool:
        """Whether there is a richer space that says more; a mesh is its own space, of first order."""
        if space is space.mesh:
            return not space.mesh.hierarchy
        return wanted or self.analysis.state.problem.varies

    def __call__(self, names: Iterable[str]) -> dict[str, float]:
        """The estimated sizes of the errors at the last solution, which `follow` has met."""
        (known, richer), state, analysis = self._kept, self.analysis.state, self.analysis
        if known is None or richer is None:
            return dict.fromkeys(names, np.nan)
        if self._system is None or self._system.enrichment is not richer:
            self._system = EnrichedSystem(richer, analysis.solver, state.system, analysis.context.policy.backend)
        unknowns = self._system.solution(state.x, state.problem.boundary.mask == 0, known[0].geometry)
        quantities = {name: state.scene.quantities[name] for name in names}
        functions = richer.problem.observer(quantities).functions
        return {
            name: abs(_value(functions[name], unknowns) - float(state.observer.functions[name](state.x)))
            for name in quantities
        }


def _value(function: Function, unknowns: np.ndarray) -> float:
    """A quantity of unknowns of second order, whose extreme may lie between the nodes."""
    if isinstance(function, Extreme):
        return float(function.between_nodes(unknowns)) if np.isfinite(unknowns).all() else np.nan
    return float(function(unknowns))
