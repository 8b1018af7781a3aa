"""How the tones of a plate follow its numbers and its outline."""

from typing import Any

import numpy as np

from restshape.analysis.modal.modal import ModalAnalysis
from restshape.cli.options import print_table
from restshape.sensitivity.frequency_derivative import stands_alone
from restshape.sensitivity.outline_density import edge_densities, outline_density
from restshape.sensitivity.thickness_density import nodal_areas, thickness_density


def keys_of(analysis: ModalAnalysis) -> list[str]:
    """The numbers that every such scene has: of each material those that are no formula, and all parameters."""
    keys = []
    for name, material in analysis.state.scene.material.items():
        own = ["rho"] if material.E is None else ["E", "nu", "rho"]
        own += ["thickness"] if isinstance(material.thickness, int | float) else []
        keys += [f"material.{name}.{key}" for key in own]
    return keys + [f"parameters.{name}" for name in analysis.state.scene.parameters]


def along_outline(analysis: ModalAnalysis) -> list[dict[str, Any]]:
    """Of each mode that stands alone, edge by edge: places [m] and the density [Hz/m^2] there."""
    found = []
    for rank, mode in enumerate(analysis.state.modes.chosen, 1):
        if not stands_alone(analysis, int(mode)):
            continue
        edges = {
            name: {
                "at": own.at.tolist(),
                "normal": own.normal.tolist(),
                "length": own.length.tolist(),
                "density": own.density.tolist(),
            }
            for name, own in edge_densities(analysis, outline_density(analysis, int(mode))).items()
        }
        found.append({"mode": rank, "frequency": float(analysis.frequencies[rank - 1]), "edges": edges})
    return found


def print_outline(found: list[dict[str, Any]]) -> None:
    """Print by how much each edge changes each tone if a tenth of a millimetre is rasped off all along it."""
    heads = ("0.1 mm off edge", *(f"mode {entry['mode']}: [Hz]" for entry in found))
    edges = list(dict.fromkeys(edge for entry in found for edge in entry["edges"]))
    rows = [(edge, *(f"{_rasped(entry['edges'].get(edge)):+.2f}" for entry in found)) for edge in edges]
    print_table("", heads, rows, right=heads[1:])


def _rasped(edge: dict[str, Any] | None, depth: float = 1e-4) -> float:
    """The change [Hz] by a depth [m] off an edge."""
    return -depth * float(np.dot(edge["density"], edge["length"])) if edge else 0.0


def underneath(analysis: ModalAnalysis) -> dict[str, Any]:
    """The plane mesh [m], and of each mode that stands alone the density [Hz/m^3] by the thickness at its nodes.

    Raises:
        UserError: the body is a plane one.
    """
    mesh, modes = analysis.state.space.mesh, []
    for rank, mode in enumerate(analysis.state.modes.chosen, 1):
        if stands_alone(analysis, int(mode)):
            own = thickness_density(analysis, int(mode))
            frequency = float(analysis.frequencies[rank - 1])
            together = float(own.gradient.sum())
            modes.append({"mode": rank, "frequency": frequency, "rate": together, "density": own.density.tolist()})
    return {"nodes": mesh.X.tolist(), "triangles": mesh.cells.tolist(), "modes": modes}


def print_underneath(found: dict[str, Any], depth: float = 1e-4) -> None:
    """Print by how much each tone changes if a tenth of a millimetre is rasped off underneath, tenth by tenth of x."""
    x, triangles = np.array(found["nodes"])[:, 0], np.array(found["triangles"])
    area = nodal_areas(np.array(found["nodes"]), triangles)
    tenth = np.minimum((10.0 * (x - x.min()) / np.ptp(x)).astype(int), 9)
    sums = [np.bincount(tenth, area * own["density"], 10) for own in found["modes"]]
    bounds = 1e3 * (x.min() + np.ptp(x) * np.linspace(0.0, 1.0, 11))
    heads = ("0.1 mm off underneath, x [mm]", *(f"mode {own['mode']}: [Hz]" for own in found["modes"]))
    rows = [
        (f"{bounds[k]:.0f} to {bounds[k + 1]:.0f}", *(f"{-depth * own[k]:+.2f}" for own in sums)) for k in range(10)
    ]
    rows.append(("all", *(f"{-depth * own['rate']:+.2f}" for own in found["modes"])))
    print_table("", heads, rows, right=heads[1:])
