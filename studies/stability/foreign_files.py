"""Drawings and meshes of a small square with a hole, in every format that scenes may name."""

import io
import tempfile
from functools import cache
from pathlib import Path

import ezdxf
import meshio
import numpy as np

GEO = b"""// A square with a round hole.
SetFactory("Built-in");
r = 0.1;
Point(1) = {0, 0, 0}; Point(2) = {1, 0, 0}; Point(3) = {1, 1, 0}; Point(4) = {0, 1, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Point(5) = {0.5, 0.5, 0}; Point(6) = {0.5 + r, 0.5, 0}; Point(7) = {0.5 - r, 0.5, 0};
Circle(5) = {6, 5, 7}; Circle(6) = {7, 5, 6};
Curve Loop(1) = {1, 2, 3, 4}; Curve Loop(2) = {5, 6};
Plane Surface(1) = {1, 2};
For i In {1:3} k = i; EndFor
Physical Curve("left") = {4}; Physical Surface("body") = {1};
"""
BOOLEAN = b"""SetFactory("OpenCASCADE");
Rectangle(1) = {0, 0, 0, 1, 1}; Disk(2) = {0.5, 0.5, 0, 0.1};
BooleanDifference{ Surface{1}; Delete; }{ Surface{2}; Delete; }
"""
SVG = b"""<svg xmlns="http://www.w3.org/2000/svg" width="1000mm" height="1000mm" viewBox="0 0 100 100">
<rect id="side" width="100" height="100"/><g transform="translate(50 50) rotate(10)"><circle id="bore" r="10"/></g>
<path id="slot" d="M20 20 h10 c5 0 5 10 0 10 q-5 -5 -10 0 a5 5 0 0 1 0 -10 z"/><use href="#slot" x="50" y="50"/></svg>
"""
N = 4
"""Squares along a side of the mesh."""
FORMATS = {"gmsh": ".msh", "gmsh22": ".msh", "vtu": ".vtu", "nastran": ".bdf", "abaqus": ".inp"}


@cache
def samples() -> dict[str, tuple[str, bytes]]:
    """Ending and bytes of a sample of each format, by its name."""
    found = {"geo": (".geo", GEO), "geo with a Boolean": (".geo", BOOLEAN), "svg": (".svg", SVG)}
    for version in ("R12", "R2010"):
        found[f"dxf {version}"] = (".dxf", _drawing(version))
    for name, ending in FORMATS.items():
        for binary in (False, True) if name in ("gmsh", "gmsh22", "vtu") else (None,):
            found[f"{name}{' binary' * bool(binary)}"] = (ending, _mesh(name, ending, binary))
    return found


def _drawing(version: str) -> bytes:
    drawing = ezdxf.new(version)
    space = drawing.modelspace()
    corners = [(0, 0), (1000, 0), (1000, 1000), (0, 1000)]
    for start, end in zip(corners, [*corners[1:], corners[0]]):
        space.add_line(start, end, dxfattribs={"layer": "side"})
    space.add_circle((500, 500), 100)
    space.add_polyline2d([(200, 200), (300, 200), (300, 300)], close=True)
    if version != "R12":
        space.add_spline(fit_points=[(700, 700), (800, 700), (750, 800), (700, 700)])
    stream = io.StringIO()
    drawing.write(stream)
    return stream.getvalue().encode()


def _mesh(name: str, ending: str, binary: bool | None) -> bytes:
    x, y = (axis.ravel() / N for axis in np.meshgrid(np.arange(N + 1.0), np.arange(N + 1.0)))
    corner = np.array([i + j * (N + 1) for j in range(N) for i in range(N)])
    cells = np.concatenate([corner[:, None] + (0, 1, N + 2), corner[:, None] + (0, N + 2, N + 1)])
    mesh = meshio.Mesh(np.stack([x, y, 0 * x], axis=1), [("triangle", cells)])
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"mesh{ending}"
        meshio.write(path, mesh, file_format=name, **({} if binary is None else {"binary": binary}))
        return path.read_bytes()
