"""Several bars side by side."""

import json
import wave

import numpy as np
import pytest
from restshape_apps.metallophone.instrument.bars import bars_of
from restshape_apps.metallophone.instrument.scale_sound import LAST, struck_in_turn
from restshape_apps.metallophone.sounding.wav import RATE

from restshape.analysis.modal.pitch import NAMES, cents_between, frequency_of
from restshape.application import application
from restshape.cli.main import main

SCENES = application("metallophone").folder / "scenes"
NOTES = [f"{name}5" for name in NAMES if len(name) == 1]


def scene(note):
    return SCENES / f"{note.lower()}.toml"


def test_the_scale_is_in_tune():
    bars = bars_of([scene(note) for note in NOTES])
    for note, bar in zip(NOTES, bars, strict=True):
        assert bar.title == note
        # Half a cent as tuned; meshes of other machines differ by as much again.
        assert abs(cents_between(bar.frequencies[0], frequency_of(note))) < 1.0


def test_table_picture_and_sound(tmp_path, capsys):
    words = ["instrument", str(scene("E5")), str(scene("B5")), "--set", "mesh.size=8mm", "--every", "0.25"]
    files = [str(tmp_path / name) for name in ("scale.png", "scale.wav", "scale.json")]
    assert main([*words, "--out", files[0], "--wav", files[1], "--json", files[2]]) == 0
    assert "E5" in (text := capsys.readouterr().out) and "B5" in text
    assert [bar["tone"] for bar in json.loads((tmp_path / "scale.json").read_text())] == ["E5", "B5"]
    with wave.open(files[1]) as sound:
        assert sound.getnframes() == round((0.25 + LAST) * RATE)


def test_later_blows_sound_over_earlier_ones():
    bars = bars_of([scene("B5")], ["mesh.size=8mm"])
    once, twice = struck_in_turn(bars, 0.5), struck_in_turn([*bars, *bars], 0.5)
    apart = round(0.5 * RATE)
    both = np.zeros_like(twice)
    both[: len(once)] += once
    both[apart:] += once
    assert twice == pytest.approx(both / np.abs(both).max(), abs=1e-12)


def test_scenes_of_others_are_refused(capsys):
    other = application("solid").folder / "scenes" / "plate.toml"
    assert main(["instrument", str(scene("C5")), str(other)]) == 2
    assert "plate.toml: the scene is one of 'solid'" in capsys.readouterr().err


def test_time_between_blows_is_of_a_sound(capsys):
    assert main(["instrument", str(scene("C5")), "--every", "0.5"]) == 2
    assert "--every" in capsys.readouterr().err
