"""Runs that price effects end in time, but no earlier than after a frame in which something is solved for."""

from time import sleep

import pytest
from restshape_studies.explain.paired import measure, processor_time
from small_scenes import across, drag, plate, write_scene, write_script

from restshape.algebra import stages
from restshape.application import application_of
from restshape.calibration import Calibration
from restshape.policy import policy
from restshape.replay.request import Request
from restshape.scene.edit_script import load_script
from restshape.scene.load import load_scene


@pytest.mark.parametrize(("seconds", "frames"), [(0.0, 1), (600.0, 6)])
def test_a_run_ends_after_a_frame_where_its_time_is_over(tmp_path, seconds, frames):
    scene = load_scene(write_scene(tmp_path, plate()))
    events = drag("window", (0.5, 0.5), across((0.5, 0.5), (0.56, 0.5), 6))
    script = load_script(write_script(tmp_path, events), scene)
    request = Request(scene, script, application_of(scene), policy("auto"), Calibration.load())
    rows = measure(request, [[], []], None, seconds)
    for variant in range(2):
        assert sum(row["event"] == "drag" for row in rows if row["variant"] == variant) == frames


def test_stages_have_the_processors_time():
    with processor_time():
        found = stages.Stages()
    with found("krylov"):
        with found("factor"):
            sleep(0.05)
            sum(range(200_000))
        sleep(0.05)
    assert 0.0 < found.seconds["factor"] < 0.04 and found.seconds["krylov"] < 0.02
    assert not stages.Stages()._stages["values"].__class__.__name__.startswith("Processor")
