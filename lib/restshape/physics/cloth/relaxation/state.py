"""What a relaxation knows of its last equilibrium."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from restshape.fem.observer import Observer
from restshape.mesh.mesh import Mesh
from restshape.physics.cloth.cloth_problem import ClothProblem
from restshape.physics.cloth.contact.contact import FrictionHistory
from restshape.physics.cloth.relaxation.equilibrium import EquilibriumSolver
from restshape.physics.cloth.relaxation.jumps import Expected
from restshape.physics.cloth.relaxation.lasting import Lasting
from restshape.physics.cloth.relaxation.relaxation_report import ConvergenceReport
from restshape.physics.cloth.self_contact.layer_friction import LayerFriction
from restshape.physics.cloth.sheet.material_motion import AdvectedCloth, MaterialPlace
from restshape.scene.bodies import Body
from restshape.scene.model import Scene
from restshape.scene.plan import Plan
from restshape.scene.seam_keys import Seam


# More than 15 attributes: all that an equilibrium was found with, which goes from frame to frame as one.
@dataclass(frozen=True, eq=False)
class RelaxationState:
    """An equilibrium of cloth, and what it was found with.

    Args:
        plan: which effects are on.
        scene: whose values it is for; None before the first solution.
        problem: of that scene on its mesh; solver: of its equilibria.
        observer: of the scene's quantities.
        bodies: that the cloth touches, of numbers alone.
        x: (n, 3) positions [m], and with Morley's triangles slopes of edges.
        energy: of the cloth at these positions [J]; of a prediction that of the last equilibrium.
        place: of the nodes in the material at these positions.
        friction: what it remembers; None where nothing touches.
        layers: what friction between layers remembers; None where cloth does not touch itself.
        gaps: of its seams, by name, each seam with the largest distance across it [m].
        report: how the last relaxation ended.
        topology, geometry: versions of the mesh that it was found at; -1: on none.
        notes: what a cold start had to say of where it began.
        doubts: what the way there has to say of why the state cannot be trusted.
        softness: the least part of its stiffness that the membrane had on the way there, which contact remembers.
        interrupted: the last frame has failed: what was set up for it must be set up again.
        guessed: positions are those of a prediction, friction is that of its equilibrium.
        taken: bodies have taken the last equilibrium along as it lay, whose stability is known.
        lasting: what stays where they do.
        expected: of a frame that begins at the last rest; None of others, and once it is solved.
        rest: of a prediction, the last equilibrium; None of an equilibrium.
        distance: of a prediction, what estimates how far it is from the drape, over its size; None: a Newton step does.
    """

    plan: Plan
    scene: Scene | None = None
    problem: ClothProblem | None = None
    solver: EquilibriumSolver | None = None
    observer: Observer | None = None
    bodies: tuple[Body, ...] = ()
    x: np.ndarray = field(default_factory=lambda: np.zeros((0, 3)))
    energy: float = 0.0
    place: MaterialPlace | None = None
    friction: FrictionHistory | None = None
    layers: LayerFriction | None = None
    gaps: Mapping[str, tuple[Seam, float]] = field(default_factory=dict)
    report: ConvergenceReport = field(default_factory=ConvergenceReport)
    topology: int = -1
    geometry: int = -1
    notes: tuple[str, ...] = ()
    doubts: tuple[str, ...] = ()
    softness: float = 1.0
    interrupted: bool = False
    guessed: bool = False
    taken: bool = False
    lasting: Lasting = field(default_factory=Lasting)
    expected: Expected | None = None
    rest: RelaxationState | None = None
    distance: Callable[[], float] | None = None

    @property
    def predicted(self) -> bool:
        """Whether the positions are a prediction."""
        return self.rest is not None

    @property
    def nbytes(self) -> int:
        """Of the arrays of the equilibrium itself."""
        history, place, layers = self.friction, self.place, self.layers
        arrays = [self.x, *([history.anchors, history.normals, history.limits] if history else [])]
        arrays += [layers.offsets, layers.places] if layers else []
        arrays += [values for values in (place.X, place.normals) if values is not None] if place else []
        return sum(values.nbytes for values in arrays)

    @property
    def mesh(self) -> Mesh | None:
        """Of the cloth."""
        return None if self.problem is None else self.problem.mesh

    @cached_property
    def advected(self) -> AdvectedCloth:
        """The cloth at these positions, to be taken to other places of its nodes."""
        corners = self.problem.membrane.corners
        nodes = self.problem.morley.cells if self.problem.morley else corners
        return AdvectedCloth(self.place, corners, nodes, self.x)
