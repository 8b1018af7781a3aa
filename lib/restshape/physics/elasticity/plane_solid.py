"""Elastic solids in the plane: element parameters, loads and supports of a scene on one mesh topology."""

import numpy as np

from restshape import _kernels
from restshape.errors import UserError
from restshape.mesh.mesh import Mesh
from restshape.physics.elasticity.rigid_body_modes import require_held
from restshape.fem.entity_sets import cells_on, facets_on, nodes_on
from restshape.physics.elasticity.thickness import thickness_stretch
from restshape.fem.values import Nodal, evaluate, varies
from restshape.scene.model import Load, Material, Scene
from restshape.scene.plan import Plan

SHAPES = {3: ("tri3", "edge2"), 6: ("tri6", "edge3")}
"""Shapes of cells and facets, by the nodes of a cell."""

REFERENCE_NODES = np.array([[0, 0], [1, 0], [0, 1], [0.5, 0.5], [0, 0.5], [0.5, 0]], dtype=float)
"""Reference coordinates of a triangle's corners and the middles of its sides."""

# Places along a facet, 0 to 1, where a load is taken: its ends, or with three nodes Gauss's two points, for the line
# through the values there has the load's resultants up to a smaller error.
GAUSS = np.array([0.5 - np.sqrt(1 / 12), 0.5 + np.sqrt(1 / 12)])
ALONG = {2: np.array([0.0, 1.0]), 3: GAUSS}
LENGTH_RULE = np.array([0.5 - np.sqrt(0.15), 0.5, 0.5 + np.sqrt(0.15)]), np.array([5.0, 8.0, 5.0]) / 18.0


def facet_basis(nodes: int, s: np.ndarray) -> np.ndarray:
    """Values (m, nodes) of the basis functions of a facet, ends first, at places s (m,) from 0 to 1."""
    if nodes == 2:
        return np.stack([1.0 - s, s], axis=1)
    return np.stack([(1.0 - s) * (1.0 - 2.0 * s), s * (2.0 * s - 1.0), 4.0 * s * (1.0 - s)], axis=1)


def facet_slopes(nodes: int, s: np.ndarray) -> np.ndarray:
    """Derivatives (m, nodes) of `facet_basis` with respect to s."""
    if nodes == 2:
        return np.stack([-np.ones_like(s), np.ones_like(s)], axis=1)
    return np.stack([4.0 * s - 3.0, 4.0 * s - 1.0, 4.0 - 8.0 * s], axis=1)


def lame(material: Material, model: str) -> tuple[float, float]:
    """Lame coefficients (lambda, mu) [Pa] for a plane model; plane stress takes lambda* (docs/theory.md, section 2)."""
    E, nu = material.E, material.nu
    mu = E / (2 * (1 + nu))
    return (E * nu / (1 - nu**2), mu) if model == "plane_stress" else (E * nu / ((1 + nu) * (1 - 2 * nu)), mu)


