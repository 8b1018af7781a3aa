"""Cloth that is relaxed to equilibrium: pieces cut from a flat pattern that hang from supports and lie on bodies.

After chapter 5 of the thesis. Quantities of interest: places, reactions, energies and areas of the cloth in
equilibrium.
"""

from pathlib import Path

from restshape.application import Application, Command, Declared, HandMarks

SUMMARY = "write a sewing pattern in another format, or as a scene"

application = Application(
    name="couture",
    summary="cloth that hangs from supports and lies on bodies, in static equilibrium",
    folder=Path(__file__).parent,
    physics=Declared("restshape.physics.cloth.cloth_declaration:CLOTH"),
    analysis="restshape.physics.cloth.relaxation.relaxation_analysis:RelaxationAnalysis",
    marks=HandMarks("restshape_apps.couture.drape_marks:drape_marks"),
    commands=(
        Command("drapes", "draw single frames of a recording of cloth", "restshape_apps.couture.drapes_command"),
        Command(
            "fit", "find the stiffness with which a drape has a measured outline", "restshape_apps.couture.fit_command"
        ),
        Command("mannequin", "make the surface of a body by its measures", "restshape_apps.couture.mannequin_command"),
        Command("pattern", SUMMARY, "restshape_apps.couture.pattern_command"),
        Command("shadow", "draw the outline of a recorded drape from above", "restshape_apps.couture.shadow_command"),
    ),
)
