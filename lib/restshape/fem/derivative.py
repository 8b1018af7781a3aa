"""How quantities of interest follow the unknowns: the right sides of their dual problems."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from restshape.fem.averages import node_weights
from restshape.fem.edge_reactions import EdgeReactions
from restshape.fem.integral import Integral
from restshape.fem.observer import Function
from restshape.fem.problem import Problem
from restshape.fem.space import PlaneSpace, Space
from restshape.scene.model import Quantity


@dataclass(frozen=True, eq=False)
class Derivative:
    """Of a quantity J with respect to unknowns x: J'(v) = load . v + lift . K v, of changes v that supports admit.

    Args:
        load: (n, f).
        lift: (n, f) weights of reactions, 0 at free unknowns; None: no reaction is in it.
        energy: cells of which J is the energy, so that it has a second derivative; None: it is linear.
        own: an estimate of the error that J has at the exact unknowns, where recovery evaluates it.
        value_on: J of unknowns on another space over the same mesh, where places of nodes count beside their unknowns.
    """

    load: np.ndarray
    lift: np.ndarray | None = None
    energy: np.ndarray | slice | None = None
    own: float = 0.0
    value_on: Callable[[Space, np.ndarray], float] | None = None


@dataclass(frozen=True, eq=False)
class Differentiable:
    """A function of a state, a quantity, with its derivative.

    Args:
        value: of the state.
        derivative: at unknowns (n, f) that solve a linear problem.
    """

    value: Function
    derivative: Callable[[np.ndarray], Derivative]

    def __call__(self, *state: object) -> float:
        """The value at a state."""
        return self.value(*state)


def reduction_weights(
    space: PlaneSpace, quantity: Quantity, nodes: np.ndarray | slice
) -> Callable[[np.ndarray], np.ndarray]:
    """The function from values (k,) at nodes (k,) to the derivatives (k,) of what `observer.reduction` makes of it."""
    if quantity.reduce == "sum":
        return np.ones_like
    if quantity.reduce != "mean":
        return lambda values: _extreme(str(quantity.reduce), values)
    weights = node_weights(space, quantity.at, nodes)
    if weights is None:
        return lambda values: np.full_like(values, 1.0 / len(values))

    def shares(values: np.ndarray) -> np.ndarray:
        found = weights()
        return found / found.sum()

    return shares


def _extreme(how: str, values: np.ndarray) -> np.ndarray:
    """1 at the extreme value that counts, or its sign where sizes count; 0 elsewhere."""
    found = np.zeros_like(values)
    k = int({"max": np.argmax, "min": np.argmin}.get(how, lambda v: np.argmax(np.abs(v)))(values))
    found[k] = 1.0 if how in ("max", "min") else np.sign(values[k])
    return found


def nodal_quantity(
    space: PlaneSpace, quantity: Quantity, nodes: np.ndarray | slice, columns: list[int], value: Function
) -> Differentiable:
    """A quantity of the unknowns at nodes, or of their length where several columns count, with its derivative.

    Args:
        space: of the nodes.
        quantity: says how values become one.
        nodes: (k,) at which it is taken.
        columns: of the unknowns.
        value: of the state.
    """
    weights = reduction_weights(space, quantity, nodes)

    def derivative(x: np.ndarray) -> Derivative:
        own, load = x[nodes][:, columns], np.zeros_like(x)
        sizes = np.linalg.norm(own, axis=1)
        # The length of a single column would lose its sign.
        slopes = np.ones_like(own) if len(columns) == 1 else own / np.where(sizes > 0.0, sizes, 1.0)[:, None]
        values = own[:, 0] if len(columns) == 1 else sizes
        for k, column in enumerate(columns):
            load[nodes, column] = weights(values) * slopes[:, k]
        return Derivative(load)

    return Differentiable(value, derivative)


def reaction_lift(
    mask: np.ndarray, nodes: np.ndarray | slice, column: int, factor: float | np.ndarray = 1.0
) -> np.ndarray:
    """The `Derivative.lift` (n, f) of the sum of reactions at nodes, times factors; mask: of prescribed unknowns."""
    lift = np.zeros(mask.shape)
    lift[nodes, column] = factor * (mask[nodes, column] != 0)
    return lift


def flow_derivative(
    problem: Problem, fixed: EdgeReactions, parts: Sequence[tuple[Integral, np.ndarray]]
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
