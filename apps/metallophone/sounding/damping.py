"""How fast modes die away: by what the materials lose in each oscillation."""

from dataclasses import dataclass

import numpy as np

from restshape.analysis.modal.modal import ModalAnalysis
from restshape.fem.problem import STIFFNESS

USUAL = 1e-3
"""Share of critical damping of a bar of unknown loss that hangs: between that of metal and that of wood."""


@dataclass(frozen=True)
class Damping:
    """How modes die away.

    Args:
        shares: (k,) of critical damping.
        source: where they come from, in words.
    """

    shares: np.ndarray
    source: str

    def decay_times(self, frequencies: np.ndarray) -> np.ndarray:
        """Times (k,) [s] in which modes of these frequencies (k,) [Hz] lose 60 dB; infinite without damping."""
        with np.errstate(divide="ignore"):
            return np.log(1000.0) / (2.0 * np.pi * self.shares * frequencies)


def damping_of(analysis: ModalAnalysis, given: float | None = None) -> Damping:
    """The damping of the modes that the scene asks for.

    A mode whose strain energy lies in materials of several loss factors has their mean, weighted by that energy; its
    share of critical damping is half its loss factor. What air and cords take comes on top, and is not in it.

    Args:
        analysis: of a frame.
        given: one share of critical damping of all modes, instead of the materials'; None: by the materials.
    """
    count = len(analysis.frequencies)
    if given is not None:
        return Damping(np.full(count, given), "as given")
    lacking = [name for name, material in analysis.state.scene.material.items() if material.loss_factor is None]
    if lacking:
        what = f"{USUAL:g} for all modes, for material.{lacking[0]} has no loss_factor"
        return Damping(np.full(count, USUAL), what)
    factors = [material.loss_factor for material in analysis.state.body.materials]
    energies = np.abs(region_energies(analysis, len(factors)))
    loss = energies @ np.array(factors, dtype=float) / energies.sum(axis=1)
    return Damping(0.5 * loss, "half the loss factor of the materials")


def region_energies(analysis: ModalAnalysis, regions: int) -> np.ndarray:
    """The strain energies (k, regions) of the modes that the scene asks for, twice, up to the same factor in a row."""
    body, modes = analysis.state.body, analysis.state.modes
    if regions == 1:
        return np.ones((len(modes.chosen), 1))
    cells = [np.flatnonzero(body.space.cell_region == region).astype(np.int32) for region in range(regions)]
    found = np.zeros((len(modes.chosen), regions))
    for row, mode in zip(found, modes.vectors[modes.chosen]):
        x = np.ascontiguousarray(mode.reshape(body.boundary.mask.shape))
        for region, own in enumerate(cells):
            force = np.zeros_like(x)
            for integral in body.integrals(STIFFNESS):
                integral.add_residual(x, force, own)
            row[region] = float(np.vdot(x, force))
    return found
