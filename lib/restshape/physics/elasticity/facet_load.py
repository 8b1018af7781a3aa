"""Tractions, pressures and total forces on edges of a plane solid."""

import numpy as np

from restshape.fem.entity_sets import facets_on
from restshape.fem.facets import LENGTH_RULE, FacetSamples
from restshape.fem.nodal_values import Nodal, evaluate, rates, varies
from restshape.fem.space import Space
from restshape.scene.model import Load


class FacetLoad:
    """A load on edges: parameters tx, ty and pressure at both ends and thickness, one row a facet.

    Args:
        name: of the load in the scene.
        load: a traction, a pressure, or a total force.
        space: whose facets it acts on.
        thickness: (facets of the space,) [m].
        parameters: of the scene, for expressions.

    Attributes:
        facets: (nf, 2) or, of second order, (nf, 3) nodes: ends, middle.
        params: (nf, 7) of the element of tractions; pressure_params: (nf, 3) of that of follower loads.
        varies: whether parameters change when nodes move.
    """

    def __init__(
        self, name: str, load: Load, space: Space, thickness: np.ndarray, parameters: dict[str, float]
    ) -> None:
        self.name, self.load, self.parameters = name, load, parameters
        index = facets_on(space, load.on)
        self.facets = np.ascontiguousarray(space.facets[index])
        self.thickness = thickness[index]
        self.varies = load.force is not None or varies(load.traction) or varies(load.pressure)
        self.params = np.zeros((len(index), 7))
        self.pressure_params = np.zeros((len(index), 3))
        self._samples = FacetSamples(self.facets)
        self.update(space.X)

    def update(self, X: np.ndarray) -> None:
        """Evaluate the load on the facets of nodes X (n, 2) [m]."""
        where, params, samples = f"loads.{self.name}", self.params, self._samples
        params[:, 6] = self.thickness
        places = samples.at_samples(X)
        if self.load.traction is not None:
            given = [evaluate(self.load.traction, at, self.parameters, f"{where}.traction") for at in places]
            params[:, 0:2], params[:, 2:4] = samples.at_ends(given)
        elif self.load.pressure is not None:
            value = Nodal(self.load.pressure, self.parameters, f"{where}.pressure")
            params[:, 4], params[:, 5] = samples.ends_of(value, X)
        if self.load.force is not None and len(self.facets):
            at, along = samples.at_points(X)
            weights = np.linalg.norm(along, axis=2) * LENGTH_RULE[1]
            area = (weights.sum(axis=1) * self.thickness).sum()
            # Weighted, for a finer mesh at one end must not draw the centre there.
            centre = np.average(at.reshape(-1, 2), axis=0, weights=weights.ravel())[None]
            params[:, 0:2] = params[:, 2:4] = (
                evaluate(self.load.force, centre, self.parameters, f"{where}.force") / area
            )
        self.pressure_params[:] = params[:, 4:]

    def rate(self, X: np.ndarray, dX: np.ndarray) -> np.ndarray:
        """Rates of `params` (nf, 7) at nodes X (n, 2) [m] that move with dX (n, 2).

        Raises:
            ReplayProblem: a value of the scene has no derivative somewhere.
        """
        spec, where, samples = self.load, f"loads.{self.name}", self._samples
        out = np.zeros_like(self.params)
        out[:, 6] = self.thickness
        places = list(zip(samples.at_samples(X), samples.at_samples(dX)))
        if spec.traction is not None:
            given = [rates(spec.traction, *place, self.parameters, f"{where}.traction") for place in places]
            out[:, 0:2], out[:, 2:4] = samples.at_ends(given)
        elif spec.pressure is not None:
            value = Nodal(spec.pressure, self.parameters, f"{where}.pressure")
            out[:, 4], out[:, 5] = samples.end_rates_of(value, X, dX)
        if spec.force is not None and len(self.facets):
            out[:, 0:2] = out[:, 2:4] = self._total_force_rate(X, dX)
        return out

    def _total_force_rate(self, X: np.ndarray, dX: np.ndarray) -> np.ndarray:
        """The rate (2,) [Pa] of the traction that a total force makes on its edges, whose length and centre change."""
        (at, along), (motion, turn) = self._samples.at_points(X), self._samples.at_points(dX)
        stretch = np.linalg.norm(along, axis=2)
        lengths = stretch * LENGTH_RULE[1]
        growth = np.einsum("fqi,fqi->fq", along, turn) / stretch * LENGTH_RULE[1]
        thickness = self.thickness[:, None]
        area, area_rate = (lengths * thickness).sum(), (growth * thickness).sum()
        centre = np.einsum("fq,fqi->i", lengths, at) / lengths.sum()
        moved = np.einsum("fq,fqi->i", growth, at) + np.einsum("fq,fqi->i", lengths, motion)
        drift = (moved - growth.sum() * centre) / lengths.sum()
        where = f"loads.{self.name}.force"
        force_rate = rates(self.load.force, centre[None], drift[None], self.parameters, where)[0]
        return (force_rate - self.params[0, 0:2] * area_rate) / area
