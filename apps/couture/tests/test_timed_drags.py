"""`restshape bench drags`: counts of frames that are solved for; times are not held."""

import pytest
from restshape_studies.bench.drags import drag_times
from restshape_studies.commands.bench import KINDS
from restshape_studies.verification import verifications
from restshape_verification.couture.drapes import UPRIGHT, fabric, pinned, scene, sheet

SECOND = '[supports.second]\non = "c"\nfix = { x = -0.05, y = 0, z = 0 }\n'


@pytest.mark.slow
def test_frames_that_are_solved_for_are_counted_with_contact_and_without(tmp_path):
    text = scene("napkin", 0.05, sheet(0, 0, 0.4, 0.3) + fabric("linen") + pinned(first="d") + SECOND + UPRIGHT)
    edits = [{"do": "set", "key": "supports.second.fix.x", "value": -0.06, "frames": 3}, {"do": "idle", "frames": 2}]
    said = []
    found = drag_times("napkin", text, edits, tmp_path, said.append)
    assert said == ["napkin, contact with itself on", "napkin, contact with itself off"]
    for one in found.values():
        assert one["frames"] == one["newton"] == one["at_rest"] == 3 and one["jumps"] == 0
        assert 1 <= one["steps"] <= 5 and 0.0 < one["median"] <= one["worst"] and one["first"] > 0.0
    KINDS["drags"].show(None, "napkin", found)


def test_its_scenes_have_edits():
    known = verifications()["couture"].load_drags()
    assert len(known) == 5 and all(edits for _, edits in known.values())
