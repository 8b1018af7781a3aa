"""How the forces on a plane solid change when its nodes move in the rest shape, by dual numbers."""

import numpy as np

from restshape.fem.entity_sets import cells_on, nodes_on
from restshape.physics.elasticity.plane_solid import LENGTH_RULE, FacetLoad, PlaneSolid
from restshape.fem.values import Nodal, evaluate, rates


def design_force(physics: PlaneSolid, x: np.ndarray, dX: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The rates (n, 2) [N] of all forces on nodes, and those (n, 2) [m] of the prescribed displacements.

    The displacement is constant at free unknowns and follows its support at held ones. Elements carry dual numbers;
    loads enter them linearly, so that the rate of one whose value varies with the place is its element's residual.

    Args:
        physics: on the mesh as it lies.
        x: (n, 2) displacement [m].
        dX: (n, 2) rates of the nodes' places.

    Raises:
        ReplayProblem: a value of the scene has no derivative somewhere.

    Source: docs/theory.md, "The design derivative": f_i of the thesis's (5.11).
    """
    mesh, out = physics.mesh, np.zeros_like(x)
    held = prescribed_rate(physics, dX)
    moved = held if np.any(held) else None
    physics.element.design(mesh.X, dX, x, mesh.cells, physics.params, out, dx=moved)
    _add_body_rates(physics, dX, out)
    for load in physics.tractions:
        physics.traction.design(mesh.X, dX, x, load.facets, load.params, out)
        physics.traction.residual(mesh.X, x, load.facets, load_rate(load, mesh.X, dX), out)
    for load in physics.followers:
        physics.pressure.design(mesh.X, dX, x, load.facets, load.pressure_params, out, dx=moved)
        physics.pressure.residual(mesh.X, x, load.facets, load_rate(load, mesh.X, dX)[:, 4:], out)
    parameters = physics.scene.parameters
    for name, load in physics.forces:
        nodes = nodes_on(mesh, load.on)
        out[nodes] -= rates(load.force, mesh.X[nodes], dX[nodes], parameters, f"loads.{name}.force") / len(nodes)
    return out, held


def prescribed_rate(physics: PlaneSolid, dX: np.ndarray) -> np.ndarray:
    """Rates (n, 2) [m] of the displacements that supports prescribe, where nodes move with dX (n, 2); 0 elsewhere."""
    out = np.zeros_like(dX)
    for where, column, nodes, value in physics.supports:
        out[nodes, column] = Nodal(value, physics.scene.parameters, where).rate(physics.mesh.X[nodes], dX[nodes])
    return out


def load_rate(load: FacetLoad, X: np.ndarray, dX: np.ndarray) -> np.ndarray:
    """Rates of the parameters of a load on edges (facets, 7) at nodes X (n, 2) [m] that move with dX (n, 2)."""
    spec, where = load.load, f"loads.{load.name}"
    out = np.zeros_like(load.params)
    out[:, 6] = load.thickness
    places = list(zip(load.places(X), load.places(dX)))
    if spec.traction is not None:
        given = [rates(spec.traction, *place, load.parameters, f"{where}.traction") for place in places]
        out[:, 0:2], out[:, 2:4] = load.at_ends(given)
    elif spec.pressure is not None:
        value = Nodal(spec.pressure, load.parameters, f"{where}.pressure")
        out[:, 4], out[:, 5] = load.at_ends([value.rate(*place) for place in places])
    if spec.force is not None and len(load.facets):
        out[:, 0:2] = out[:, 2:4] = _spread_rate(load, X, dX)
    return out


def _spread_rate(load: FacetLoad, X: np.ndarray, dX: np.ndarray) -> np.ndarray:
    """The rate (2,) [Pa] of the traction that a total force makes on its edges, whose length and centre change."""
    (at, along), (motion, turn) = load.points(X), load.points(dX)
    stretch = np.linalg.norm(along, axis=2)
    lengths = stretch * LENGTH_RULE[1]
    growth = np.einsum("fqi,fqi->fq", along, turn) / stretch * LENGTH_RULE[1]
    thickness = load.thickness[:, None]
    area, area_rate = (lengths * thickness).sum(), (growth * thickness).sum()
    centre = np.einsum("fq,fqi->i", lengths, at) / lengths.sum()
    moved = np.einsum("fq,fqi->i", growth, at) + np.einsum("fq,fqi->i", lengths, motion)
    drift = (moved - growth.sum() * centre) / lengths.sum()
    force_rate = rates(load.load.force, centre[None], drift[None], load.parameters, f"loads.{load.name}.force")[0]
    return (force_rate - load.params[0, 0:2] * area_rate) / area


def _add_body_rates(physics: PlaneSolid, dX: np.ndarray, out: np.ndarray) -> None:
    """Add the rates (n, 2) [N] of body forces whose values vary with the place."""
    mesh, parameters = physics.mesh, physics.scene.parameters
    thickness = np.ascontiguousarray(physics.materials[mesh.cell_region, 2:3])
    if physics.bodies:
        params = np.zeros((len(mesh.cells), physics.params.shape[-1]))
        params[:, 2:3] = thickness
        for name, load in physics.bodies:
            cells = cells_on(mesh, load.on)
            corners = mesh.corners[cells]
            places = mesh.X[corners].mean(axis=1), dX[corners].mean(axis=1)
            params[cells, 3:] += rates(load.body, *places, parameters, f"loads.{name}.body")
        # Without stiffness the element's residual is that of its body force alone.
        physics.element.residual(mesh.X, np.zeros_like(out), mesh.cells, params, out)
    for name, load in physics.nodal_bodies:
        chosen = cells_on(mesh, load.on)
        cells, share = np.ascontiguousarray(mesh.cells[chosen]), np.ascontiguousarray(thickness[chosen])
        nodes, where = np.unique(cells), f"loads.{name}.body"
        force, force_rate, total = np.zeros((3, *out.shape))
        force[nodes] = evaluate(load.body, mesh.X[nodes], parameters, where)
        force_rate[nodes] = rates(load.body, mesh.X[nodes], dX[nodes], parameters, where)
        physics.spread.design(mesh.X, dX, force, cells, share, total, dx=force_rate)
        out -= total
