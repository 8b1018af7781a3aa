"""What frames of a scene without an effect may call, from first principles: nothing else is to be found in them.

A body has one matrix a physics; its pattern is that of nodes which share a cell. A frame that moves the body runs over
its cells once a matrix, and once over the edges of a load. All this follows from the text of the scene and the mesh.
"""

from typing import Any

import numpy as np

LARGE = "[effects.large_deformation]\n"
SIDE = 4
"""Edges of the mesh on the loaded side: it is 1 m long, in steps of 0.25 m."""
NEVER = ("MatLUFactorSym", "MatLUFactorNum", "MatILUFactorSym", "MatICCFactorSym", "KSPGMRESOrthog", "RestshapePatch")
NEWTON = ("SNESSolve", "SNESFunctionEval", "SNESJacobianEval")

Row = dict[str, Any]


def pairs(cells: np.ndarray) -> int:
    """How many pairs of different nodes share a cell: the edges, where the cells are of the first order."""
    nodes = cells.shape[1]
    both = np.concatenate([cells[:, [a, b]] for a in range(nodes) for b in range(a)])
    return len(np.unique(np.sort(both, axis=1), axis=0))


class Law:
    """What is called for a scene, whose effects are read off its text.

    Args:
        app: name of the application.
        text: of the scene.
        cells: (ne, nodes) of the body at the start.
        nodes: how many there are.
    """

    def __init__(self, app: str, text: str, cells: np.ndarray, nodes: int) -> None:
        self.moving, self.modal = app == "vibration", app == "metallophone"
        self.large = LARGE in text or app == "cantilever"
        self.pulled, self.stresses = "[loads.pull]" in text, "stress =" in text
        self.heavy = "[effects.gravity]" in text
        shape = {3: "tri3", 6: "tri6", 4: "tet4"}[cells.shape[1]]
        self.traction = {"tri3": "traction_edge2", "tri6": "traction_edge3"}.get(shape, "")
        self.law = f"{'stvk' if self.large else 'linear_elastic'}_{shape}"
        self.mass = f"mass_{shape}" if self.moving or self.modal else ""
        fields = 3 if self.modal else 2
        # Two matrices where the eigenvalues or the steps of a linear motion need both; else one.
        self.matrices = 2 if self.modal or (self.moving and not self.large) else 1
        self.cells, self.unknowns = len(cells), fields * nodes
        self.entries = self.matrices * fields**2 * (nodes + 2 * pairs(cells))

    def hold(self, rows: list[Row]) -> None:
        """Hold the first frame and those of level 1 against what they may do."""
        moved = [row for row in rows if row["level"] == 1]
        assert moved and rows[0]["level"] == 3
        for row in (rows[0], *moved):
            found = (row["unknowns"], row["elements"], row["entries"])
            assert found == (self.unknowns, self.cells, self.entries)
            events, first = row["events"], row is rows[0]
            assert events["RestshapePattern"] == (self.matrices if first else 0)
            assert not any(events[name] for name in NEVER)
            (self._hold_large if self.large else self._hold_linear)(row, first)

    def _hold_linear(self, row: Row, first: bool) -> None:
        events, calls = row["events"], row["calls"]
        assert calls == self._linear(first)
        assert not any(events[name] for name in NEWTON)
        assert events["EPSSolve"] == int(self.modal and first)
        # The first frame of a motion takes no step, and so needs no mass matrix but that in the matrix of steps.
        assert events["RestshapeValues"] == (1 if self.moving and first else self.matrices)
        if not self.modal:
            solves = (0 if first else 2) if self.moving else 1
            # A factor that has grown too old is met in a solve of its own.
            assert solves <= events["KSPSolve"] <= solves + row["pc_rebuilt"]
            assert events["MatCholFctrNum"] <= row["pc_rebuilt"]

    def _linear(self, first: bool) -> dict[str, dict[str, tuple[int, int]]]:
        """Calls in a frame of a linear body."""
        found = {self.law: {"tangent": (1, self.cells)}}
        if self.mass:
            # In the matrix of steps and alone; a plate's modes need it alone.
            times = 1 if first or self.modal else 2
            found[self.mass] = {"tangent": (times, times * self.cells)}
        if self.moving and self.heavy:
            # The weight, which stays the same in all steps of a frame.
            found[self.law]["residual"] = (1, self.cells)
        if self.stresses:
            found[self.law]["stress"] = (1, self.cells)
        return found | self._beside(1)

    def _beside(self, times: int) -> dict[str, dict[str, tuple[int, int]]]:
        """Calls for loads, evaluated so many times, and for stresses."""
        found = {}
        if self.pulled:
            found[self.traction] = {"residual": (times, times * SIDE)}
        if self.stresses:
            found["recover"] = {"field": (1, self.cells)}
        return found

    def _hold_large(self, row: Row, first: bool) -> None:
        """Hold a frame of Newton's method: a tangent each time that there are values, a residual each time it asks."""
        events, calls = row["events"], {name: dict(purposes) for name, purposes in row["calls"].items()}
        for name, wanted in self._beside(2 if self.moving else 1).items():
            assert calls.pop(name) == wanted
        assert set(calls) <= {self.law, self.mass, "inverted_cells"} - {""}
        for purposes in calls.values():
            for times, elements in purposes.values():
                assert elements == times * self.cells
        body, inertia = calls[self.law], calls.get(self.mass, {})
        purposes = {"residual", "tangent"} | ({"energy"} if self.moving else set())
        purposes |= {"stress"} if self.stresses else set()
        assert set(body) <= purposes and set(inertia) <= purposes
        assert events["EPSSolve"] == 0

        def times(purpose: str, of: dict[str, tuple[int, int]]) -> int:
            return of.get(purpose, (0, 0))[0]

        assert times("tangent", body) == events["RestshapeValues"]
        if self.moving:
            # Inertia has a part in all that the body has, but in the dead loads, of body and equations.
            assert times("tangent", inertia) == times("tangent", body)
            assert times("energy", inertia) == times("energy", body)
            assert times("residual", body) - times("residual", inertia) == 2
        else:
            assert times("stress", body) == self.stresses
            # Each evaluation is one pass over the cells, with the tangent or without. One more begins a frame, and the
            # first one ends with the tangent that shows whether the body is stable.
            passes = times("residual", body) + times("tangent", body)
            assert passes == events["SNESFunctionEval"] + (2 if first else 1)
