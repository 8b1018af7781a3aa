"""Hypothesis strategies of examples: a scene of an application, an edit script, and damage to them."""

import json
from collections.abc import Sequence

from hypothesis import strategies as st
from restshape_studies.stability.damage import keys_of, plain_values, replaced, spliced, splices, values, without
from restshape_studies.stability.example import Example
from restshape_studies.stability.random_scenes import RandomScenes
from restshape_studies.stability.shape_strategies import Table
from restshape_studies.stability.tables import toml
from restshape_studies.verification import verification

from restshape.policy import POLICIES

WRITTEN_SHARE = 5
"""Every fifth example, about, is replayed by the command too."""
rests = st.sampled_from([[{"do": "idle", "frames": 2}], [{"do": "analyse"}]])


def scripts(scene: Table, known: RandomScenes) -> st.SearchStrategy[list[Table]]:
    """Events of at most some 60 frames for a scene, with the header first."""
    part = st.one_of(*known.edits(scene), rests)
    return st.builds(timed, st.sampled_from(list(known.heads)), st.lists(part, min_size=1, max_size=8))


def timed(head: Table, parts: list[list[Table]]) -> list[Table]:
    """The lines of a script whose events are a tenth of a second apart."""
    events = [event for part in parts for event in part]
    first = {"format": "restshape-edits", "version": 1, "units": "m", **head}
    return [first, *({"t": round(0.1 * k, 6), **event} for k, event in enumerate(events))]


@st.composite
def examples(draw: st.DrawFn, apps: Sequence[str], damaged: bool) -> Example:
    """A scene of one of the applications with its edits; or the same after some damage."""
    app = draw(st.sampled_from(list(apps)))
    known = verification(app).load_random_scenes()
    scene = draw(known.scenes)
    lines = draw(scripts(scene, known))
    harm = draw(st.sampled_from(["a value", "a key", "an event", "scene", "edits"])) if damaged else ""
    if harm == "a value":
        scene = replaced(scene, draw(st.sampled_from(keys_of(scene))), draw(plain_values))
    elif harm == "a key":
        scene = without(scene, draw(st.sampled_from(keys_of(scene))))
    elif harm == "an event":
        line = draw(st.integers(0, len(lines) - 1))
        lines = [*lines]
        lines[line] = {**lines[line], draw(st.sampled_from(list(lines[line]))): draw(values)}
    text, edits = toml(scene), "".join(json.dumps(line) + "\n" for line in lines)
    if harm == "scene":
        text = spliced(text, draw(st.lists(splices, min_size=1, max_size=3)))
    elif harm == "edits":
        edits = spliced(edits, draw(st.lists(splices, min_size=1, max_size=3)))
    policy = draw(st.sampled_from(list(POLICIES)[::-1]))
    # What cannot be predicted is asked for at times, for it is refused.
    can = known.predictable(scene) and policy != "rebuild" and "analysis" not in lines[0]
    predict = draw(st.sampled_from(["none", "linear"])) if can or draw(st.integers(0, 19)) == 19 else "none"
    written = draw(st.integers(1, WRITTEN_SHARE)) == WRITTEN_SHARE
    return Example(app, text, edits, policy, predict, harm, written)
