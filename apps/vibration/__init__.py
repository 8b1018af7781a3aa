"""Elastic solids that vibrate in the plane, of small or large deformation, under base excitation during an edit.

Every frame of an edit but the first, idle ones too, advances the motion by `steps` time steps of `time_step`; the first
shows the body at rest at time 0. So simulated time follows from the number of frames; the edit times of a script say
only when the hand moved. Displacements and velocities are relative to the ground.

Quantities of interest: those of static solids, peaks over a frame's time steps, and energies.
"""

from pathlib import Path

from restshape.application import Application, Command, Declared, HandMarks

application = Application(
    name="vibration",
    summary="elastic solids that vibrate, also by base excitation",
    folder=Path(__file__).parent,
    physics=Declared("restshape.physics.elasticity.elasticity_declaration:MOVING_SOLIDS"),
    analysis="restshape.physics.elasticity.elasticity_analyses:transient_analysis",
    marks=HandMarks("restshape_apps.vibration.resonance_marks:resonance_marks"),
    commands=(
        Command("participation", "modes on moving ground, and peaks by a spectrum", "restshape_apps.vibration.modes"),
        Command("harmonic", "steady motion over the frequency of the ground", "restshape_apps.vibration.harmonic"),
        Command("spectrum", "the response spectrum of a record of ground motion", "restshape_apps.vibration.spectrum"),
        Command("ground-record", "write a record made by a formula", "restshape_apps.vibration.artificial_record"),
    ),
)
