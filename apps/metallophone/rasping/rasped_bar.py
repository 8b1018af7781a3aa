"""A bar from which material comes off in the model: its tones by a solve on the mesh that it has."""

from dataclasses import replace
from types import TracebackType

import numpy as np
from restshape_apps.metallophone.rasping.outline_motion import on_plane
from restshape_apps.metallophone.rasping.outline_places import LEAST_AREA
from restshape_apps.metallophone.rasping.places import Place

from restshape.analysis.frame import Frame
from restshape.analysis.modal.modal import ModalAnalysis
from restshape.errors import ReplayProblem
from restshape.mesh.quality import areas

NO_CELLS = np.empty(0, dtype=np.int32)


class RaspedBar:
    """Solves for a bar with material off, and puts it back as it was at the end of a `with`.

    Args:
        analysis: solved on the mesh as it lies; its mesh and its modes go along.
        ranks: of the modes whose tones are wanted, from 0; each is followed by its shape.

    Attributes:
        solves: how many there were.
    """

    def __init__(self, analysis: ModalAnalysis, ranks: list[int]) -> None:
        self.analysis, self.solves, self._modes = analysis, 0, analysis.state.modes
        self._ids = [int(analysis.state.ids[rank]) for rank in ranks]
        self._X, self._corners = analysis.state.space.X.copy(), analysis.state.space.mesh.X.copy()

    def __enter__(self) -> "RaspedBar":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._shape(self._X, np.zeros(len(self._X)))
        if kind is None:
            self._solve()

    def frequencies(self, places: list[Place], depths: np.ndarray) -> np.ndarray:
        """The frequencies (modes,) [Hz] with depths [m] off places, from the bar as it was.

        Raises:
            ReplayProblem: nothing is left somewhere, or a mode cannot be followed so far.
        """
        moved, off = np.zeros_like(self._corners), np.zeros(len(self._X))
        for place, depth in zip(places, depths):
            if place.underneath:
                off += float(depth) * on_plane(self.analysis, np.column_stack([place.off, place.off]))[:, 0]
            else:
                moved += float(depth) * place.motion
        self._refuse_poor(moved)
        self._shape(self._X + on_plane(self.analysis, moved), off)
        self._solve()
        self.solves += 1
        ids = self.analysis.state.ids.tolist()
        lost = [own for own in self._ids if own not in ids]
        if lost:
            raise ReplayProblem(f"mode {lost[0]} is not among the lowest {len(ids)} modes any more")
        return self.analysis.frequencies[[ids.index(own) for own in self._ids]]

    def most_alike(self, places: list[Place]) -> float:
        """The largest depth [m] off all places alike that their limits and the mesh allow; 0 where it allows none.

        Stretches that meet thin the same triangles, so that together less comes off than off each alone.
        """
        limit = min(place.limit for place in places)
        motion = sum((place.motion for place in places), np.zeros_like(self._corners))
        before = areas(self._corners, self.analysis.state.space.mesh.cells)
        for depth in limit * np.linspace(1.0, 0.0, 41)[:-1]:
            after = areas(self._corners + depth * motion, self.analysis.state.space.mesh.cells)
            if (after >= LEAST_AREA * before).all():
                return float(depth)
        return 0.0

    def _refuse_poor(self, moved: np.ndarray) -> None:
        """Make sure that displacements (n, 2) of the corners from where they were leave the mesh a good one.

        Raises:
            ReplayProblem: they do not.
        """
        cells = self.analysis.state.space.mesh.cells
        if (areas(self._corners + moved, cells) < LEAST_AREA * areas(self._corners, cells)).any():
            raise ReplayProblem("so much off the outline leaves triangles of little area; use a coarser mesh")

    def _shape(self, X: np.ndarray, off: np.ndarray) -> None:
        """Put the nodes of the plane mesh at places (n2, 2), with depths (n2,) off underneath."""
        space, body = self.analysis.state.space, self.analysis.state.body
        mesh = space.mesh
        space.X[...] = X
        if mesh is not space:
            mesh.X[...] = X[space.corner_number]
        mesh.geometry += 1
        if "z" in body.axes:
            body.take_off(off)

    def _solve(self) -> None:
        """Solve, the modes followed from those of the bar as it was: they do not depend on trials before."""
        self.analysis.state = state = replace(self.analysis.state, modes=self._modes, solved=self._modes)
        self.analysis.solve(Frame(state.space, NO_CELLS, None, state.scene, (None, (0.0, 0.0))))
