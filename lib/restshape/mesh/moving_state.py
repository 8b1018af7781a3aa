"""The state of a moving mesh: what its frames replace, so that a frame without a solution is taken back by one
assignment."""

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from restshape.mesh.advance import CONNECTIVITY
from restshape.mesh.lagrange_space import LagrangeSpace
from restshape.mesh.mesh import Mesh
from restshape.mesh.nested import NestedMesh
from restshape.mesh.reach import MovingPart
from restshape.mesh.reconnect import Reconnection
from restshape.mesh.relocate import BoundaryNodes, Extension
from restshape.scene.model import MeshSpec, Scene
from restshape.shape.hand.gesture import Gesture
from restshape.shape.outline import Outline


@dataclass(frozen=True, eq=False)
class Generated:
    """A mesh as it was generated or imported, and what is set up for it.

    Args:
        mesh: its nodes move, and flips change its cells, in its own arrays.
        space: nodes of second order over it; None of first order.
        quality_floor, area_floor: below which a triangle has low quality, or counts as invalid.
        flip_floor: of the quality, below which triangles are flipped.
    """

    mesh: Mesh
    space: LagrangeSpace | None
    quality_floor: float
    area_floor: float
    flip_floor: float
    before: np.ndarray = field(init=False)
    """Room for the nodes (n, d) [m] as they lay before the last frame."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "before", np.empty_like(self.mesh.X))

    @cached_property
    def boundary(self) -> BoundaryNodes:
        """The nodes on the outline."""
        return BoundaryNodes(self.mesh)

    @cached_property
    def fixed(self) -> np.ndarray:
        """1 (n,) for these nodes, 0 for the others."""
        fixed = np.zeros(len(self.mesh.X), dtype=np.uint8)
        fixed[self.boundary.nodes] = 1
        return fixed

    def reconnection(self, part: MovingPart | None) -> Reconnection:
        """What flips edges, of a part alone where one is given; made at the first flip, for many meshes see none."""
        known = self.__dict__.get("_reconnection")
        if known is None or known[0] is not part:
            # One knows nothing of the flips of another.
            known = part, Reconnection(self.mesh, None if part is None else part.staying_edges(self.mesh))
            self.__dict__["_reconnection"] = known
        made: Reconnection = known[1]
        return made


@dataclass(frozen=True, eq=False)
class GestureMap:
    """How the nodes follow a gesture.

    Args:
        gesture: None before the first.
        reference: (n, d) nodes [m] at the coefficients `c`.
        Psi: (2, n, d) their displacements a unit of the coefficients; None: not made yet.
        extend: of gestures that are not linear, makes displacements of all nodes from those on the outline.
        part: what alone moves, where drags have a reach; None: everything, or it is not known yet.
    """

    gesture: Gesture | None
    reference: np.ndarray
    c: tuple[float, float]
    Psi: np.ndarray | None = None
    extend: Extension | None = None
    part: MovingPart | None = None


@dataclass(frozen=True, eq=False)
class MovingState:
    """What a frame may change.

    Args:
        spec: how fine meshes are; scene, order: it was asked for, and the order of its elements.
        generated: the mesh; None before the first.
        nested: the meshes that are nested in it, by its present flips; None without any.
        map: of the gesture in force; None before the first mesh.
        c: coefficients of the gesture at which the nodes lie.
        min_quality: of the triangles there.
    """

    spec: MeshSpec
    scene: Scene | None = None
    order: int = 1
    generated: Generated | None = None
    nested: NestedMesh | None = None
    map: GestureMap | None = None
    c: tuple[float, float] = (0.0, 0.0)
    min_quality: float = float("nan")

    def placed(self, c: tuple[float, float], min_quality: float) -> "MovingState":
        """The state with the nodes placed for coefficients c."""
        # What `dataclasses.replace` makes, in a tenth of its time.
        other = object.__new__(MovingState)
        other.__dict__.update(self.__dict__, c=c, min_quality=min_quality)
        return other


@dataclass(frozen=True, eq=False)
class KeptMesh:
    """A mesh as it lay after a frame, to which it may return.

    Args:
        state: of the moving mesh, without the map of its gesture.
        topology: version of the connectivity of its mesh.
        X: (n, d) nodes [m]; connectivity: copies of the arrays that flips change.
    """

    state: MovingState
    topology: int
    X: np.ndarray
    connectivity: dict[str, np.ndarray]

    @classmethod
    def of(cls, state: MovingState) -> "KeptMesh | None":
        """The mesh of a state of first order; None of second order, whose nodes in the middle of edges are not kept."""
        generated = state.generated
        if generated is None or generated.space is not None:
            return None
        mesh = generated.mesh
        connectivity = {name: getattr(mesh, name).copy() for name in CONNECTIVITY}
        return cls(replace(state, map=None, c=(0.0, 0.0)), mesh.topology, mesh.X.copy(), connectivity)

    @property
    def nbytes(self) -> int:
        """Of its arrays."""
        return self.X.nbytes + sum(values.nbytes for values in self.connectivity.values())

    def lies(self, state: MovingState) -> bool:
        """Whether the mesh of a state lies as this one did."""
        now, then = state.generated, self.state.generated
        if now is None or then is None or now.mesh is not then.mesh or now.mesh.topology != self.topology:
            return False
        return np.array_equal(now.mesh.X, self.X)


@dataclass(slots=True)
class Kept:
    """What a frame may change, as it was before.

    Args:
        state: of the moving mesh.
        versions: outline, geometry and topology of the mesh; None before the first one.
        X: (n, d) nodes [m], where they were moved; connectivity: copies of its arrays, where edges were flipped.
    """

    state: MovingState
    versions: tuple[Outline, int, int] | None
    X: np.ndarray | None = None
    connectivity: dict[str, np.ndarray] | None = None
