"""The maps of what rasping does to the first tone of a bar: underneath, and along its outline."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.path import Path
from matplotlib.tri import Triangulation
from restshape_apps.metallophone.rasping.densities import Densities
from restshape_apps.metallophone.rasping.tolerances import CENTS, TENTH

from restshape.analysis.modal.modal import ModalAnalysis
from restshape.mesh.mesh import Mesh
from restshape.sensitivity.outline_density import OutlineDensity, edge_densities

PER_CENTIMETRE = 1e-2
"""Of outline [m], that a tenth of a millimetre comes off; its square underneath."""


def draw_maps(figure: Figure, axes: Axes, analysis: ModalAnalysis, densities: Densities) -> None:
    """Draw in millimetres what 0.1 mm off does to the first tone: underneath, and as the colour of the outline."""
    rate = -CENTS * TENTH / float(analysis.frequencies[0])
    for thickness in densities.underneath[:1]:
        _draw_underneath(figure, axes, analysis.state.space.mesh, rate * PER_CENTIMETRE**2 * thickness.density)
    _draw_outline(figure, axes, analysis, densities.outline[0], rate * PER_CENTIMETRE)


def _draw_underneath(figure: Figure, axes: Axes, mesh: Mesh, values: np.ndarray) -> None:
    size = float(np.percentile(np.abs(values), 98))
    triangles = Triangulation(*(1e3 * mesh.X).T, mesh.cells)
    face = axes.tripcolor(triangles, values, shading="gouraud", cmap="RdBu_r", clim=(-size, size))
    label = "underneath: cents by 0.1 mm off each cm²"
    figure.colorbar(face, ax=axes, orientation="horizontal", aspect=50, label=label)


def _draw_outline(figure: Figure, axes: Axes, analysis: ModalAnalysis, found: OutlineDensity, rate: float) -> None:
    mesh, densities = analysis.state.space.mesh, edge_densities(analysis, found)
    segments, values = [], []
    for number, edge in enumerate(mesh.outline.edges):
        if edge.name in densities:
            facets = mesh.facets[mesh.facet_edge == number]
            of_node = dict(zip(np.unique(facets).tolist(), densities[edge.name].density.tolist()))
            segments += list(1e3 * mesh.X[facets])
            values += [0.5 * (of_node[a] + of_node[b]) for a, b in facets.tolist()]
    # Half of the width lies beyond the outline, and is cut off.
    shown = rate * np.array(values)
    size = float(np.percentile(np.abs(shown), 95))
    lines = LineCollection(segments, array=shown, cmap="PuOr_r", clim=(-size, size), linewidths=9)
    axes.add_collection(lines)
    inside = Path.make_compound_path(*(Path(1e3 * mesh.X[triangle], closed=False) for triangle in mesh.cells))
    lines.set_clip_path(inside, axes.transData)
    axes.add_collection(LineCollection(1e3 * mesh.X[mesh.facets], colors="black", linewidths=0.7))
    label = "outline: cents by 0.1 mm off each cm"
    figure.colorbar(lines, ax=axes, orientation="horizontal", aspect=50, label=label)
