"""Plates of metal or wood that sound when they are struck: their lowest tones while their outline is edited.

After section 4.4 of the thesis. Quantities of interest: frequencies, by rank or of a mode that is followed, and areas.
"""

from pathlib import Path

from restshape.application import Application, Command, Declared, Explanation, Exporting, HandMarks

WORKSHOP = "restshape_apps.metallophone.workshop"

application = Application(
    name="metallophone",
    summary="plates that sound when struck: eigenfrequencies and modes",
    folder=Path(__file__).parent,
    physics=Declared("restshape.physics.elasticity.elasticity_declaration:FREE_VIBRATIONS"),
    analysis="restshape.physics.free_vibration.vibrating_bodies:modal_analysis",
    marks=HandMarks(
        "restshape_apps.metallophone.tone_marks:tone_marks", "restshape_apps.metallophone.struck_tone:struck_tone"
    ),
    explained=Explanation(costs="restshape_apps.metallophone.tuning.cost:tuning_cost"),
    exports=Exporting(
        arguments=f"{WORKSHOP}.options:arguments",
        check=f"{WORKSHOP}.options:check",
        formats={"pdf": f"{WORKSHOP}.sheet:write_sheet", "wav": f"{WORKSHOP}.blow_file:write_blow"},
        engraved=f"{WORKSHOP}.engraving:engraving",
        shaped=f"{WORKSHOP}.engraving:drilled",
        layers="cut",
    ),
    commands=(
        Command("modes", "draw modes with their tones and nodal lines", "restshape_apps.metallophone.modes_command"),
        Command(
            "sound", "write the sound of a plate that is struck (.wav)", "restshape_apps.metallophone.sound_command"
        ),
        Command(
            "rates", "print the rates of tones with numbers and outline", "restshape_apps.metallophone.rates_command"
        ),
        Command("pitches", "draw the tone of a recorded edit", "restshape_apps.metallophone.pitches_command"),
        Command("tune", "change a bar so that it has a wanted tone", "restshape_apps.metallophone.tune_command"),
        Command(
            "instrument",
            "several bars side by side: table, picture, scale",
            "restshape_apps.metallophone.instrument_command",
        ),
    ),
)
