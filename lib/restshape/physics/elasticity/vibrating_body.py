"""Bodies that vibrate freely, plane solids, extruded solids and plates: stiffness, inertia, supports, rigid motions."""

from abc import ABC, abstractmethod
from typing import Any

import numpy as np

from restshape import _kernels
from restshape.errors import UserError
from restshape.mesh.extrude import Extrusion
from restshape.mesh.mesh import Mesh
from restshape.mesh.plate import PlateMesh
from restshape.mesh.space import LagrangeSpace, Reseat, reseated
from restshape.physics.elasticity.stiffness import (
    FREE_SIDES,
    plane_params,
    plane_strain,
    plane_stress,
    plate_params,
    solid_params,
    stiffness_of,
)
from restshape.fem.entity_sets import nodes_on
from restshape.scene.expressions import Value
from restshape.scene.model import Material, Scene

HELD = 1e-9
"""A rigid motion of which less than this is left at the supports is free."""


class Oscillator(ABC):
    """What an eigenproblem K phi = lambda M phi is made of, on a mesh that follows a plane mesh under edit.

    Args:
        scene: materials and supports.
        plane: mesh of the outline, of either order; kept by reference.

    Attributes:
        mesh: whose X (n, d), cells and node_offsets the matrices live on.
        stiffness, mass: elements; stiffness_params, mass_params: theirs, one row or one a cell.
        mask: (n, f) 1 where the body is held.
        axes: names of the unknowns of a node, as supports fix them.

    Raises:
        UserError: a material has no density, part of the body no material, or a support makes no sense for the body.
    """

    axes: tuple[str, ...]
    mesh: Any
    stiffness: Any
    mass: Any
    stiffness_params: np.ndarray
    mass_params: np.ndarray

    def __init__(self, scene: Scene, plane: Mesh | LagrangeSpace) -> None:
        self.scene, self.plane = scene, plane
        self.materials = materials_by_region(scene, plane)

    @property
    def fields(self) -> int:
        """Unknowns of a node."""
        return len(self.axes)

    # --- a frame --------------------------------------------------------------------------------------------------

    def follow(self, changed: np.ndarray) -> np.ndarray:
        """Go where the plane mesh is; the cells (k,) of `mesh` over the plane cells (k,) that flips have changed."""
        return changed

    def reseated(self, field: np.ndarray, reseats: tuple[Reseat, ...]) -> np.ndarray:
        """A field (n, f) after flips of the plane mesh; see `restshape.mesh.space.reseated`."""
        return reseated(field, reseats)

    def motion(self, plane_motion: np.ndarray) -> np.ndarray:
        """Velocities (k, n, d) of the nodes of `mesh` from those (k, n2, 2) of the plane nodes."""
        return plane_motion

    def over_plane(self, field: np.ndarray) -> np.ndarray:
        """A field (n, ...) of `mesh` by plane nodes: (n2, columns...)."""
        return field

    def rigid(self) -> np.ndarray:
        """A basis (r, n f) of the rigid motions that the supports leave free, at the places of the nodes now."""
        basis = self.rigid_motions()
        size = np.linalg.norm(basis, axis=1)
        basis /= size[:, None]
        held = basis[:, self.mask.ravel() != 0]
        if not held.shape[1]:
            return basis
        weights, sizes, _ = np.linalg.svd(held, full_matrices=True)
        free = np.ones(len(basis), dtype=bool)
        free[: len(sizes)] = sizes <= HELD
        return np.ascontiguousarray(weights[:, free].T @ basis)

    @abstractmethod
    def rigid_motions(self) -> np.ndarray:
        """All rigid motions (r, n f) that the unknowns can make."""

    # --- what modes look like ---------------------------------------------------------------------------------------

    @abstractmethod
    def shapes(self, modes: np.ndarray) -> np.ndarray:
        """Displacements (k, n2, 3) of the plane nodes in modes (k, n f), those of the middle surface of bodies."""

    def normal_shares(self, modes: np.ndarray, heavy: np.ndarray) -> np.ndarray:
        """Shares (k,) of the kinetic energy that is normal to the plane, of modes (k, n f) with products M phi."""
        column = self.axes.index("z") if "z" in self.axes else None
        if column is None:
            return np.zeros(len(modes))
        weighted = (modes * heavy).reshape(len(modes), -1, self.fields)
        return weighted[:, :, column].sum(axis=1) / weighted.sum(axis=(1, 2))

    # --- parts --------------------------------------------------------------------------------------------------------

    def by_cell(self, table: np.ndarray, region: np.ndarray) -> np.ndarray:
        """Parameters of cells: rows of a table (regions + 1, p) by their region, or one row where none has one."""
        return np.ascontiguousarray(table[region] if np.any(region) else table[0])

    def held(self) -> np.ndarray:
        """The mask (n, f) of the scene's supports."""
        mask = np.zeros((len(self.mesh.X), self.fields), dtype=np.uint8)
        for name, support in self.scene.supports.items():
            nodes = nodes_on(self.mesh, support.on)
            for axis, value in support.fix.items():
                if axis not in self.axes:
                    raise UserError(
                        f"this body has no unknown {axis!r}",
                        f"supports.{name}.fix",
                        f"fix some of {', '.join(self.axes)}",
                    )
                if value != 0.0:
                    raise UserError(
                        "what a support prescribes has no meaning for free vibrations",
                        f"supports.{name}.fix.{axis}",
                        f'fix = ["{axis}"]',
                    )
                mask[nodes, self.axes.index(axis)] = 1
        return mask


