"""What material at each place of a bar does to the tones that rasping looks at."""

from dataclasses import dataclass

from restshape.analysis.modal.modal import ModalAnalysis
from restshape.sensitivity.frequency_derivative import nodal_gradient
from restshape.sensitivity.outline_density import OutlineDensity, outline_density
from restshape.sensitivity.thickness_density import ThicknessDensity, thickness_density


@dataclass(frozen=True, eq=False)
class Densities:
    """Along the outline and underneath, a mode after the other.

    Args:
        ranks: of the modes, from 0, the first tone's at the head.
        outline: of each along the outline.
        underneath: of each by the thickness; none of a plane solid.
    """

    ranks: list[int]
    outline: list[OutlineDensity]
    underneath: list[ThicknessDensity]


def densities_of(analysis: ModalAnalysis, ranks: list[int]) -> Densities:
    """The densities of modes that stand alone.

    Args:
        analysis: solved on the mesh as it lies.
        ranks: as of `Densities`.
    """
    modes = [int(analysis.state.modes.chosen[rank]) for rank in ranks]
    gradients = [nodal_gradient(analysis, mode) for mode in modes]
    outline = [outline_density(analysis, mode, own) for mode, own in zip(modes, gradients)]
    pairs = zip(modes, gradients) if "z" in analysis.state.body.axes else ()
    return Densities(ranks, outline, [thickness_density(analysis, mode, own) for mode, own in pairs])
