"""Blows by hard and soft mallets, damping by material, and the tone of a whole drag."""

import json
import wave
from pathlib import Path

import numpy as np
import pytest
from restshape_apps.metallophone import application
from restshape_apps.metallophone.sounding.blow import struck
from restshape_apps.metallophone.sounding.damping import damping_of
from restshape_apps.metallophone.sounding.drag import Glide, ModesAt, blows, in_order, sine, voices
from restshape_apps.metallophone.sounding.mallet import excitation, pole
from restshape_apps.metallophone.sounding.place import struck_place
from restshape_apps.metallophone.sounding.wav import RATE, normalised
from scipy.integrate import trapezoid

from restshape.cli.main import main
from restshape.errors import UserError
from restshape.interface.first_frame import first_frame

SCENES, EDITS = (application.folder / name for name in ("scenes", "edits"))
PLATE = ["effects.modal.model=plate", "effects.modal.modes=2", 'mesh.size="10 mm"']


def frame(t, frequencies, deflections=(1.0,), ids=None, damping=1e-3):
    count = len(frequencies)
    ids = np.arange(1, count + 1) if ids is None else np.array(ids)
    return ModesAt(t, ids, np.array(frequencies), np.resize(deflections, count), np.full(count, damping))


@pytest.mark.parametrize("f", [100.0, 2000.0, 5000.0, 14000.0])
@pytest.mark.parametrize("until", [2e-4, 5e-4, 3e-3])
def test_a_blow_gives_a_mode_the_integral_of_its_force(f, until):
    contact, s = 5e-4, pole(f, 2e-3)
    u = np.linspace(0.0, min(until, contact), 200001)
    force = (1.0 - np.cos(2.0 * np.pi * u / contact)) / contact
    found = excitation(s, contact, np.array([until]))[0]
    assert found == pytest.approx(trapezoid(force * np.exp(-s * u), u), abs=1e-8)


def test_a_soft_mallet_leaves_high_modes_still():
    """The spectrum of a raised cosine of length T is |sinc(f T) / (1 - (f T)^2)|: its limit at f T = 1 is a half."""
    sizes = [abs(excitation(pole(f, 0.0), 1e-3, np.array([1.0]))[0]) for f in (1.0, 1000.0, 1500.0, 2500.0)]
    assert sizes == pytest.approx([1.0, 0.5, abs(np.sinc(1.5) / 1.25), abs(np.sinc(2.5) / 5.25)], abs=1e-5)
    assert abs(excitation(pole(1500.0, 0.0), 0.0, np.array([0.0, 1.0]))[1]) == 1.0


def test_the_phase_of_a_glide_is_the_integral_of_its_frequency():
    times, frequencies, damping = np.array([0.5, 0.7, 1.0]), np.array([400.0, 500.0, 500.0]), np.array([1e-3, 2e-3, 0])
    glide = Glide(times, frequencies, damping)
    t = np.linspace(0.5, 1.0, 100001)
    step, middle = np.diff(t), 0.5 * (t[1:] + t[:-1])
    phase = np.concatenate([[0.0], np.cumsum(2.0 * np.pi * glide.frequency(middle) * step)])
    np.testing.assert_allclose(glide(t).imag, phase, atol=1e-5)
    # In the middle of an interval the pitch has gone half of the way.
    assert glide.frequency(np.array([0.6]))[0] == pytest.approx(np.sqrt(400.0 * 500.0))
    assert glide(np.array([1.0]))[0].real == pytest.approx(-1e-3 * phase[40000] - 2e-3 * (phase[-1] - phase[40000]))


def crossings(samples, rate=RATE):
    """Times at which samples go up through 0, between samples by the line through both."""
    k = np.flatnonzero((samples[:-1] < 0.0) & (samples[1:] >= 0.0))
    return (k + samples[k] / (samples[k] - samples[k + 1])) / rate


def deviation(samples, times, frequencies):
    """The largest relative distance of the frequency between zero crossings from that of frames, linear in between."""
    at = crossings(samples)
    measured, middle = 8.0 / (at[8:] - at[:-8]), 0.5 * (at[8:] + at[:-8])
    return np.abs(measured / np.interp(middle, times, frequencies) - 1.0).max()


