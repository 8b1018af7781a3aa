"""What a plate shows at the hand: where its modes are still, where it hangs, how it is heard when struck."""

from pathlib import Path

import numpy as np
import pytest
from marked_edits import last_marks, rows_with_and_without
from restshape_apps.metallophone.sounding.blow import partials, struck
from restshape_apps.metallophone.sounding.damping import damping_of
from restshape_apps.metallophone.sounding.place import struck_place

import restshape
from restshape.application import application_of
from restshape.errors import UserError
from restshape.live.shown_marks import Tone

SCENES = Path(__file__).parents[1] / "scenes"
FREE = 0.2242
"""Where the lowest mode of a slender free bar is still, over its length."""


@pytest.fixture(scope="module")
def bar():
    with restshape.open(restshape.load(SCENES / "bar_200.toml")) as simulation:
        yield simulation


def test_a_free_bar_is_still_at_0_224_of_its_length_and_hangs_there(bar):
    marks = last_marks(bar)
    x = marks["mode 1 is still"].points[:, 0] / np.ptp(bar.frame.mesh.points[:, 0])
    assert np.allclose(np.where(x > 0.5, 1.0 - x, x), FREE, atol=0.01)
    assert np.allclose(np.sort(marks["hang it here"].points[:, 0]), [FREE * 0.2, (1.0 - FREE) * 0.2], atol=0.002)
    assert marks["mode 1 is still"].words[0].startswith(f"mode 1: {bar.frame.row['tone']} ")


def test_the_tone_has_the_frequencies_of_the_frame_and_the_decays_of_the_material(bar):
    (tone,) = (one for one in last_marks(bar).values() if isinstance(one, Tone))
    assert tone.frequencies[0] == bar.frame.quantities["pitch"] and max(tone.amplitudes) == 1.0
    shares = damping_of(bar.replay.analysis).shares
    assert np.allclose(tone.decays, 2.0 * np.pi * np.array(tone.frequencies) * shares)
    assert tone.name in last_marks(bar) or any(text.startswith(tone.name) for text in last_marks(bar))


def test_partials_add_up_to_what_is_heard_of_a_blow():
    f, phi, damping, contact = np.array([400.0, 1100.0]), np.array([1.0, 0.7]), np.array([1e-3, 2e-3]), 5e-4
    sizes, decays = partials(f, phi, damping, contact)
    t = np.arange(4410) / 44100
    heard = struck(f, phi, damping, 0.1, contact)
    late = t > contact
    # Phases are of the blow: what is fitted are sizes alone.
    parts = np.concatenate(
        [np.exp(-decays * t[late, None]) * turn(2.0 * np.pi * f * t[late, None]) for turn in (np.sin, np.cos)], axis=1
    )
    fitted = np.linalg.lstsq(parts, heard[late], rcond=None)[0].reshape(2, 2)
    found = np.hypot(*fitted)
    assert np.allclose(found / found.max(), sizes, rtol=1e-9) and sizes[1] < 1100.0 * 0.49 / 400.0


def test_a_plate_is_struck_where_one_asks(bar):
    application, x = application_of(bar.scene), 0.2 * FREE
    still, end = (application.struck(bar, (place, 0.015)) for place in (x, 0.19))
    _, deflections = struck_place(bar.replay.analysis, (0.19, 0.015))
    assert still.frequencies == end.frequencies and len(deflections) == len(end.amplitudes)
    with pytest.raises(UserError, match="off the plate"):
        application.struck(bar, (1.0, 1.0))


def test_marks_change_no_row_of_modes():
    scene = restshape.load(SCENES / "bar_200.toml", "mesh.size='15 mm'")
    events = [
        {"do": "press", "on": "right"},
        {"do": "drag", "path": [[0.201, 0.015], [0.202, 0.015]]},
        {"do": "release"},
        {"do": "idle", "frames": 1},
    ]
    marked, plain = rows_with_and_without(scene, events)
    assert len(plain) == 5 and marked == plain
