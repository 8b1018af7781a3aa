"""Between the compiled stages of a level-1 frame Python makes no array as long as the unknowns."""

import tracemalloc

import pytest
from small_scenes import across, drag, make_replay, plate, write_scene, write_script

from restshape.algebra import stages

EVENTS = drag("window", (0.5, 0.5), across((0.5, 0.5), (0.56, 0.52), 6))


class WatchedStage(stages.Stage):
    """Notes by how much memory has grown since the last stage, temporary arrays included."""

    __slots__ = ()
    depth, after, before, grown = 0, "", 0, []

    def __enter__(self):
        watched = WatchedStage
        if not watched.depth:
            watched.grown.append((tracemalloc.get_traced_memory()[1] - watched.before, watched.after, self.name))
        watched.depth += 1
        super().__enter__()

    def __exit__(self, *raised):
        super().__exit__(*raised)
        watched = WatchedStage
        watched.depth, watched.after = watched.depth - 1, self.name
        watched.before = tracemalloc.get_traced_memory()[0]
        tracemalloc.reset_peak()


@pytest.mark.parametrize("overrides", [[], ["supports.wall.fix={x=1e-4,y=0}"]])
def test_python_passes_over_no_unknowns(tmp_path, monkeypatch, overrides):
    monkeypatch.setattr(stages, "Stage", WatchedStage)
    scene, script = write_scene(tmp_path, plate(0.04)), write_script(tmp_path, EVENTS)
    replay = make_replay(scene, script, overrides=["mesh.order=1", *overrides])
    replay.errors.measuring = False
    tracemalloc.start()
    try:
        watched = 0
        for row in replay.frames():
            if row["level"] == 1 and row["index"] > 3:
                watched += 1
                vector = 8 * row["unknowns"]
                assert vector > 20_000
                assert all(grown < vector for grown, *_ in WatchedStage.grown[1:]), WatchedStage.grown
            WatchedStage.grown = []
    finally:
        tracemalloc.stop()
    assert watched >= 3