class PlaneOscillator(Oscillator):
    """A solid in the plane, in plane stress or plane strain."""

    axes = ("x", "y")

    def __init__(self, scene: Scene, plane: Mesh | LagrangeSpace, stress: bool = True, lumped: bool = False) -> None:
        super().__init__(scene, plane)
        shape = {3: "tri3", 6: "tri6"}[plane.cells.shape[1]]
        self.mesh, self.stress = plane, stress
        self.stiffness = _kernels.Element(f"{law(self.materials)}_{shape}")
        self.mass = _kernels.Element(f"lumped_mass_{shape}" if lumped else f"mass_{shape}")
        thickness = [plain_thickness(m) for m in self.materials]
        if law(self.materials) == "anisotropic":
            plane_law = plane_stress if stress else plane_strain
            rows = [plane_params(plane_law(stiffness_of(m)), h) for m, h in zip(self.materials, thickness)]
        else:
            rows = [(*lame(m, stress), h, 0.0, 0.0) for m, h in zip(self.materials, thickness)]
        masses = [[m.rho * h] for m, h in zip(self.materials, thickness)]
        self.stiffness_params = self.by_cell(np.array(rows), plane.cell_region)
        self.mass_params = self.by_cell(np.array(masses), plane.cell_region)
        self.mask = self.held()

    def rigid_motions(self) -> np.ndarray:
        """Two translations and a turn (3, n f)."""
        X = self.mesh.X
        basis = np.zeros((3, *X.shape))
        basis[0, :, 0] = basis[1, :, 1] = 1.0
        centre = X - X.mean(axis=0)
        basis[2, :, 0], basis[2, :, 1] = -centre[:, 1], centre[:, 0]
        return basis.reshape(3, -1)

    def shapes(self, modes: np.ndarray) -> np.ndarray:
        """Displacements (k, n2, 3) of the plane nodes in modes (k, n f)."""
        shapes = np.zeros((len(modes), len(self.mesh.X), 3))
        shapes[:, :, :2] = modes.reshape(len(modes), -1, 2)
        return shapes


