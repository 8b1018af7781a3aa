"""Vibrating solids beside restshape's own values: where a window makes a building shake most."""

from petsc4py import PETSc
from restshape_studies.each_week import each_week
from restshape_studies.validation.case import OWN, Case, Check
from restshape_verification.vibration.resonance import study


@each_week()
def resonance(comm: PETSc.Comm) -> list[Check]:
    """Where the building's window makes it shake most, against where its eigenfrequency meets the ground's."""
    found = study(comm)
    source = "SLEPc: lowest eigenfrequency of the same shapes"
    return [
        Check("window's way down at the peak of the motion [m]", found.moving_peak, found.crossing, 0.02, source, OWN),
        Check("the same of the harmonic response [m]", found.harmonic_peak, found.crossing, 0.02, source, OWN),
        Check(
            "largest amplitude [m]",
            float(found.amplitude.max()),
            float(found.harmonic.max()),
            0.02,
            "harmonic response at each frame",
            OWN,
        ),
    ]


COMPARISONS: dict[str, Case] = {"resonance": resonance}