def test_blows_add_up_where_nothing_moves():
    """What two blows sound like is the sum of both, the second later."""
    f, phi, contact = np.array([500.0, 1400.0]), np.array([1.0, 0.6]), 1e-3
    frames = [frame(t, f, phi) for t in (2.0, 2.1, 2.75)]
    found = blows(frames, 0.25, contact)
    one = struck(f, phi, 1e-3, 0.75, contact)
    # `struck` is scaled: what it was scaled by goes with each blow alike.
    wanted, later = np.zeros(len(found)), round(0.25 * RATE)
    for k in range(3):
        wanted[k * later : len(one)] += one[: len(one) - k * later]
    np.testing.assert_allclose(found, normalised(wanted), atol=2e-3)


def test_a_mode_stays_itself_where_it_crosses_another():
    """Ids 7 and 8 cross; the mode that moves at the place struck goes down all the way, the other is not heard."""
    frames = [
        frame(0.0, [500.0, 600.0], [0.0, 1.0], [7, 8]),
        frame(0.5, [549.0, 551.0], [0.0, 1.0], [7, 8]),
        frame(0.6, [540.0, 560.0], [1.0, 0.0], [8, 7]),
        frame(1.0, [500.0, 600.0], [1.0, 0.0], [8, 7]),
    ]
    found = blows(frames, 2.0, 0.0)
    assert deviation(found, [0.0, 0.5, 0.6, 1.0], [600.0, 551.0, 540.0, 500.0]) < 2e-3


def test_what_leaves_dies_away_and_what_comes_waits_for_a_blow():
    frames = [frame(0.0, [500.0], ids=[1]), frame(0.2, [500.0], ids=[1]), frame(0.4, [800.0], ids=[2])]
    frames += [frame(1.0, [800.0], ids=[2])]
    found = blows(frames, 0.7, 0.0)
    loud = [np.abs(found[round(a * RATE) : round(b * RATE)]).max() for a, b in ((0.1, 0.2), (0.37, 0.4), (0.41, 0.7))]
    assert loud[0] > 0.3 and loud[1] < 0.2 * loud[0] and loud[2] == 0.0
    assert np.abs(found[round(0.71 * RATE) :]).max() > 0.3
    begins = [(voice.begin, voice.last, voice.end) for voice in voices(frames)]
    assert begins == [(0.0, 0.2, 0.4), (0.4, 1.0, 1.0)]


def test_a_mode_of_one_frame_is_heard_until_the_next():
    frames = [frame(0.0, [500.0], ids=[1]), frame(0.5, [700.0], ids=[2]), frame(1.0, [900.0], ids=[3])]
    found = blows(frames, 0.5, 0.0)
    assert np.isfinite(found).all() and np.abs(found[round(0.6 * RATE) : round(0.7 * RATE)]).max() > 0.1


def test_frames_are_in_order_from_end_to_end():
    kept = in_order([frame(1.0, [500.0]), frame(0.98, [490.0]), frame(1.0, [510.0])], 0.98, 1.04)
    assert [(one.t, one.frequencies[0]) for one in kept] == [(0.98, 490.0), (1.0, 510.0), (1.04, 510.0)]
    # While the hand rests tones stay until a sixtieth of a second before the next frame.
    rested = in_order([frame(0.0, [500.0]), frame(0.5, [600.0])], 0.0, 0.5)
    assert [one.t for one in rested] == pytest.approx([0.0, 0.5 - 1.0 / 60.0, 0.5])
    assert [one.frequencies[0] for one in rested] == [500.0, 500.0, 600.0]
    with pytest.raises(UserError, match="no duration"):
        in_order([frame(1.0, [500.0]), frame(1.0, [510.0])], 1.0, 1.0)
    with pytest.raises(UserError, match="no frame of the edits has modes"):
        in_order([], 0.0, 1.0)