class SolidOscillator(Oscillator):
    """A body between a bottom and a top over the plane mesh, of tetrahedra of the plane mesh's order."""

    axes = ("x", "y", "z")

    def __init__(self, scene: Scene, plane: Mesh | LagrangeSpace, layers: int, lumped: bool = False) -> None:
        super().__init__(scene, plane)
        self.mesh = Extrusion(plane, layers, one_thickness(scene), scene.parameters)
        shape = {4: "tet4", 10: "tet10"}[self.mesh.cells.shape[1]]
        self.stiffness = _kernels.Element(f"{law(self.materials)}_{shape}")
        self.mass = _kernels.Element(f"lumped_mass_{shape}" if lumped else f"mass_{shape}")
        region = self.mesh.cell_region
        if law(self.materials) == "anisotropic":
            rows = [solid_params(stiffness_of(m)) for m in self.materials]
        else:
            rows = [(*lame(m, False), 0.0, 0.0, 0.0) for m in self.materials]
        self.stiffness_params = self.by_cell(np.array(rows), region)
        self.mass_params = self.by_cell(np.array([[m.rho] for m in self.materials]), region)
        self.mask = self.held()

    def follow(self, changed: np.ndarray) -> np.ndarray:
        """Go where the plane mesh is; the tetrahedra over changed plane cells."""
        return self.mesh.follow(changed)

    def reseated(self, field: np.ndarray, reseats: tuple[Reseat, ...]) -> np.ndarray:
        """A field (n, f) after flips of the plane mesh."""
        return self.mesh.reseated(field, reseats)

    def motion(self, plane_motion: np.ndarray) -> np.ndarray:
        """Velocities (k, n, 3) of the nodes from those (k, n2, 2) of the plane nodes."""
        return self.mesh.motion(plane_motion)

    def over_plane(self, field: np.ndarray) -> np.ndarray:
        """A field (n, ...) by plane nodes: (n2, levels...)."""
        return field.reshape(len(self.plane.X), -1)

    def rigid_motions(self) -> np.ndarray:
        """Three translations and three turns (6, n f)."""
        X = self.mesh.X
        basis = np.zeros((6, *X.shape))
        centre = X - X.mean(axis=0)
        for a in range(3):
            b, c = (a + 1) % 3, (a + 2) % 3
            basis[a, :, a] = 1.0
            basis[3 + a, :, b], basis[3 + a, :, c] = -centre[:, c], centre[:, b]
        return basis.reshape(6, -1)

    def shapes(self, modes: np.ndarray) -> np.ndarray:
        """Displacements (k, n2, 3) of the columns, averaged over bottom, top and what is between, in modes (k, n f)."""
        return modes.reshape(len(modes), len(self.plane.X), self.mesh.levels, 3).mean(axis=2)


class PlateOscillator(Oscillator):
    """A plate with shear over the plane mesh of first order: deflection and two rotations of the normal a node.

    Its motion in the plane is left out; it has frequencies of its own, which bending does not know.
    """

    axes = ("z", "rx", "ry")

    def __init__(self, scene: Scene, plane: Mesh) -> None:
        super().__init__(scene, plane)
        self.mesh = PlateMesh(plane, one_thickness(scene), scene.parameters)
        self.stiffness, self.mass = _kernels.Element("plate_tri3"), _kernels.Element("mass_plate_tri3")
        table = np.stack([plate_params(stiffness_of(m), m.rho) for m in self.materials])
        self.stiffness_params = self.mass_params = np.ascontiguousarray(table[plane.cell_region])
        self.mask = self.held()
        self._free_sides()

    def follow(self, changed: np.ndarray) -> np.ndarray:
        """Go where the plane mesh is; the changed cells."""
        changed = self.mesh.follow(changed)
        if len(changed) or self.mask[:, 1:].any():
            self._free_sides()
        return changed

    def _free_sides(self) -> None:
        """Tell the elements which sides may twist: those of the boundary along which no support holds the rotation."""
        cells = self.mesh.cells
        along = self.mesh.X[np.roll(cells, -1, axis=1), :2] - self.mesh.X[cells, :2]
        straight = np.abs(along) <= 1e-9 * np.linalg.norm(along, axis=2, keepdims=True)
        # The rotation along a side is made of ry where it runs in x, and of rx where it runs in y.
        kept = self.mask[:, [2, 1]] != 0
        fixed = [(kept[nodes] | straight).all(axis=2) for nodes in (cells, np.roll(cells, -1, axis=1))]
        self.stiffness_params[:, FREE_SIDES[0]] = self.mesh.rim() & ~(fixed[0] & fixed[1])

    def motion(self, plane_motion: np.ndarray) -> np.ndarray:
        """Velocities (k, n, 3) of places and thickness from those (k, n, 2) of the plane nodes."""
        return self.mesh.motion(plane_motion)

    def rigid_motions(self) -> np.ndarray:
        """A translation along z and two turns (3, n f)."""
        x, y = (self.mesh.X[:, :2] - self.mesh.X[:, :2].mean(axis=0)).T
        basis = np.zeros((3, len(x), 3))
        basis[0, :, 0] = 1.0
        basis[1, :, 0], basis[1, :, 1] = y, 1.0
        basis[2, :, 0], basis[2, :, 2] = -x, 1.0
        return basis.reshape(3, -1)

    def shapes(self, modes: np.ndarray) -> np.ndarray:
        """Displacements (k, n, 3) of the plane nodes in modes (k, n f): deflections alone."""
        shapes = np.zeros((len(modes), len(self.mesh.X), 3))
        shapes[:, :, 2] = modes.reshape(len(modes), -1, 3)[:, :, 0]
        return shapes

    def normal_shares(self, modes: np.ndarray, heavy: np.ndarray) -> np.ndarray:
        """Ones (k,): what a plate does is out of its plane."""
        return np.ones(len(modes))


