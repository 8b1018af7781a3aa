"""Cloth that is relaxed to equilibrium: pieces cut from a flat pattern that hang from supports and lie on bodies.

After chapter 5 of the thesis. Quantities of interest: places, reactions, energies and areas of the cloth in
equilibrium.
"""

from pathlib import Path

from restshape.application import Application
from restshape.physics.cloth.cloth_declaration import CLOTH

application = Application(
    name="couture",
    summary="cloth that hangs from supports and lies on bodies, in static equilibrium",
    folder=Path(__file__).parent,
    physics=(CLOTH,),
    analysis="restshape.physics.cloth.relaxation.relaxation_analysis:RelaxationAnalysis",
)