def test_a_sine_glides_with_the_frames():
    times = np.array([0.0, 0.1, 0.3, 0.32, 0.5])
    pitches = np.array([400.0, 400.0, 440.0, 441.0, 430.0])
    found = sine([frame(t, [f]) for t, f in zip(times, pitches)])
    assert len(found) == RATE // 2 and found[0] == 0.0 and abs(found[-1]) < 0.01
    assert deviation(found, times, pitches) < 2e-3
    # A step of the phase by a tenth of a turn would be seen as a sample that does not follow from those before it.
    inside = found[round(0.01 * RATE) : -round(0.01 * RATE)]
    jerk = inside[2:] + inside[:-2] - 2.0 * np.cos(2.0 * np.pi * 440.0 / RATE) * inside[1:-1]
    assert np.abs(jerk).max() < 2e-3


def test_the_tone_of_a_drag_follows_its_frames(tmp_path):
    """The instantaneous frequency by zero crossings is that of the frames, within 0.2 %."""
    script, out = tmp_path / "drag.jsonl", tmp_path / "drag.wav"
    head = {"format": "restshape-edits", "version": 1, "scene": str(SCENES / "bar_200.toml")}
    lines = [
        head,
        {"t": 0.0, "do": "press", "on": "right", "at": [0.2, 0.015]},
        {"t": 0.1, "do": "drag", "path": [[0.2 - 0.001 * k, 0.015] for k in range(1, 16)]},
        {"t": 0.6, "do": "release"},
    ]
    script.write_text("\n".join(map(json.dumps, lines)))
    words = [*(word for one in PLATE for word in ("--set", one)), "--drag", "--sine", "--out", str(out)]
    words += ["--json", str(tmp_path / "drag.json")]
    assert main(["sound", str(SCENES / "bar_200.toml"), str(script), *words]) == 0
    found = json.loads((tmp_path / "drag.json").read_text())
    times, first = zip(*((one["t"], one["frequencies"][0]) for one in found["frames"]))
    assert first[-1] / first[0] == pytest.approx((0.2 / 0.185) ** 2, rel=0.01)
    with wave.open(str(out)) as file:
        samples = np.frombuffer(file.readframes(file.getnframes()), dtype="<i2").astype(float)
    assert len(samples) == round(0.6 * RATE) and found["seconds"] == pytest.approx(0.6)
    assert deviation(samples, np.array(times) - times[0], first) < 2e-3


def test_frames_that_are_not_analysed_glide_to_those_that_are(tmp_path):
    script, out, found = (tmp_path / name for name in ("demand.jsonl", "demand.wav", "demand.json"))
    head = {"format": "restshape-edits", "version": 1, "scene": str(SCENES / "bar_150.toml"), "analysis": "on demand"}
    lines = [head, {"t": 0.0, "do": "press", "on": "right", "at": [0.15, 0.015]}]
    lines += [{"t": 0.1, "do": "drag", "to": [0.14, 0.015], "frames": 4}, {"t": 0.2, "do": "analyse"}]
    # Beyond the left end, which is refused.
    lines += [{"t": 0.3, "do": "drag", "to": [-0.1, 0.015]}, {"t": 0.4, "do": "release"}]
    script.write_text("\n".join(map(json.dumps, lines)))
    words = [*(word for one in PLATE for word in ("--set", one)), "--drag", "--out", str(out), "--json", str(found)]
    assert main(["sound", str(SCENES / "bar_150.toml"), str(script), *words]) == 0
    times, first = zip(*((one["t"], one["frequencies"][0]) for one in json.loads(found.read_text())["frames"]))
    # The first frame is analysed in any case; the last is refused, so that the tone stays.
    step = 1.0 / 60.0
    assert times == pytest.approx((0.0, 0.2 - step, 0.2, 0.4 - step, 0.4))
    assert first[2] / first[0] == pytest.approx((150.0 / 140.0) ** 2, rel=5e-3)
    assert first[1] == first[0] and first[2:] == (first[2],) * 3


def two_parts(body: str, tip: str) -> list[str]:
    """Words that make a bar of aluminium with one loss factor, and another one in the last third of its length."""
    corners = '[["100 mm", "1 mm"], ["149 mm", "1 mm"], ["149 mm", "29 mm"], ["100 mm", "29 mm"]]'
    table = 'name = "aluminium", thickness = "4 mm", loss_factor = '
    materials = f'material={{body = {{{table}{body}}}, tip = {{{table}{tip}, region = "end"}}}}'
    return [f"shape.regions={{end = {{polygon = {corners}}}}}", materials]


