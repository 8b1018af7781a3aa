"""A soap film under a pressure, -T laplace(w) = p: a whole physics on an element that is there already."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field

from restshape.analysis.analysis import Analysis, Context
from restshape.analysis.static.steady import SteadyAnalysis
from restshape.application import Application
from restshape.fem import problem as kinds
from restshape.fem.elements import CONDUCTION
from restshape.fem.entity_sets import cells_on, observed_nodes
from restshape.fem.error_estimate import RecoveryEstimate
from restshape.fem.integral import Integral
from restshape.fem.observer import Observer, reduction
from restshape.fem.problem import Fields, SteadyProblem, Unknown
from restshape.fem.region_materials import table_by_region
from restshape.fem.space import Space
from restshape.fem.supports import dirichlet_of
from restshape.scene.derived_effects import On
from restshape.scene.load_kind import AREAS, LoadKind
from restshape.scene.model import Material, Quantity, Scene
from restshape.scene.physics import Physics, PictureField
from restshape.scene.plan import Plan
from restshape.scene.quantity import QuantityKind
from restshape.scene.solver import DEFINITE, SolverPlan, System
from restshape.scene.values import number_of


class FilmMaterial(Material):
    """``[material.NAME]``: a film with the same tension in all directions."""

    tension: Annotated[number_of("stiffness"), Field(gt=0)]


class Film(SteadyProblem):
    """The height w (n, 1) [m] of a film over the plane; arguments as of any `fem.problem.SteadyProblem`."""

    name = "film"
    unknowns = (Unknown("height", "m", ("w",)),)
    symmetric = linear = True

    def __init__(self, scene: Scene, plan: Plan, space: Space) -> None:
        self.space = space
        self.tensions = table_by_region(scene, space, lambda material: (material.tension,))[:, 0]
        # Of the element: a conductivity, a thickness, and a source at one or three quadrature points.
        self.params = np.zeros((len(space.cells), 3 if space.cell_type == "tri3" else 5))
        self.params[:, 0], self.params[:, 1] = self.tensions[space.cell_region], 1.0
        for load in scene.loads.values():
            self.params[cells_on(space, load.on), 2:] += load.blown
        self.boundary = dirichlet_of(scene, space, self.unknowns)
        self.boundary.evaluate(space.X)

    @property
    def stiffest(self) -> float:
        """The largest tension [N/m]."""
        return float(np.nanmax(self.tensions))

    @property
    def varies(self) -> bool:
        """Whether a value changes when nodes move."""
        return self.boundary.varies

    @property
    def loaded_inside(self) -> bool:
        """Whether any pressure acts."""
        return bool(self.params[:, 2:].any())

    def update(self) -> None:
        """Evaluate again what depends on the place of the nodes."""
        self.boundary.evaluate(self.space.X)

    def blocks(self) -> list[np.ndarray]:
        """Entities that have a tangent: the cells."""
        return [self.space.cells]

    def integrals(self, kind: str, part: float = 1.0) -> list[Integral]:
        """The film, with its pressure where the kind has loads; nothing acts on edges."""
        if kind in (kinds.LOADS, kinds.FOLLOWERS):
            return []
        params = self.params if kind == kinds.INTERNAL else self.params * (np.arange(self.params.shape[1]) < 2)
        return [Integral(CONDUCTION[self.space.cell_type], self.space.X, self.space.cells, params)]

    def fields(self, x: np.ndarray) -> Fields:
        """The height [m] of the nodes."""
        return {"height": x[:, 0]}, {}

    def observer(self, quantities: Mapping[str, Quantity]) -> Observer:
        """What evaluates heights."""

        def height(name: str, quantity: Quantity) -> Any:
            nodes = observed_nodes(self.space, name, quantity)
            reduce = reduction(self.space, quantity, nodes)
            return lambda x, *_: reduce(x[nodes, 0])

        return Observer({name: height(name, quantity) for name, quantity in quantities.items()})

    def error_estimate(self) -> RecoveryEstimate:
        """The recovery-based estimate in the energy norm."""

        def flux(x: np.ndarray, points: np.ndarray | None = None) -> np.ndarray:
            own = self.integrals(kinds.STIFFNESS)[0].stress(x, points)
            return np.concatenate([own, np.zeros_like(own)], axis=-1)

        resistance = np.diag([1.0, 1.0, 0.0, 0.0]) / self.tensions[:, None, None]
        return RecoveryEstimate(self.space, flux, resistance, self.stiffest)


def film_plan(scene: Scene, on: On, settings: Mapping[str, Any]) -> SolverPlan:
    """Which equations there are, and which solver they get."""
    return SolverPlan("linear", (System("height", DEFINITE, "cg", "cholesky", "Laplace's equation"),), "small slopes")


def film_analysis(scene: Scene, plan: Plan, context: Context) -> Analysis[Film]:
    """The film in equilibrium; arguments as of any `Analysis`."""
    return SteadyAnalysis(scene, plan, context, Film)


FILM = Physics(
    name="film",
    summary="a soap film that a pressure bulges",
    solver=film_plan,
    material=FilmMaterial,
    boundary={"w": "length"},
    loads={"blown": LoadKind(number_of("pressure"), AREAS, "a pressure [Pa] from below")},
    quantities={"height": QuantityKind(Literal[True], "length", "max")},
    pictured={"height": PictureField("height", "m")},
    orders=(1, 2),
)
application = Application(
    name="film",
    summary="soap films",
    folder=Path(__file__).parent / "film",
    physics=(FILM,),
    analysis="sample_applications.film:film_analysis",
)
