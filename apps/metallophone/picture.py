"""Pictures of a plate: its modes with the lines where they are still, and where rasping its edge moves a tone."""

from pathlib import Path

import numpy as np
from restshape_apps.metallophone.hung import hung
from restshape_apps.metallophone.rasp import draw_outline_density

from restshape.analysis.modal.modal import ModalAnalysis
from restshape.analysis.modal.pitch import note, tone_words
from restshape.errors import UserError
from restshape.mesh.lagrange_space import LagrangeSpace
from restshape.report.modes import draw_modes
from restshape.sensitivity.frequency_derivative import stands_alone
from restshape.sensitivity.outline_density import outline_density


def draw(analysis: ModalAnalysis, path: Path) -> None:
    """Draw the modes that the scene asks for, each with its frequency and tone."""
    pairs = enumerate(zip(analysis.frequencies, tones(analysis)), 1)
    names = [f"mode {k}: {f:.1f} Hz, {tone_words(tone, cents)}" for k, (f, (tone, cents)) in pairs]
    fields, title = analysis.fields()[0], analysis.state.scene.title
    shapes = np.stack(list(fields.values()))
    points = hung(analysis)
    marks, title = (points.places, f"{title}\nrings: where to hang it") if points and points.found else (None, title)
    draw_modes(path, analysis.space.X, analysis.space.cells, shapes, names, title, marks=marks)


def tones(analysis: ModalAnalysis) -> list[tuple[str, float]]:
    """The nearest tone of each frequency, and how many cents it lies above it, tuned as the scene says."""
    a4 = analysis.state.plan.settings("modal").a4
    return [note(float(f), a4) for f in analysis.frequencies]


def draw_rasp(analysis: ModalAnalysis, path: Path) -> None:
    """Draw along the outline what rasping does to the first tone.

    Raises:
        UserError: others lie so close to it that rasping mixes their modes, which no density shows.
    """
    first = int(analysis.state.modes.chosen[0])
    if not stands_alone(analysis, first):
        f = float(analysis.frequencies[0])
        raise UserError(
            f"the first tone, {f:.1f} Hz, does not stand alone: what rasping does to it hangs on where else one rasps",
            "--rasp",
            "break the symmetry of the shape or of its supports a little, or leave --rasp out",
        )
    found = outline_density(analysis, first)
    plane = analysis.space
    mesh = plane.mesh if isinstance(plane, LagrangeSpace) else plane
    density = np.full(len(mesh.X), np.nan)
    density[found.nodes] = found.density
    title = f"{analysis.state.scene.title}: {analysis.frequencies[0]:.1f} Hz"
    draw_outline_density(path, mesh.X, mesh.cells, mesh.facets, density, title)