def test_modes_of_two_materials_have_the_loss_of_where_they_bend():
    found = {}
    for left, right in (("0.02", "0"), ("0", "0.02"), ("0.02", "0.02")):
        analysis = first_frame(SCENES / "bar_150.toml", [*PLATE, *two_parts(left, right)]).analysis
        found[left, right] = damping_of(analysis).shares
    parts = found["0.02", "0"], found["0", "0.02"]
    np.testing.assert_allclose(sum(parts), 0.01, rtol=1e-9)
    np.testing.assert_allclose(found["0.02", "0.02"], 0.01, rtol=1e-9)
    # Of a free beam's first mode 0.130 of the strain energy lies there: cosh kx - cos kx - 0.9825 (sinh kx - sin kx).
    assert parts[1][0] / 0.01 == pytest.approx(0.130, rel=0.05)


def test_a_known_material_brings_its_loss_and_others_need_one():
    brass = first_frame(
        SCENES / "fish.toml", ['mesh.size="12 mm"', "effects.modal.model=plate", "mesh.order=1"]
    ).analysis
    found = damping_of(brass)
    np.testing.assert_allclose(found.shares, 5e-4)
    # 60 dB are a factor of 1000.
    decay = np.exp(-found.shares * 2.0 * np.pi * brass.frequencies * found.decay_times(brass.frequencies))
    np.testing.assert_allclose(decay, 1e-3)
    bar = first_frame(SCENES / "bar_150.toml", PLATE).analysis
    assert "material.aluminium has no loss_factor" in damping_of(bar).source
    np.testing.assert_allclose(damping_of(bar, 3e-3).shares, 3e-3)


@pytest.mark.parametrize("at", [None, (0.03, 0.004)])
def test_a_mallet_hardly_sounds_modes_in_the_plane(at):
    """A thick bar, whose second mode bends in its plane."""
    words = [
        "mesh.order=1",
        "mesh.layers=2",
        'mesh.size="8 mm"',
        "effects.modal.modes=2",
        "effects.modal.in_plane=true",
    ]
    words.append('material.aluminium.thickness="20 mm"')
    state = (analysis := first_frame(SCENES / "bar_150.toml", words).analysis).state
    (_, sizes), shares = struck_place(analysis, at), state.modes.participation[state.modes.chosen]
    assert sizes[shares < 1e-3].max() < 0.01 * sizes[shares > 0.9].max()
    plane = first_frame(SCENES / "bar_150.toml", ["effects.modal.model=plane_stress", "effects.modal.modes=1"]).analysis
    assert struck_place(plane, at)[1][0] > 0.1


@pytest.mark.parametrize(
    ("words", "reported"),
    [
        (["--damping", "1"], "share of critical damping"),
        (["--damping", "nan"], "share of critical damping"),
        (["--contact", "-1"], "touches for 0 to 0.1 s"),
        (["--seconds", "0"], "longer than 0"),
        (["--seconds", "inf"], "longer than 0"),
        (["--sine"], "add --drag"),
        (["--every", "0.2"], "add --drag"),
        (["--drag", "--every", "0"], "is positive"),
        (["--drag", "--seconds", "1"], "leave --seconds or --drag out"),
        (["--drag", "--frame", "1"], "leave --frame or --drag out"),
        (["--drag", "--sine", "--at", "0", "0"], "a sine does not have"),
        (["--drag"], "without edits"),
        (["--drag", "--every", "0.01", "--contact", "0.02"], "until the next blow"),
        (["--drag", "--at", "1", "1"], "at the edit time 0 s (1, 1) m lies off the plate"),
    ],
)
def test_what_makes_no_sense_is_refused(tmp_path: Path, capsys, words, reported):
    out = tmp_path / "bar.wav"
    settings = [word for one in PLATE for word in ("--set", one)]
    assert main(["sound", str(SCENES / "bar_150.toml"), *settings, "--out", str(out), *words]) == 2
    assert reported in capsys.readouterr().err and not out.exists()
