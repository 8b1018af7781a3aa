"""Heat that enters and leaves by the edges of a shape: given fluxes, and convection to an ambient."""

import numpy as np

from restshape.fem.elements import SURFACE_HEAT
from restshape.fem.entity_sets import facets_on
from restshape.fem.facets import SHAPES, FacetSamples
from restshape.fem.integral import Integral
from restshape.fem.nodal_values import NOTHING, Nodal, Product, varies
from restshape.fem.space import Space
from restshape.scene.model import Scene


class SurfaceHeat:
    """A flux, or a convection, on facets.

    Args:
        name: of the load in the scene.
        scene: its loads and parameters.
        space: whose facets it acts on.
        thickness: (facets of the space,) [m].
        block: of the operator, for convection alone: a flux has no tangent.

    Attributes:
        index: (nf,) of the space's facets; facets: (nf, 2) or (nf, 3) their nodes; varies: whether values move too.
        integral: heat that leaves by the facets; linear: without the ambient, so that it is linear in the temperature.
    """

    def __init__(self, name: str, scene: Scene, space: Space, thickness: np.ndarray, block: int) -> None:
        load = scene.loads[name]
        self.space, self.block = space, None if load.kind == "flux" else block
        self._element, self.index = SURFACE_HEAT[SHAPES[space.cells.shape[1]][1]], facets_on(space, load.on)
        self.facets = np.ascontiguousarray(space.facets[self.index])
        self._thickness, self._samples = thickness[self.index], FacetSamples(self.facets)
        given = {"flux": load.flux} if self.block is None else {f"convection.{key}": v for key, v in load.convection}
        values = [Nodal(value, scene.parameters, f"loads.{name}.{key}") for key, value in given.items()]
        self._values = (values[0], NOTHING) if self.block is None else (Product(*values), values[0])
        self.varies = varies(list(given.values()))
        self.update()

    def update(self) -> None:
        """Evaluate the flux, or film and ambient temperature, on the facets as they lie."""
        params = self._rows(*(self._samples.ends_of(value, self.space.X) for value in self._values))
        self.integral, self.linear = (self._integral(params, np.array([w, w, 1.0, 1.0, 1.0])) for w in (1.0, 0.0))

    def _integral(self, params: np.ndarray, kept: np.ndarray) -> Integral:
        rate = (lambda dX: self._rates(dX) * kept) if self.varies else None
        return Integral(self._element, self.space.X, self.facets, params * kept, block=self.block, rate=rate)

    def _rates(self, dX: np.ndarray) -> np.ndarray:
        return self._rows(*(self._samples.end_rates_of(value, self.space.X, dX) for value in self._values))

    def _rows(self, flux: np.ndarray, film: np.ndarray) -> np.ndarray:
        """Parameters (nf, 5) of the element, from what enters and films (2, nf) at the facets' ends, or from rates."""
        return np.ascontiguousarray(np.stack([*flux, *film, self._thickness], axis=1))
