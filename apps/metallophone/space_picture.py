"""Pictures of modes in space, and of one that moves through a period."""

from pathlib import Path

from restshape_apps.metallophone.picture import tones

from restshape.analysis.modal.modal import ModalAnalysis
from restshape.analysis.modal.pitch import tone_words
from restshape.errors import UserError
from restshape.mesh.thickness import Thickness
from restshape.outputs.si_numbers import counted_are
from restshape.physics.elasticity.vibrating_materials import common_thickness
from restshape.report.bent_plate import FlatBody
from restshape.report.mode_period import draw_period
from restshape.report.space_modes import SpaceMode, draw_space_modes


def draw_in_space(analysis: ModalAnalysis, path: Path) -> None:
    """Draw the modes that the scene asks for, in space."""
    draw_space_modes(path, flat_body(analysis), space_modes(analysis), analysis.state.scene.title)


def draw_one_period(analysis: ModalAnalysis, path: Path, rank: int) -> None:
    """Draw one period of a mode as a GIF.

    Args:
        analysis: of a frame; path: of the GIF.
        rank: of the mode, 1 of the lowest.

    Raises:
        UserError: there is no such mode, or the file is no GIF.
    """
    modes = space_modes(analysis)
    if not 1 <= rank <= len(modes):
        what = f"only {counted_are(len(modes), 'mode')} computed"
        raise UserError(what, f"--mode {rank}", "name one of them, or set effects.modal.modes")
    frequency = float(analysis.frequencies[rank - 1])
    draw_period(path, flat_body(analysis), modes[rank - 1], frequency, analysis.state.scene.title)


def flat_body(analysis: ModalAnalysis) -> FlatBody:
    """The body of a frame, at rest."""
    scene, space = analysis.state.scene, analysis.space
    return FlatBody(space.X, space.cells, Thickness(common_thickness(scene), scene.parameters).at(space.X))


def space_modes(analysis: ModalAnalysis) -> list[SpaceMode]:
    """The modes that the scene asks for, each with its frequency and tone."""
    modes, found = analysis.state.modes, []
    shapes = analysis.fields()[0].values()
    shares = modes.participation[modes.chosen]
    for k, (shape, f, (tone, cents), share) in enumerate(zip(shapes, analysis.frequencies, tones(analysis), shares), 1):
        found.append(SpaceMode(shape, float(share), f"mode {k}: {f:.1f} Hz, {tone_words(tone, cents)}"))
    return found