class PlaneSolid:
    """Elasticity of one scene on one mesh: what the operator and the right side are made of.

    `law` is "linear_elastic", or "stvk" (St. Venant and Kirchhoff) under the effect `large_deformation`: a pressure
    then acts on the deformed boundary, and is one of `followers`; all other loads are dead.

    Args:
        scene: materials, loads and supports.
        plan: which effects are on.
        mesh: kept by reference; its nodes may move and its edges may flip, its nodes and cells keep their number.

    Raises:
        UserError: the supports leave the body free to move, or a part of it has no material.

    Source: docs/theory.md, section 2.
    """

    fields = 2

    def __init__(self, scene: Scene, plan: Plan, mesh: Mesh) -> None:
        solid, edge = SHAPES[mesh.cells.shape[1]]
        self.scene, self.mesh = scene, mesh
        self.model = plan.settings("solid").model
        self.gravity = np.array(plan.settings("gravity").g) if plan.on("gravity") else None
        self.law = "stvk" if plan.on("large_deformation") else "linear_elastic"
        mean = "dilatation_" if plan.settings("solid").element == "mean_dilatation" else ""
        self.element = _kernels.Element(f"{self.law}_{mean}{solid}")
        self.small = _kernels.Element(f"linear_elastic_{mean}{solid}")
        self.traction = _kernels.Element(f"traction_{edge}")
        self.materials = self._materials()
        bodies = [(name, load) for name, load in scene.loads.items() if load.body is not None]
        # Of second order a body force is interpolated like the displacement, or the answer would be of first order.
        smooth = solid == "tri6"
        self.bodies = [(name, load) for name, load in bodies if not (smooth and varies(load.body))]
        self.nodal_bodies = [(name, load) for name, load in bodies if smooth and varies(load.body)]
        self.spread = _kernels.Element("mass_tri6") if self.nodal_bodies else None
        self.params = self._cell_params()
        surface = {name: load for name, load in scene.loads.items() if load.body is None}
        loads = [self._facet_load(name, load) for name, load in surface.items() if self._has_edges(load)]
        self.tractions = [load for load in loads if not self._follows(load)]
        self.followers = [load for load in loads if self._follows(load)]
        self.pressure = _kernels.Element(f"pressure_{edge}") if self.followers else None
        self.forces = [(name, load) for name, load in surface.items() if not self._has_edges(load)]
        self._check_weight()
        self.mask, self.supports = self._supports()
        self.moving = self._moving()
        self.prescribed = np.zeros((len(mesh.X), 2))
        self._prescribe()

    # --- what a new frame needs -------------------------------------------------------------------------------

    def move(self) -> None:
        """Evaluate anew what depends on the place of the nodes; nothing at all when all values are constant."""
        if self.moving:
            self.params = self._cell_params()
            self._prescribe()
            for facets in (*self.tractions, *self.followers):
                facets.update(self.mesh.X)

    def loads(self, rhs: np.ndarray) -> None:
        """Set `rhs` (n, 2) [N] to the loads on points and edges; constrained rows are 0."""
        rhs[:] = 0.0
        for facets in self.tractions:
            self.traction.residual(self.mesh.X, self.prescribed, facets.facets, facets.params, rhs)
        np.negative(rhs, out=rhs)
        self._add_forces(rhs, 1.0)
        self._add_bodies(rhs, 1.0)
        if self.tractions or self.forces or self.nodal_bodies:
            rhs.ravel()[self.constrained] = 0.0

    def pressures(self, part: float = 1.0) -> list[tuple[np.ndarray, np.ndarray]]:
        """Facets and parameters of the element `pressure` of each load that follows the boundary, or part of it."""
        # A part of the thickness takes a part of the load.
        return [(load.facets, load.pressure_params * (1.0, 1.0, part)) for load in self.followers]

    # --- what is observed --------------------------------------------------------------------------------------

    def residual(self, x: np.ndarray, subset: np.ndarray | None = None) -> np.ndarray:
        """Internal less body forces (n, 2) [N] at the displacement x (n, 2) [m], over all cells or a subset."""
        out = np.zeros_like(self.mesh.X)
        self.element.residual(self.mesh.X, x, self.mesh.cells, self.params, out, subset)
        return out

    @property
    def displaced(self) -> bool:
        """Tell whether a support moves what it holds."""
        return bool(np.any(self.prescribed))

    @property
    def stiffest(self) -> float:
        """The largest modulus times thickness [N/m] of the materials."""
        lame, shear, thickness, _ = self.materials.T
        return float(np.nanmax((lame + 2.0 * shear) * thickness))

    def internal_force(self, x: np.ndarray) -> float:
        """Half the norm [N] of the internal forces at all nodes, held ones too, at the displacement x (n, 2) [m].

        Half, for loads and the reactions that balance them are both in it.
        """
        out = np.zeros_like(self.mesh.X)
        self.element.residual(self.mesh.X, x, self.mesh.cells, self.stiffness_params, out)
        return 0.5 * float(np.linalg.norm(out))

    def cells_around(self, nodes: np.ndarray) -> np.ndarray:
        """Cells (int32) of which one of `nodes` (k,) int32 is a node."""
        return _kernels.cells_around(self.mesh.cells, nodes, len(self.mesh.X))

    def reaction(self, x: np.ndarray, nodes: np.ndarray, around: np.ndarray) -> np.ndarray:
        """Forces (k, 2) [N] of supports on the body at `nodes` (k,) with the cells `around` them, at x (n, 2) [m]."""
        return self.imbalance(x, around)[nodes]

    def imbalance(self, x: np.ndarray, subset: np.ndarray | None = None) -> np.ndarray:
        """Internal less all applied forces (n, 2) [N] at x (n, 2) [m], with the cells of a subset alone if given."""
        out = self.residual(x, subset)
        for facets in self.tractions:
            self.traction.residual(self.mesh.X, x, facets.facets, facets.params, out)
        for facets, params in self.pressures():
            self.pressure.residual(self.mesh.X, x, facets, params, out)
        self._add_forces(out, -1.0)
        self._add_bodies(out, -1.0, subset)
        return out

    def energies(self, x: np.ndarray) -> np.ndarray:
        """Strain energies (ne,) [J] of the cells at the displacement x (n, 2) [m]; they sum to half of x . K x."""
        return self.element.energy(self.mesh.X, x, self.mesh.cells, self.stiffness_params)

    def stress(self, x: np.ndarray, points: np.ndarray | None = None) -> np.ndarray:
        """Cauchy's stresses [Pa] of each cell: xx, yy, xy, zz; not numbers where plane stress thins a cell to nothing.

        Args:
            x: (n, 2) displacement [m].
            points: (m, 2) reference coordinates; without them the centroids are meant.

        Returns:
            (ne, m, 4), or (ne, 4) at centroids.
        """
        shape = (len(self.mesh.cells), 4) if points is None else (len(self.mesh.cells), len(points), 4)
        out = np.empty(shape)
        self.element.stress(self.mesh.X, x, self.mesh.cells, self.stiffness_params, out, points)
        if self.model == "plane_stress":
            # The element knows lambda* and a thickness that stays, with which its zz means nothing.
            out[..., 3] = 0.0
            if self.law == "stvk":
                ratio = 0.5 * self.stiffness_params[..., 0] / self.stiffness_params[..., 1]
                out /= thickness_stretch(self.mesh.X, x, self.mesh.cells, ratio, points)[..., None]
        return out

    def vanished_cells(self, x: np.ndarray) -> np.ndarray:
        """Cells (k,) of a sheet of large deformation that x (n, 2) [m] stretches until the law leaves no thickness."""
        if self.model != "plane_stress" or self.law != "stvk":
            return np.empty(0, dtype=np.int32)
        ratio = 0.5 * self.stiffness_params[..., 0] / self.stiffness_params[..., 1]
        corners = REFERENCE_NODES[: self.mesh.cells.shape[1]]
        stretch = thickness_stretch(self.mesh.X, x, self.mesh.cells, ratio, corners)
        return np.flatnonzero(~(stretch > 0.0).all(axis=1)).astype(np.int32)

    # --- parts ---------------------------------------------------------------------------------------------------

    def _materials(self) -> np.ndarray:
        """Rows lambda, mu, thickness, rho (regions + 1, 4): row 0 is the rest of the shape, row i+1 the i-th region."""
        regions = [loop.name for loop in self.mesh.outline.loops if loop.kind == "region"]
        rest = [m for m in self.scene.material.values() if not m.region]
        table = np.full((len(regions) + 1, 4), np.nan)
        for material in [*rest, *(m for m in self.scene.material.values() if m.region)]:
            rows = [regions.index(name) + 1 for name in material.region] if material.region else slice(None)
            table[rows] = (*lame(material, self.model), material.thickness, material.rho)
        bare = np.flatnonzero(np.isnan(table[self.mesh.cell_region, 0]))
        if len(bare):
            x, y = self.mesh.X[self.mesh.corners[bare[0]]].mean(axis=0)
            raise UserError(
                f"{len(bare)} triangles lie outside of the regions that have a material, one at ({x:.4g}, {y:.4g}) m",
                f"{self.scene.path}: material",
                "let one material have no region, or name the regions that are missing",
            )
        return table

    def _cell_params(self) -> np.ndarray:
        """Parameters lambda, mu, thickness, bx, by: one row where all cells agree, else one row a cell."""
        table = np.zeros((len(self.materials), 5))
        table[:, :3] = self.materials[:, :3]
        stiffness = table.copy()
        if self.gravity is not None:
            table[:, 3:] = self.materials[:, 3:4] * self.gravity
        region = self.mesh.cell_region
        if not self.bodies and not np.any(region):
            self.stiffness_params = np.ascontiguousarray(stiffness[0])
            return np.ascontiguousarray(table[0])
        # Apart from the loads, whose potential is no strain energy.
        self.stiffness_params = np.ascontiguousarray(stiffness[region])
        params = np.ascontiguousarray(table[region])
        for name, load in self.bodies:
            cells = cells_on(self.mesh, load.on)
            centres = self.mesh.X[self.mesh.corners[cells]].mean(axis=1)
            params[cells, 3:] += evaluate(load.body, centres, self.scene.parameters, f"loads.{name}.body")
        return params

    def _add_forces(self, out: np.ndarray, sign: float) -> None:
        """Add `sign` times the loads on points to `out` (n, 2) [N]."""
        for name, load in self.forces:
            nodes = nodes_on(self.mesh, load.on)
            force = evaluate(load.force, self.mesh.X[nodes], self.scene.parameters, f"loads.{name}.force")
            out[nodes] += sign / len(nodes) * force

    def _add_bodies(self, out: np.ndarray, sign: float, subset: np.ndarray | None = None) -> None:
        """Add `sign` times the body forces that are interpolated between nodes to `out` (n, 2) [N]; see `imbalance`."""
        if not self.nodal_bodies:
            return
        mesh, total = self.mesh, np.zeros_like(out)
        thickness = np.ascontiguousarray(self.materials[mesh.cell_region, 2:3])
        for name, load in self.nodal_bodies:
            cells = cells_on(mesh, load.on)
            cells = cells if subset is None else np.intersect1d(cells, subset)
            nodes = np.unique(mesh.cells[cells])
            force = np.zeros_like(mesh.X)
            force[nodes] = evaluate(load.body, mesh.X[nodes], self.scene.parameters, f"loads.{name}.body")
            self.spread.residual(mesh.X, force, mesh.cells, thickness, total, cells)
        out += sign * total

    def _facet_load(self, name: str, load: Load) -> "FacetLoad":
        thickness = self.materials[self.mesh.cell_region[self.mesh.facet_cell], 2]
        return FacetLoad(name, load, self.mesh, thickness, self.scene.parameters)

    def _follows(self, facets: "FacetLoad") -> bool:
        """Tell whether a load acts on the deformed boundary."""
        return self.law == "stvk" and facets.load.pressure is not None

    def _has_edges(self, load: Load) -> bool:
        return len(facets_on(self.mesh, load.on)) > 0

    def _supports(self) -> tuple[np.ndarray, list[tuple[str, int, np.ndarray, object]]]:
        mask = np.zeros((len(self.mesh.X), 2), dtype=np.uint8)
        supports = []
        for name, support in self.scene.supports.items():
            nodes = nodes_on(self.mesh, support.on)
            for axis, value in support.fix.items():
                column = "xy".index(axis)
                mask[nodes, column] = 1
                supports.append((f"supports.{name}.fix.{axis}", column, nodes, value))
        self.constrained = np.flatnonzero(mask.ravel())
        require_held(self.mesh.X, mask, self.scene)
        return mask, supports

    def _check_weight(self) -> None:
        """Refuse gravity on a material without density."""
        weightless = [name for name, material in self.scene.material.items() if not material.rho]
        if self.gravity is not None and np.any(self.gravity) and weightless:
            raise UserError(
                "gravity is on, but the material has no density",
                f"{self.scene.path}: material.{weightless[0]}",
                'give it one, e.g. rho = "7850 kg/m^3", or leave out [effects.gravity]',
            )

    def _prescribe(self) -> None:
        given = np.full_like(self.prescribed, np.nan)
        for where, column, nodes, value in self.supports:
            values = Nodal(value, self.scene.parameters, where)(self.mesh.X[nodes])
            before = given[nodes, column]
            clash = np.flatnonzero(np.abs(values - before) > 1e-9 * np.maximum(np.abs(values), np.abs(before)))
            if len(clash):
                x, y = self.mesh.X[nodes[clash[0]]]
                raise UserError(
                    f"the support wants another displacement than one before it at ({x:.6g}, {y:.6g}) m: "
                    f"{values[clash[0]]:.6g} m and {before[clash[0]]:.6g} m",
                    f"{self.scene.path}: {where}",
                    "let supports that meet agree where they meet",
                )
            given[nodes, column] = values
        np.copyto(self.prescribed, np.nan_to_num(given))

    def _moving(self) -> bool:
        """Tell whether any value changes when nodes move."""
        bodies = any(varies(load.body) for load in self.scene.loads.values())
        facets = any(load.moving for load in (*self.tractions, *self.followers))
        return bodies or facets or any(varies(v) for *_, v in self.supports)


