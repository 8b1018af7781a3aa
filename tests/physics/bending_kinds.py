"""Five kinds of mesh, and how stiff hinges and Morley's triangles are on them. As a program it prints the table.

python tests/physics/bending_kinds.py [--picture FILE]
"""

import argparse
import math
from pathlib import Path

import numpy as np
from cloth_parameters import isotropic_bending, morley_params
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import spsolve
from scipy.spatial import Delaunay

from restshape import _kernels as k
from restshape.mesh.generate import generate
from restshape.mesh.hinges import hinges
from restshape.mesh.mesh import Mesh
from restshape.mesh.morley import MorleySpace
from restshape.physics.cloth.sheet.parameters import HINGE_STIFFNESS, lumped
from restshape.scene.model import MeshSpec, ShapeSpec
from restshape.shape.build import outline_from_spec
from restshape.shape.outline import Outline

KINDS = ("equilateral", "diagonal", "crossed", "jittered", "unstructured")
SURFACES = {
    "cylinder": lambda X: X[:, 0] ** 2 / 2,
    "cylinder at 45": lambda X: (X[:, 0] + X[:, 1]) ** 2 / 4,
    "sphere": lambda X: (X**2).sum(axis=1) / 2,
}
"""Deflections of curvature 1."""


def rectangle(width: float, height: float) -> Outline:
    """Its edges are called bottom, right, top and left."""
    corners = {"a": [0.0, 0.0], "b": [width, 0.0], "c": [width, height], "d": [0.0, height]}
    lines = {"bottom": ["a", "b"], "right": ["b", "c"], "top": ["c", "d"], "left": ["d", "a"]}
    spec = {
        "vertices": corners,
        "edges": {name: {"line": ends} for name, ends in lines.items()},
        "outline": list(lines),
    }
    return outline_from_spec(ShapeSpec.model_validate(spec))


def triangle_rows(columns: int, rows: int, width: float) -> tuple[np.ndarray, np.ndarray]:
    """Equilateral triangles, halved at the left and right; as high as `rows` of them."""
    h = width / columns
    X, start = [], []
    for row in range(rows + 1):
        x = np.arange(columns + 1) * h
        if row % 2:
            x = np.concatenate([[0.0], x[:-1] + h / 2, [width]])
        start.append(sum(map(len, X)))
        X.append(np.column_stack([x, np.full(len(x), row * h * math.sqrt(3) / 2)]))
    cells = []
    for row in range(rows):
        even, odd = (start[row], start[row + 1]) if row % 2 == 0 else (start[row + 1], start[row])
        strip = [(even + i, even + i + 1, odd + i + 1) for i in range(columns)]
        strip += [(even + i, odd + i + 1, odd + i) for i in range(columns + 1)]
        cells += strip if row % 2 == 0 else [(a, c, b) for a, b, c in strip]
    return np.vstack(X), np.array(cells)


