"""Hypothesis strategies of examples: a scene of an application, an edit script, and damage to them."""

from collections.abc import Sequence

from hypothesis import strategies as st
from restshape_studies.stability.batch import DAMAGED, FILES, RECORDINGS
from restshape_studies.stability.example import ONTO, Example
from restshape_studies.stability.formula_strategies import parameter_sets, with_formulas
from restshape_studies.stability.hostile_files import hostile_files
from restshape_studies.stability.mutators import MUTATORS, texts
from restshape_studies.stability.random_scenes import RandomScenes
from restshape_studies.stability.shape_strategies import Table
from restshape_studies.verification import verification

from restshape.policy import POLICIES

WRITTEN_SHARE = 12
"""Every twelfth example, about, is replayed by the command too."""
ONTO_SHARE = 16
"""In every sixteenth example the command is asked to write over a file of the user's."""
FORMULA_SHARE = 4
"""In every fourth scene some numbers follow parameters."""
MOST_PARTS = 5
"""Gestures and edits of a script."""
RECORDED_LINES, RECORDED_QUANTITIES = 4, 2
"""Of scenes whose recordings are damaged: reports of few frames and quantities are drawn fast."""
rests = st.sampled_from([[{"do": "idle", "frames": 2}], [{"do": "analyse"}]])


def scripts(scene: Table, known: RandomScenes, formulas: bool) -> st.SearchStrategy[list[Table]]:
    """Events of at most some 40 frames for a scene, with the header first; with formulas also sets of parameters."""
    part = st.one_of(*known.edits(scene), rests, *([parameter_sets] if formulas else []))
    return st.builds(timed, st.sampled_from(list(known.heads)), st.lists(part, min_size=1, max_size=MOST_PARTS))


def timed(head: Table, parts: list[list[Table]]) -> list[Table]:
    """The lines of a script whose events are a tenth of a second apart."""
    events = [event for part in parts for event in part]
    first = {"format": "restshape-edits", "version": 1, "units": "m", **head}
    return [first, *({"t": round(0.1 * k, 6), **event} for k, event in enumerate(events))]


@st.composite
def examples(draw: st.DrawFn, apps: Sequence[str], kind: str) -> Example:
    """A scene of one of the applications with its edits, of one of `batch.KINDS`."""
    scenes = {app: verification(app).load_random_scenes() for app in apps}
    app = draw(st.sampled_from([app for app, known in scenes.items() if kind != FILES or known.outlined]))
    known = scenes[app]
    scene = draw(known.scenes)
    formulas = draw(st.integers(1, FORMULA_SHARE)) == FORMULA_SHARE
    lines = draw(scripts(scene, known, formulas))
    scene = draw(with_formulas(scene)) if formulas else scene
    harm, files = "", {}
    if kind == FILES:
        scene, harm, files = draw(hostile_files(scene))
        lines = timed({}, [[{"do": "scale", "on": "outline", "factor": 1.1, "frames": 2}], [{"do": "undo"}]])
    if kind == RECORDINGS:
        scene = {**scene, "quantities": dict([*scene.get("quantities", {}).items()][:RECORDED_QUANTITIES])}
        lines = lines[:RECORDED_LINES]
    if kind == DAMAGED:
        harm = draw(st.sampled_from(list(MUTATORS)))
        text, edits = MUTATORS[harm](draw, scene, lines)
    else:
        text, edits = texts(scene, lines)
    policy = draw(st.sampled_from(list(POLICIES)[::-1]))
    # What cannot be predicted is asked for at times, for it is refused.
    can = known.predictable(scene) and policy != "rebuild" and "analysis" not in lines[0]
    predict = draw(st.sampled_from(["none", "linear", "gmls"])) if can or draw(st.integers(0, 19)) == 19 else "none"
    written = draw(st.integers(1, WRITTEN_SHARE)) == WRITTEN_SHARE
    onto = draw(st.sampled_from([*ONTO])) if draw(st.integers(1, ONTO_SHARE)) == ONTO_SHARE else ""
    return Example(app, text, edits, policy, predict, harm, written, files, onto)
