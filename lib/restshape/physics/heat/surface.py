"""Heat that enters and leaves by the edges of a shape: given fluxes, and convection to an ambient."""

import numpy as np

from restshape.fem.elements import SURFACE_HEAT
from restshape.fem.entity_sets import facets_on
from restshape.fem.facets import SHAPES, FacetSamples
from restshape.fem.integral import Integral
from restshape.fem.nodal_values import Nodal, varies
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
        index: (nf,) of the space's facets; facets: (nf, 2) or (nf, 3) their nodes.
        varies: whether values change when nodes move.
    """

    def __init__(self, name: str, scene: Scene, space: Space, thickness: np.ndarray, block: int) -> None:
        load = scene.loads[name]
        value, where = (load.flux, "flux") if load.kind == "flux" else (load.convection.ambient, "convection.ambient")
        self.space, self.block, self.varies = space, None if load.kind == "flux" else block, varies(value)
        self._element, self.index = SURFACE_HEAT[SHAPES[space.cells.shape[1]][1]], facets_on(space, load.on)
        self.facets = np.ascontiguousarray(space.facets[self.index])
        self._value, self._samples = Nodal(value, scene.parameters, f"loads.{name}.{where}"), FacetSamples(self.facets)
        self._thickness, self._film = thickness[self.index], 0.0 if self.block is None else load.convection.film
        self.update()

    def update(self) -> None:
        """Evaluate the flux, or the ambient temperature, on the facets as they lie."""
        self._params = self._rows(self._samples.ends_of(self._value, self.space.X), self._film)

    def integral(self, ambient: bool = True) -> Integral:
        """Heat that leaves by the facets; without the ambient where it shall be linear in the temperature."""
        params = self._params if ambient else self._params * (0.0, 0.0, 1.0, 1.0, 1.0)
        rate = self._rates if self.varies and ambient else None
        return Integral(self._element, self.space.X, self.facets, params, block=self.block, rate=rate)

    def _rates(self, dX: np.ndarray) -> np.ndarray:
        return self._rows(self._samples.end_rates_of(self._value, self.space.X, dX), 0.0)

    def _rows(self, ends: np.ndarray, film: float) -> np.ndarray:
        """Parameters (nf, 5) of the element, from fluxes or ambient temperatures (2, nf) at the facets' ends."""
        flux = ends if self.block is None else self._film * ends
        return np.ascontiguousarray(np.stack([*flux, *np.full_like(flux, film), self._thickness], axis=1))