def squares(columns: int, rows: int, width: float, crossed: bool) -> tuple[np.ndarray, np.ndarray]:
    """Squares cut by one diagonal, or by both."""
    h = width / columns
    X = np.stack(np.meshgrid(np.arange(columns + 1) * h, np.arange(rows + 1) * h), axis=-1).reshape(-1, 2)
    a = (np.arange(rows)[:, None] * (columns + 1) + np.arange(columns)).ravel()
    b, c, d = a + 1, a + columns + 2, a + columns + 1
    if not crossed:
        return X, np.vstack([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    m = len(X) + np.arange(len(a))
    sides = [np.column_stack([p, q, m]) for p, q in ((a, b), (b, c), (c, d), (d, a))]
    return np.vstack([X, X[a] + h / 2]), np.vstack(sides)


def jittered(columns: int, rows: int, width: float) -> tuple[np.ndarray, np.ndarray]:
    """Inner nodes of squares moved by up to a quarter of a side, and Delaunay's triangles of them."""
    X, _ = squares(columns, rows, width, crossed=False)
    h, top = width / columns, X[:, 1].max()
    inner = (X[:, 0] > h / 2) & (X[:, 0] < width - h / 2) & (X[:, 1] > h / 2) & (X[:, 1] < top - h / 2)
    X[inner] += np.random.default_rng(4).uniform(-0.25, 0.25, (inner.sum(), 2)) * h
    cells = Delaunay(X).simplices
    u, v = X[cells[:, 1]] - X[cells[:, 0]], X[cells[:, 2]] - X[cells[:, 0]]
    area = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    cells[area < 0, :2] = cells[area < 0, 1::-1]
    return X, cells[np.abs(area) > 1e-9 * h * h]


def sheet(kind: str, columns: int, width: float = 1.0, height: float = 1.0) -> Mesh:
    """A mesh of this kind; of equilateral triangles as high as comes nearest."""
    if kind == "unstructured":
        # As many triangles as squares with one diagonal.
        size = width / columns * math.sqrt(2 / math.sqrt(3))
        return generate(rectangle(width, height), MeshSpec(size=size))
    rows = round(columns * height / width)
    if kind == "equilateral":
        X, cells = triangle_rows(columns, round(columns * height / width * 2 / math.sqrt(3)), width)
    elif kind == "jittered":
        X, cells = jittered(columns, rows, width)
    else:
        X, cells = squares(columns, rows, width, kind == "crossed")
    outline = rectangle(width, float(X[:, 1].max()))
    corner = [int(np.abs(X - p).sum(axis=1).argmin()) for p in outline.points]
    return Mesh.build(
        X,
        cells,
        outline,
        facets=np.empty((0, 2), dtype=np.int32),
        facet_edge=np.empty(0, dtype=np.int32),
        node_edge=np.full(len(X), -1),
        node_param=np.zeros(len(X)),
        vertex_node=np.array(corner),
    )


def lifted(X: np.ndarray, w: np.ndarray) -> np.ndarray:
    """Positions of a sheet with deflections w."""
    return np.column_stack([X, w])


def hinge_energy(mesh: Mesh, x: np.ndarray, name: str = "hinge_flap4") -> float:
    """Energy of hinges of stiffness 1 at positions x (n, 3)."""
    return k.Element(name).energy(mesh.X, x, hinges(mesh.cells, mesh.cell_edges), np.ones(1)).sum()


def hinge_share(kind: str, surface: str, columns: int = 24) -> float:
    """Energy of hinges of k = 1 over area/2 (k1 + k2)^2, extrapolated to no boundary."""
    found = []
    for n in (columns, 2 * columns):
        mesh = sheet(kind, n)
        curvature = 2.0 if surface == "sphere" else 1.0
        area = mesh.X[:, 0].max() * mesh.X[:, 1].max()
        found.append(hinge_energy(mesh, lifted(mesh.X, SURFACES[surface](mesh.X))) / (area / 2 * curvature**2))
    return 2 * found[1] - found[0]


def stiffness(name: str, X: np.ndarray, cells: np.ndarray, params: np.ndarray) -> coo_matrix:
    """The matrix (n, n) of deflections."""
    element, m = k.Element(name), cells.shape[1]
    rows = np.broadcast_to(params, (len(cells), params.shape[-1]))
    flat = np.zeros((m, 3))
    blocks = np.array([element.tangent_block(X[c], flat, p)[2::3, 2::3] for c, p in zip(cells, rows)])
    i, j = np.repeat(cells, m, axis=1).ravel(), np.tile(cells, m).ravel()
    return coo_matrix((blocks.ravel(), (i, j)), shape=(len(X), len(X))).tocsr()


class Plate:
    """Deflections of a sheet under a load of 1 on each area, by hinges or by Morley's triangles."""

    def __init__(self, mesh: Mesh, model: str, D: float = 1.0, nu: float = 0.0) -> None:
        self.mesh = mesh
        if model == "morley":
            space = MorleySpace(mesh)
            params = morley_params(isotropic_bending(D, nu), space.signs)
            self.K = stiffness("morley_tri6", space.X, space.cells, params)
            self.edge_number, self.X = space.side_number, space.X
        else:
            self.K = stiffness("hinge_flap4", mesh.X, hinges(mesh.cells, mesh.cell_edges), np.array([D]))
            self.edge_number, self.X = None, mesh.X
        self.load = lumped(self.X, mesh.cells)

    def deflection(self, supported, clamped=None) -> np.ndarray:
        """Deflections (nodes,) where corners with supported(X) are held, and slopes of edges with clamped(X) too."""
        constrained = np.zeros(len(self.X), dtype=bool)
        constrained[: len(self.mesh.X)] = supported(self.mesh.X)
        if clamped is not None:
            constrained[self.edge_number] = clamped(self.X[self.edge_number])
        free = np.flatnonzero(~constrained)
        w = np.zeros(len(self.X))
        w[free] = spsolve(self.K[free][:, free].tocsc(), self.load[free])
        return w[: len(self.mesh.X)]


def rim(mesh: Mesh):
    """Which places lie on the rim of a sheet."""
    low, high = mesh.X.min(axis=0) + 1e-9, mesh.X.max(axis=0) - 1e-9
    return lambda X: ((low > X) | (high < X)).any(axis=1)


def ends(mesh: Mesh):
    """Which places lie at the left or right end of a sheet."""
    high = mesh.X[:, 0].max() - 1e-9
    return lambda X: (X[:, 0] < 1e-9) | (X[:, 0] > high)


def strip_share(kind: str, model: str, columns: int) -> float:
    """Deflection in the middle of a strip on two supports, its sides free, over 5 q L^4/(384 D), nu = 0."""
    mesh = sheet(kind, columns, 1.0, 0.125)
    w = Plate(mesh, model).deflection(ends(mesh))
    middle = np.abs(mesh.X[:, 0] - 0.5)
    return float(at_middle(middle, w) / (5 / 384))


def at_middle(distance: np.ndarray, w: np.ndarray) -> float:
    """Mean of w where a function of the distance fits it: the value at 0 of a parabola through the nearest twelve."""
    near = np.argsort(distance)[:12]
    d = distance[near]
    return float(np.linalg.lstsq(np.column_stack([np.ones(12), d**2]), w[near], rcond=None)[0][0])


def plate_share(kind: str, model: str, columns: int, nu: float = 0.0) -> float:
    """Largest deflection of a simply supported plate over that of D = 1 (Navier's series)."""
    mesh = sheet(kind, columns)
    w = Plate(mesh, model, nu=nu).deflection(rim(mesh))
    size = mesh.X.max(axis=0)
    distance = np.linalg.norm(mesh.X - size / 2, axis=1)
    return float(at_middle(distance, w) / navier(*size))


def navier(a: float, b: float) -> float:
    """Deflection in the middle of a simply supported plate a by b under a load of 1, D = 1."""
    m = np.arange(1, 200, 2)
    sign = (-1.0) ** ((m - 1) // 2)
    terms = np.outer(sign / m, sign / m) / ((m[:, None] / a) ** 2 + (m / b) ** 2) ** 2
    return 16 / math.pi**6 * terms.sum()


def rolled(X: np.ndarray, radius: float = 0.5) -> np.ndarray:
    """Positions of a sheet that is rolled about y without stretch."""
    angle = X[:, 0] / radius
    return np.column_stack([radius * np.sin(angle), X[:, 1], radius * (1 - np.cos(angle))])


def rolled_slopes(X: np.ndarray, radius: float = 0.5) -> np.ndarray:
    """Derivatives (m, 3, 2) of `rolled`."""
    angle, zero, one = X[:, 0] / radius, np.zeros(len(X)), np.ones(len(X))
    along = np.stack([np.cos(angle), zero, np.sin(angle)], axis=1)
    return np.stack([along, np.stack([zero, one, zero], axis=1)], axis=2)


def rolled_share(kind: str, model: str, columns: int) -> float:
    """Energy of the rolled sheet over area/(2 r^2), with D = 1, nu = 0, hinges of 3/8."""
    mesh = sheet(kind, columns)
    exact = mesh.X[:, 0].max() * mesh.X[:, 1].max() / (2 * 0.25)
    if model == "morley":
        space = MorleySpace(mesh)
        x = space.placed(rolled, rolled_slopes)
        params = morley_params(isotropic_bending(1.0, 0.0), space.signs)
        return k.Element("morley_tri6").energy(space.X, x, space.cells, params).sum() / exact
    return HINGE_STIFFNESS["strip"] * hinge_energy(mesh, rolled(mesh.X), model) / exact


def shares(kind: str) -> dict[str, list[float]]:
    """What the table reports of a kind of mesh, by the heads of its columns; of strips and plates by two sizes."""
    found = {surface: [hinge_share(kind, surface)] for surface in SURFACES}
    for model in ("hinge", "Morley"):
        # Hinges of k = 1 act as 8/3 and as 3 on equilateral triangles.
        strip, plate = (1 / HINGE_STIFFNESS[use] if model == "hinge" else 1.0 for use in ("strip", "plate"))
        found[f"strip, {model}"] = [strip * strip_share(kind, model.lower(), n) for n in (32, 96)]
        found[f"plate, {model}"] = [plate * plate_share(kind, model.lower(), n) for n in (16, 48)]
    for head, model in (("rolled: hinge", "hinge_flap4"), ("nonlinear", "hinge_nonlinear_flap4"), ("Morley", "morley")):
        found[head] = [rolled_share(kind, model, 48)]
    return found


def table(found: dict[str, dict[str, list[float]]]) -> str:
    """The table of docs/theory/cloth.md, as Markdown, from the shares of each kind."""
    heads = list(next(iter(found.values())))
    lines = ["| mesh | " + " | ".join(heads) + " |", "|" + " --- |" * (len(heads) + 1)]
    for kind, row in found.items():
        digits = [3 if head in SURFACES else 4 for head in heads]
        cells = [", ".join(f"{share:.{n}f}" for share in row[head]) for head, n in zip(heads, digits)]
        lines.append(f"| {kind} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


SHOWN = {
    "deflection over the exact one": {
        "plate, hinge": ("#d55e00", "s", "square plate, hinges"),
        "strip, hinge": ("#e69f00", "D", "strip, hinges"),
        "plate, Morley": ("#0072b2", "o", "square plate, Morley"),
        "strip, Morley": ("#56b4e9", "^", "strip, Morley"),
    },
    "energy of hinges over that\non equilateral triangles": {
        "cylinder": ("#d55e00", "s", "cylinder along x"),
        "cylinder at 45": ("#e69f00", "D", "cylinder at 45°"),
        "sphere": ("#cc79a7", "v", "sphere"),
    },
}
"""Panels of the picture, and what each shows: colour, marker, name."""


def draw(found: dict[str, dict[str, list[float]]], path: Path) -> None:
    """Draws the five kinds of mesh and, below, what hinges and Morley's triangles make of them; 1 is right."""
    from restshape.report.style import FAINT, INK, new_figure

    figure = new_figure(9.5, 5.6)
    meshes, panels = figure.subfigures(2, 1, height_ratios=(1, 2))
    for axes, kind in zip(meshes.subplots(1, len(KINDS)), KINDS):
        mesh = sheet(kind, 6)
        axes.triplot(*mesh.X.T, mesh.cells, color=INK, linewidth=0.6)
        axes.set(aspect="equal", title=kind)
        axes.set_axis_off()
    for axes, (label, series) in zip(panels.subplots(1, len(SHOWN)), SHOWN.items()):
        axes.axhline(1.0, color=FAINT, linewidth=0.9)
        for place, (head, (colour, marker, name)) in enumerate(series.items()):
            finest = np.array([row[head][-1] for row in found.values()])
            right = 1.0 if head not in SURFACES else finest[0]
            x = np.arange(len(KINDS)) + 0.11 * (place - (len(series) - 1) / 2)
            axes.plot(x, finest / right, color=colour, marker=marker, linestyle="none", label=name)
        axes.set_xticks(range(len(KINDS)), KINDS)
        axes.set_ylabel(label)
        axes.grid(True, axis="y", color="#eeeeee")
        axes.set_axisbelow(True)
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.1), ncols=2)
    figure.suptitle(
        "Bending on five kinds of mesh, 1 is right: hinges are another material on each, Morley's triangles are not"
    )
    figure.savefig(path)


def main() -> None:
    """Prints the table, and draws the picture if asked to."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--picture", type=Path, metavar="FILE", help="draws it too (.png)")
    args = parser.parse_args()
    found = {kind: shares(kind) for kind in KINDS}
    print(table(found))
    if args.picture:
        draw(found, args.picture)
        print(f"\nwrote {args.picture}")


if __name__ == "__main__":
    main()
