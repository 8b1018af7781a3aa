"""Plates of metal or wood that sound when they are struck: their lowest tones while their outline is edited.

After section 4.4 of the thesis. Quantities of interest: frequencies, by rank or of a mode that is followed, and areas.
"""

from pathlib import Path

from restshape.application import Application
from restshape.physics.elasticity.elasticity_declaration import FREE_VIBRATIONS

application = Application(
    name="metallophone",
    summary="plates that sound when struck: eigenfrequencies and modes",
    folder=Path(__file__).parent,
    physics=(FREE_VIBRATIONS,),
    analysis="restshape.physics.free_vibration.vibrating_bodies:modal_analysis",
)
