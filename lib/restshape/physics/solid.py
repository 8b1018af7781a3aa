"""Linear elastic solids in the plane: element parameters, loads and supports of a scene on one mesh topology."""

import numpy as np

from restshape import _kernels
from restshape.errors import UserError
from restshape.mesh.mesh import Mesh
from restshape.physics.held import require_held
from restshape.physics.places import cells_on, facets_on, nodes_on
from restshape.physics.values import Nodal, evaluate, varies
from restshape.scene.model import Load, Material, Scene
from restshape.scene.plan import Plan

SHAPES = {1: ("tri3", "edge2")}


def lame(material: Material, model: str) -> tuple[float, float]:
    """Lame coefficients (lambda, mu) [Pa] for a plane model; plane stress takes lambda* (docs/theory.md, section 2)."""
    E, nu = material.E, material.nu
    mu = E / (2 * (1 + nu))
    return (E * nu / (1 - nu**2), mu) if model == "plane_stress" else (E * nu / ((1 + nu) * (1 - 2 * nu)), mu)


class PlaneSolid:
    """Linear elasticity of one scene on one mesh: what the operator and the right side are made of.

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
        solid, edge = SHAPES[scene.mesh.order]
        self.scene, self.mesh = scene, mesh
        self.model = plan.settings("solid").model
        self.gravity = np.array(plan.settings("gravity").g) if plan.on("gravity") else None
        self.element = _kernels.Element(f"linear_elastic_{solid}")
        self.traction = _kernels.Element(f"traction_{edge}")
        self.materials = self._materials()
        self.params = self._cell_params()
        surface = {name: load for name, load in scene.loads.items() if load.body is None}
        self.tractions = [self._facet_load(name, load) for name, load in surface.items() if self._has_edges(load)]
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
            for facets in self.tractions:
                facets.update(self.mesh.X)

    def loads(self, rhs: np.ndarray) -> None:
        """Set `rhs` (n, 2) [N] to the loads on points and edges; constrained rows are 0."""
        rhs[:] = 0.0
        for facets in self.tractions:
            self.traction.residual(self.mesh.X, self.prescribed, facets.facets, facets.params, rhs)
        np.negative(rhs, out=rhs)
        self._add_forces(rhs, 1.0)
        if self.tractions or self.forces:
            rhs.ravel()[self.constrained] = 0.0

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

    def internal_force(self, x: np.ndarray) -> float:
        """Half the norm [N] of the internal forces at all nodes, held ones too, at the displacement x (n, 2) [m].

        Half, for loads and the reactions that balance them are both in it.
        """
        out = np.zeros_like(self.mesh.X)
        self.element.residual(self.mesh.X, x, self.mesh.cells, self.stiffness_params, out)
        return 0.5 * float(np.linalg.norm(out))

    def cells_around(self, nodes: np.ndarray) -> np.ndarray:
        """Cells (int32) of which a corner is one of `nodes` (k,) int32."""
        return _kernels.cells_around(self.mesh.cells, nodes, len(self.mesh.X))

    def reaction(self, x: np.ndarray, nodes: np.ndarray, around: np.ndarray) -> np.ndarray:
        """Forces (k, 2) [N] of supports on the body at `nodes` (k,) with the cells `around` them, at x (n, 2) [m]."""
        out = self.residual(x, around)
        for facets in self.tractions:
            self.traction.residual(self.mesh.X, x, facets.facets, facets.params, out)
        self._add_forces(out, -1.0)
        return out[nodes]

    def energies(self, x: np.ndarray) -> np.ndarray:
        """Strain energies (ne,) [J] of the cells at the displacement x (n, 2) [m]; they sum to half of x . K x."""
        return self.element.energy(self.mesh.X, x, self.mesh.cells, self.stiffness_params)

    def stress(self, x: np.ndarray) -> np.ndarray:
        """Stresses (ne, 4) [Pa] of each cell: xx, yy, xy, zz."""
        out = np.empty((len(self.mesh.cells), 4))
        self.element.stress(self.mesh.X, x, self.mesh.cells, self.stiffness_params, out)
        if self.model == "plane_stress":
            # The element knows lambda* only, with which its zz means nothing.
            out[:, 3] = 0.0
        return out

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
            x, y = self.mesh.X[self.mesh.cells[bare[0]]].mean(axis=0)
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
        bodies = [(name, load) for name, load in self.scene.loads.items() if load.body is not None]
        region = self.mesh.cell_region
        if not bodies and not np.any(region):
            self.stiffness_params = np.ascontiguousarray(stiffness[0])
            return np.ascontiguousarray(table[0])
        # Apart from the loads, whose potential is no strain energy.
        self.stiffness_params = np.ascontiguousarray(stiffness[region])
        params = np.ascontiguousarray(table[region])
        for name, load in bodies:
            cells = cells_on(self.mesh, load.on)
            centres = self.mesh.X[self.mesh.cells[cells]].mean(axis=1)
            params[cells, 3:] += evaluate(load.body, centres, self.scene.parameters, f"loads.{name}.body")
        return params

    def _add_forces(self, out: np.ndarray, sign: float) -> None:
        """Add `sign` times the loads on points to `out` (n, 2) [N]."""
        for name, load in self.forces:
            nodes = nodes_on(self.mesh, load.on)
            force = evaluate(load.force, self.mesh.X[nodes], self.scene.parameters, f"loads.{name}.force")
            out[nodes] += sign / len(nodes) * force

    def _facet_load(self, name: str, load: Load) -> "FacetLoad":
        thickness = self.materials[self.mesh.cell_region[self.mesh.facet_cell], 2]
        return FacetLoad(name, load, self.mesh, thickness, self.scene.parameters)

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
        return bodies or any(f.moving for f in self.tractions) or any(varies(v) for *_, v in self.supports)


class FacetLoad:
    """A load on edges: parameters tx, ty and pressure at both ends and thickness, one row a facet."""

    def __init__(self, name: str, load: Load, mesh: Mesh, thickness: np.ndarray, parameters: dict[str, float]) -> None:
        self.name, self.load, self.parameters = name, load, parameters
        index = facets_on(mesh, load.on)
        self.facets = np.ascontiguousarray(mesh.facets[index])
        self.thickness = thickness[index]
        self.moving = load.force is not None or varies(load.traction) or varies(load.pressure)
        self.params = np.zeros((len(index), 7))
        self.update(mesh.X)

    def update(self, X: np.ndarray) -> None:
        """Evaluate the load at the facets' ends, X (n, 2) [m]."""
        where, params = f"loads.{self.name}", self.params
        params[:, 6] = self.thickness
        for end in (0, 1):
            ends = X[self.facets[:, end]]
            if self.load.traction is not None:
                params[:, 2 * end : 2 * end + 2] = evaluate(
                    self.load.traction, ends, self.parameters, f"{where}.traction"
                )
            elif self.load.pressure is not None:
                params[:, 4 + end] = Nodal(self.load.pressure, self.parameters, f"{where}.pressure")(ends)
        if self.load.force is not None and len(self.facets):
            lengths = np.linalg.norm(X[self.facets[:, 1]] - X[self.facets[:, 0]], axis=1)
            area = (lengths * self.thickness).sum()
            # Weighted, for a finer mesh at one end must not draw the centre there.
            centre = np.average(X[self.facets].mean(axis=1), axis=0, weights=lengths)[None]
            params[:, 0:2] = params[:, 2:4] = (
                evaluate(self.load.force, centre, self.parameters, f"{where}.force") / area
            )