def law(materials: list[Material]) -> str:
    """The law of small strains that all materials have: "linear_elastic", or "anisotropic" if one has a grain."""
    return "anisotropic" if any(m.orthotropic for m in materials) else "linear_elastic"


def lame(material: Material, stress: bool) -> tuple[float, float]:
    """Lame coefficients (lambda, mu) [Pa], lambda* for plane stress."""
    E, nu = material.E, material.nu
    return (E * nu / (1 - nu**2) if stress else E * nu / ((1 + nu) * (1 - 2 * nu))), E / (2 * (1 + nu))


def plain_thickness(material: Material) -> float:
    """The material's thickness [m], which must be a number here.

    Raises:
        UserError: it is a formula.
    """
    if not isinstance(material.thickness, float | int):
        raise UserError(
            "a plane solid has one thickness", "material", 'give a number, or use model = "solid" or "plate"'
        )
    return float(material.thickness)


def one_thickness(scene: Scene) -> Value:
    """The thickness of a body [m], a number or a formula of x and y.

    Raises:
        UserError: materials of different thickness.
    """
    given = {getattr(m.thickness, "text", m.thickness): m.thickness for m in scene.material.values()}
    if len(given) > 1:
        raise UserError(
            "the materials of a solid or a plate have one thickness",
            "material",
            "give all the same; it may be a formula of x and y",
        )
    return next(iter(given.values()))


def materials_by_region(scene: Scene, plane: Mesh | LagrangeSpace) -> list[Material]:
    """The material of each region of a plane mesh, that of the rest of the shape first.

    Raises:
        UserError: a region without a material, or a material without density.
    """
    for name, material in scene.material.items():
        if not material.rho:
            raise UserError(
                "a body without density cannot vibrate",
                f"material.{name}",
                'give it one, e.g. rho = "7850 kg/m^3"',
            )
    rest = next((m for m in scene.material.values() if not m.region), None)
    table = [rest]
    for loop in plane.outline.loops:
        if loop.kind == "region":
            own = next((m for m in scene.material.values() if m.region and loop.name in m.region), rest)
            table.append(own)
    used = np.unique(plane.cell_region)
    if any(table[region] is None for region in used):
        raise UserError(
            "part of the shape has no material",
            "material",
            "let one material have no region, or name the regions that are missing",
        )
    # Regions that fill the shape leave no cell to the rest, whose material is never looked at.
    some = next(m for m in table if m is not None)
    return [m if m is not None else some for m in table]
