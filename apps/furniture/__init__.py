"""Furniture of planks and nails: valid ranges and suggestions while it is being designed.

After chapter 6 of the thesis. What is reported of each frame: whether the piece is connected, stands and bears its
loads, how far the parameter under the hand may go, and what would mend a piece that does not hold.
"""

from pathlib import Path

from restshape_apps.furniture.session.grammar import GRAMMAR

from restshape.application import (
    Application,
    Command,
    Declared,
    Editing,
    Explanation,
    HandMarks,
    Reporting,
    ScriptLines,
    ShownColumn,
)

application = Application(
    name="furniture",
    summary="planks and nails: what holds, how far each edit may go, and what would mend it",
    folder=Path(__file__).parent,
    physics=Declared("restshape_apps.furniture.scene.declaration:PLANKS"),
    analysis="restshape_apps.furniture.analysis.furnishing:FurnitureAnalysis",
    editing=Editing(
        session="restshape_apps.furniture.session.plank_session:PlankSession",
        replayed="restshape_apps.furniture.session.plank_session:replayed_planks",
        events="restshape.scene.edit_script:PLAIN_EVENTS",
        check="restshape.scene.checks:check_parameters",
        contents="restshape_apps.furniture.cli.check_planks:checked",
        restated="restshape_apps.furniture.session.restated_scene:restated_tables",
        drawn="restshape_apps.furniture.report.drawn_scene:draw_scene",
        grabbed="restshape_apps.furniture.session.plank_things:plank_things",
    ),
    lines=ScriptLines(GRAMMAR, "restshape_apps.furniture.session.plank_language:PlankInterpreter"),
    report=Reporting(
        summary="restshape_apps.furniture.report.guided:summary",
        tables="restshape_apps.furniture.cli.guidance:print_guidance",
        pictures="restshape_apps.furniture.cli.report:draw",
        sheet="restshape_apps.furniture.cli.report:draw_sheet",
        true_scale="planks are drawn where they are",
        arguments="restshape_apps.furniture.cli.report:arguments",
        check="restshape_apps.furniture.cli.report:check",
    ),
    marks=HandMarks(
        "restshape_apps.furniture.marks.piece_marks:piece_marks",
        columns=(
            ShownColumn("utilisation", most=1.0),
            ShownColumn("stability_margin", least=0.0),
            ShownColumn("deflection", "m", effect="bending"),
            ShownColumn("bending_utilisation", most=1.0, effect="bending"),
        ),
    ),
    explained=Explanation(parts="restshape_apps.furniture.cli.frame_parts:FRAME_PARTS"),
    commands=(
        Command(
            "furniture-pictures",
            "draw pieces, suggestions, ranges, force space and valid regions",
            "restshape_apps.furniture.pictures_command",
        ),
    ),
)
