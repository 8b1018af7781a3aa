"""Table 4.1 of the thesis: what a frame of each level recomputes, counted by PETSc's own events."""

import pytest
from petsc4py import PETSc
from small_scenes import across, drag, make_replay, plate, rows_of, write_scene, write_script

from restshape.algebra.stages import LOGGED, log_stage

WATCHED = (
    "RestshapePattern",
    "RestshapePatch",
    "RestshapeValues",
    "MatAssemblyEnd",
    "MatCholFctrSym",
    "MatCholFctrNum",
    "MatILUFactorSym",
    "MatLUFactorNum",
    "MatGetOrdering",
    "MatSolve",
    "KSPSolve",
    "PCSetUp",
)
SYMBOLIC, NUMERIC = ("MatCholFctrSym", "MatILUFactorSym"), ("MatCholFctrNum", "MatLUFactorNum")
SETUP = ("RestshapePattern", "MatGetOrdering", *SYMBOLIC)
EVENTS = [
    *drag("window", (0.5, 0.5), across((0.5, 0.5), (1.5, 0.5), 60)),
    {"do": "idle", "frames": 2},
]


@pytest.fixture(scope="module", autouse=True)
def _logged():
    PETSc.Log.begin()


def stages():
    """PETSc's main stage and those of restshape."""
    return [None, *map(log_stage, LOGGED)]


def counts():
    """How often each watched event has happened so far, in all log stages."""
    found = dict.fromkeys(WATCHED, 0)
    for stage in stages():
        for name in WATCHED:
            found[name] += PETSc.Log.Event(name).getPerfInfo(stage and stage.id)["count"]
    return found


def counted(folder, name, **changed):
    """The rows of a drag, each with what happened in it."""
    made = make_replay(write_scene(folder, plate(0.07)), write_script(folder, EVENTS), name, **changed)
    # What is counted is the frame alone, without what is measured beside it.
    made.errors.estimating = False
    rows, before = [], counts()

    def look(row):
        nonlocal before
        now = counts()
        rows.append({**row, "events": {key: now[key] - before[key] for key in WATCHED}})
        before = now

    rows_of(made, look)
    return rows


def happened(rows, *names):
    """The number of events of these names in the rows."""
    return sum(row["events"][name] for row in rows for name in names)


def by_level(rows):
    """The rows of levels 0 (idle), 1, 2 and 3; the first frame, made from nothing, is of level 3."""
    return [[row for row in rows if row["level"] == level] for level in range(4)]


@pytest.fixture(scope="module", params=["thesis", "auto"])
def rows(request, tmp_path_factory):
    # The thesis's relocation and criterion flip more often than ours.
    flipping = {"relocation": "laplacian", "criterion": "author"}
    return counted(tmp_path_factory.mktemp(request.param), request.param, **flipping), request.param


def test_the_drag_has_all_levels(rows):
    assert all(len(level) >= 2 for level in by_level(rows[0]))


def test_idle_frames_do_nothing(rows):
    idle = by_level(rows[0])[0]
    assert {row["event"] for row in idle} == {"press", "release", "idle"}
    assert happened(idle, *WATCHED) == 0


def test_level_1_brings_new_values_only(rows):
    found, name = rows
    level = by_level(found)[1]
    kept = [row for row in level if not row["pc_rebuilt"]]
    assert len(kept) > len(level) / 2
    assert happened(level, "RestshapeValues") == len(level)
    assert happened(level, "RestshapePattern", "RestshapePatch") == 0
    assert happened(kept, *SETUP, *NUMERIC) == 0
    if name == "thesis":
        assert kept == level
    assert happened(level, *NUMERIC) == len(level) - len(kept)
    # A refresh analyses the pattern again only where flips have changed it since the last one.
    flipped = 0
    for row in found:
        flipped += row["level"] == 2
        if row["pc_rebuilt"]:
            assert happened([row], *SYMBOLIC) == (row["level"] == 3 or flipped > 0)
            flipped = 0
    assert happened(kept, "KSPSolve") == len(kept)
    assert happened(kept, "MatSolve") >= len(kept)


def test_level_2_patches_the_pattern_and_keeps_the_factor(rows):
    found, name = rows
    level = by_level(found)[2]
    kept = [row for row in level if not row["pc_rebuilt"]]
    assert kept and happened(level, "RestshapePatch") == len(level)
    assert happened(level, "RestshapePattern") == 0
    assert happened(kept, *SYMBOLIC, *NUMERIC, "MatGetOrdering") == 0
    assert happened(level, "RestshapeValues") == len(level)
    if name == "thesis":
        assert kept == level


def test_level_3_makes_everything(rows):
    level = by_level(rows[0])[3]
    assert all(row["pc_rebuilt"] for row in level)
    for names in (("RestshapePattern",), ("RestshapeValues",), SYMBOLIC, NUMERIC, ("KSPSolve",)):
        assert happened(level, *names) == len(level), names
    assert happened(level, "RestshapePatch") == 0


def test_refactor_has_one_symbolic_analysis_a_mesh(tmp_path):
    rows = counted(tmp_path, "refactor")
    _, relocated, _, new = by_level(rows)
    assert happened(relocated, *NUMERIC) == len(relocated) and happened(relocated, *SETUP) == 0
    assert happened(new, *SYMBOLIC) == len(new)


@pytest.mark.slow
def test_rebuild_makes_everything_in_each_frame_that_moves(tmp_path):
    rows = counted(tmp_path, "rebuild")
    idle, relocated, flipped, new = by_level(rows)
    assert not relocated and not flipped and len(new) == 61
    assert happened(new, *SYMBOLIC) == len(new) and happened(new, "RestshapePattern") == len(new)
    assert happened(idle, *WATCHED) == 0
