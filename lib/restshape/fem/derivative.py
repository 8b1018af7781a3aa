"""How quantities of interest follow the unknowns: the right sides of their dual problems."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from restshape.fem.averages import node_weights
from restshape.fem.edge_reactions import EdgeReactions
from restshape.fem.extremes import EXTREMES, Extreme
from restshape.fem.integral import Integral
from restshape.fem.observer import Function
from restshape.fem.problem import SteadyProblem
from restshape.fem.space import PlaneSpace
from restshape.scene.model import Quantity


@dataclass(frozen=True, eq=False)
class Derivative:
    """Of a quantity J with respect to unknowns x: J'(v) = load . v + lift . K v, of changes v that supports admit.

    Args:
        load: (n, f).
        lift: (n, f) weights of reactions, 0 at free unknowns; None: no reaction is in it.
        energy: cells of which J is the energy, so that it has a second derivative; None: it is linear.
    """

    load: np.ndarray
    lift: np.ndarray | None = None
    energy: np.ndarray | slice | None = None


@dataclass(frozen=True, eq=False)
class Differentiable:
    """A function of a state, a quantity, with its derivative.

    Args:
        value: of the state.
        derivative: at unknowns (n, f) that solve a linear problem.
        nodes: gives those (k,) whose unknowns alone it hangs on; None: it may hang on all.
    """

    value: Function
    derivative: Callable[[np.ndarray], Derivative]
    nodes: Callable[[], np.ndarray] | None = None

    @property
    def reads(self) -> np.ndarray | None:
        """These nodes, by the present cells."""
        return None if self.nodes is None else self.nodes()

    def __call__(self, *state: object) -> float:
        """The value at a state."""
        return self.value(*state)


def nodal_quantity(
    space: PlaneSpace, quantity: Quantity, nodes: np.ndarray | slice, columns: list[int], value: Function
) -> Function:
    """A quantity of the unknowns at nodes, or of their length where several columns count.

    With its derivative, but for extremes and for the value at a single node: what a point load does is not resolved.

    Args:
        space: of the nodes.
        quantity: says how values become one.
        nodes: (k,) at which it is taken.
        columns: of the unknowns.
        value: of the state.
    """
    if quantity.reduce in EXTREMES or (not isinstance(nodes, slice) and len(nodes) == 1):
        return Extreme(value, space, quantity, nodes, columns)
    weights = node_weights(space, quantity.at, nodes) if quantity.reduce == "mean" else None

    def derivative(x: np.ndarray) -> Derivative:
        own, load = x[nodes][:, columns], np.zeros_like(x)
        sizes = np.linalg.norm(own, axis=1)
        # The length of a single column would lose its sign.
        slopes = np.ones_like(own) if len(columns) == 1 else own / np.where(sizes > 0.0, sizes, 1.0)[:, None]
        if weights is not None:
            found = weights()
            slopes *= (found / found.sum())[:, None]
        elif quantity.reduce == "mean":
            slopes /= len(own)
        for k, column in enumerate(columns):
            load[nodes, column] = slopes[:, k]
        return Derivative(load)

    return Differentiable(value, derivative, None if isinstance(nodes, slice) else lambda: nodes)


def reaction_lift(
    mask: np.ndarray, nodes: np.ndarray | slice, column: int, factor: float | np.ndarray = 1.0
) -> np.ndarray:
    """The `Derivative.lift` (n, f) of the sum of reactions at nodes, times factors; mask: of prescribed unknowns."""
    lift = np.zeros(mask.shape)
    lift[nodes, column] = factor * (mask[nodes, column] != 0)
    return lift


def flow_derivative(
    problem: SteadyProblem, fixed: EdgeReactions, parts: Sequence[tuple[Integral, np.ndarray]]
) -> Callable[[np.ndarray], Derivative]:
    """The derivative of what flows out by edges: of the integrals there, less the reactions of a scalar.

    Args:
        problem: of one unknown a node.
        fixed: the reactions that pass there.
        parts: integrals that are linear and symmetric in the unknowns, with those of their entities (m,) that count.
    """

    def derivative(x: np.ndarray) -> Derivative:
        load = np.zeros_like(x)
        for integral, chosen in parts:
            integral.add_residual(np.ones_like(x), load, chosen)
        return Derivative(load, reaction_lift(problem.boundary.mask, fixed.nodes, 0, -fixed.parts()))

    return derivative