class FacetLoad:
    """A load on edges: parameters tx, ty and pressure at both ends and thickness, one row a facet.

    Attributes:
        facets: (nf, 2) or, of second order, (nf, 3) nodes: ends, middle.
    """

    def __init__(self, name: str, load: Load, mesh: Mesh, thickness: np.ndarray, parameters: dict[str, float]) -> None:
        self.name, self.load, self.parameters = name, load, parameters
        index = facets_on(mesh, load.on)
        self.facets = np.ascontiguousarray(mesh.facets[index])
        self.thickness = thickness[index]
        self.moving = load.force is not None or varies(load.traction) or varies(load.pressure)
        self.params = np.zeros((len(index), 7))
        self.pressure_params = np.zeros((len(index), 3))
        nodes = self.facets.shape[1]
        self._sampled = facet_basis(nodes, ALONG[nodes])
        self._to_ends = np.linalg.inv(facet_basis(2, ALONG[nodes]))
        self._basis, self._slopes = (values(nodes, LENGTH_RULE[0]) for values in (facet_basis, facet_slopes))
        self.update(mesh.X)

    def places(self, field: np.ndarray) -> np.ndarray:
        """A field (n, 2) at the two places (2, nf, 2) of each facet where the load is taken."""
        return np.einsum("qi,fik->qfk", self._sampled, field[self.facets])

    def at_ends(self, values: list[np.ndarray]) -> np.ndarray:
        """What values (nf, ...) at the two places are at the facets' ends (2, nf, ...), along a line."""
        return np.einsum("eq,q...->e...", self._to_ends, np.stack(values))

    def points(self, field: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """A field (n, 2) and its derivatives along the facets, at the points (nf, 3, 2) of the rule for lengths."""
        nodal = field[self.facets]
        return self._basis @ nodal, self._slopes @ nodal

    def update(self, X: np.ndarray) -> None:
        """Evaluate the load on the facets of nodes X (n, 2) [m]."""
        where, params = f"loads.{self.name}", self.params
        params[:, 6] = self.thickness
        places = self.places(X)
        if self.load.traction is not None:
            given = [evaluate(self.load.traction, at, self.parameters, f"{where}.traction") for at in places]
            params[:, 0:2], params[:, 2:4] = self.at_ends(given)
        elif self.load.pressure is not None:
            value = Nodal(self.load.pressure, self.parameters, f"{where}.pressure")
            params[:, 4], params[:, 5] = self.at_ends([value(at) for at in places])
        if self.load.force is not None and len(self.facets):
            at, along = self.points(X)
            weights = np.linalg.norm(along, axis=2) * LENGTH_RULE[1]
            area = (weights.sum(axis=1) * self.thickness).sum()
            # Weighted, for a finer mesh at one end must not draw the centre there.
            centre = np.average(at.reshape(-1, 2), axis=0, weights=weights.ravel())[None]
            params[:, 0:2] = params[:, 2:4] = (
                evaluate(self.load.force, centre, self.parameters, f"{where}.force") / area
            )
        self.pressure_params[:] = params[:, 4:]
