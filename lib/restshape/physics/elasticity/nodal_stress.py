"""Stresses of plane solids at nodes, which quantities, limits, error estimates and pictures share."""

from collections.abc import Collection, Mapping
from functools import cached_property

import numpy as np

from restshape import _kernels
from restshape.fem.problem import Fields
from restshape.fem.recovery import NodalFlux
from restshape.fem.space import Space
from restshape.first_use import made
from restshape.physics.elasticity.stress import COMPONENTS, PlaneStresses
from restshape.scene.model import Quantity

PICTURED = "von_mises"
"""The component that is always recorded."""
STRAIN, STRAINS = "strain", ("xx", "yy", "xy", "zz")
REQUESTED: dict[str, tuple[str, ...]] = {
    "stress": ("xx", "yy", "xy", "zz"),
    "principal": ("max_principal", "min_principal", "principal_angle"),
    STRAIN: (),
}
"""What a scene may have recorded besides, and the components of stress that it names."""
IN_CELLS = "_in_cells"


SAMPLED, ENERGIES, NODAL = "sampled", "energies", "nodal"


class NodalStress:
    """Cauchy's stresses in cells and recovered at nodes, each computed once a state of the space and its displacement.

    What was asked for at one state is expected at the next, and computed together where one loop gives it: a predicted
    frame, of which nobody asks more than an extreme, writes neither the stresses of cells nor those of nodes. Energies
    wait for nothing that only estimates or recordings ask for, which come after the frame.

    Args:
        stresses: of the cells.
    """

    def __init__(self, stresses: PlaneStresses) -> None:
        self.stresses, self.space = stresses, stresses.space
        self._versions, self._x = (-1, -1), np.empty(0)
        self._found: dict[str, np.ndarray | None] = {}
        # Of the first state nobody knows what else will be asked for.
        self._asked, self._expected = set[str](), {NODAL}
        self._named: tuple[object, object, list[tuple[str, str]]] = (None, None, [])
        # Whether quantities look at nodal stresses at this state, and did at the last one.
        self._looks = self._looked = False

    @cached_property
    def recovery(self) -> NodalFlux:
        """What recovers them, made where they are asked for."""
        return NodalFlux(self.space)

    def sampled(self, x: np.ndarray) -> np.ndarray:
        """The stresses [Pa] that are recovered, (ne, 4) or (ne, 3, 4) inside the cells, at x (n, 2) [m]."""
        self._follow(x)
        return made(self._result(SAMPLED))

    def energies(self, x: np.ndarray) -> np.ndarray | None:
        """Strain energies (ne,) [J] of the cells at x (n, 2) [m]; None where they do not come with the stresses."""
        if not self.stresses.one_loop:
            return None
        self._follow(x)
        return self._result(ENERGIES)

    def __call__(self, x: np.ndarray) -> np.ndarray:
        """Recovered stresses [Pa] (rows, 4) in the rows of `recovery`: xx, yy, xy, zz, at x (n, 2) [m]."""
        self._follow(x)
        return made(self._result(NODAL))

    def component(self, name: str, x: np.ndarray) -> np.ndarray:
        """One of `COMPONENTS` [Pa] (rows,) at x (n, 2) [m], for a quantity; made once a state, not to be changed."""
        self._follow(x)
        self._looks = True
        return made(self._result(name))

    def _follow(self, x: np.ndarray) -> None:
        versions = self.space.topology, self.space.geometry
        if versions == self._versions and _kernels.same_bits(x, self._x):
            return
        if self._x.shape != x.shape:
            self._x = np.empty(x.shape)
        self._x[...] = x
        self._versions = versions
        self._found.clear()
        if self._asked:
            self._asked, self._expected = set(), self._asked
            self._looks, self._looked = False, self._looks

    def _result(self, name: str) -> np.ndarray | None:
        """What has this name at the present state: `SAMPLED`, `ENERGIES`, `NODAL`, or one of `COMPONENTS`."""
        self._asked.add(name)
        if name not in self._found:
            self._find(name)
        return self._found[name]

    def _find(self, name: str) -> None:
        found, wanted = self._found, self._asked | self._expected
        # Energies alone ask for no nodal stresses, nor do those in cells where these are there already.
        nodal = self._looked if name == ENERGIES else name != SAMPLED or NODAL not in found
        nodal = nodal and not {NODAL, PICTURED}.isdisjoint(wanted)
        recovers = self.stresses.one_loop and SAMPLED not in found and nodal
        if name in COMPONENTS and (name != PICTURED or NODAL in found or not recovers):
            found[name] = COMPONENTS[name](made(self._result(NODAL)))
        elif recovers:
            self._recover_triangles()
        elif name == NODAL:
            found[NODAL] = self.recovery(made(self._result(SAMPLED)))
        elif name == ENERGIES and SAMPLED not in wanted:
            found[ENERGIES] = self.stresses.energies(self._x)
        else:
            found[SAMPLED], found[ENERGIES] = self.stresses.with_energies(self._x, self.recovery.points)

    def _recover_triangles(self) -> None:
        """All that is asked for or expected, in one loop."""
        ne, rows, wanted = len(self.space.cells), len(self.recovery.nodes), self._asked | self._expected
        shapes = {ENERGIES: (ne,), SAMPLED: (ne, 4), NODAL: (rows, 4), PICTURED: (rows,)}
        room = {name: np.empty(shape) for name, shape in shapes.items() if name in wanted or name == ENERGIES}
        at = self.stresses
        self.recovery.patches.triangles(
            self.space.X, self._x, at.parameters, at.thins, room[ENERGIES], *map(room.get, (SAMPLED, NODAL, PICTURED))
        )
        self._found |= room

    def fields(self, x: np.ndarray, quantities: Mapping[str, Quantity], wanted: Collection[str] = ()) -> Fields:
        """What recordings hold of them at x (n, 2) [m]: von Mises' stress, what quantities name, what is wanted.

        Of one material by the nodes; where several regions meet a node has a stress on each side, and each cell its own
        values (ne, k) at its nodes.

        Args:
            x: displacement.
            quantities: of the scene.
            wanted: some of `REQUESTED`.
        """
        if quantities is not self._named[0] or wanted is not self._named[1]:
            self._named = quantities, wanted, _fields_of(quantities, wanted)
        self._follow(x)
        results, found = self._found, {}
        for field, name in self._named[2]:
            self._asked.add(name)
            if name not in results:
                self._find(name)
            found[field] = results[name]
        if STRAIN in wanted:
            strain = self.recovery(np.ascontiguousarray(self.stresses.strain(x, self.recovery.points)))
            found |= {f"{STRAIN}_{name}": strain[:, k] for k, name in enumerate(STRAINS)}
        if not self.recovery.jumps:
            return found, {}
        rows = self.recovery.cell_rows()
        return {}, {f"{name}{IN_CELLS}": values[rows] for name, values in found.items()}


def _fields_of(quantities: Mapping[str, Quantity], wanted: Collection[str]) -> list[tuple[str, str]]:
    """The fields of recordings with the components of stress in them; as of `NodalStress.fields`."""
    stresses = [name for key in wanted for name in REQUESTED[key]]
    named = dict.fromkeys((PICTURED, *(q.stress for q in quantities.values() if q.stress), *stresses))
    return [(field_name(name), name) for name in named]


def field_name(component: str, jumps: bool = False) -> str:
    """The name in recordings of a stress component; with jumps of one that cells have at their nodes."""
    name = component if len(component) > 2 else f"stress_{component}"
    return f"{name}{IN_CELLS}" if jumps else name


def blank_stress(space: Space) -> Fields:
    """The field that is always recorded, all NaN, on a space that has not been solved on."""
    jumps = len(np.unique(space.cell_region)) > 1
    shape = space.cells.shape if jumps else len(space.X)
    blank = {field_name(PICTURED, jumps): np.full(shape, np.nan)}
    return ({}, blank) if jumps else (blank, {})
