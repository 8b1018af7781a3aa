"""The application metallophone: columns of tones, recordings, pictures and sounds, and what a user can get wrong."""

import json
import re
import wave
from pathlib import Path

import numpy as np
import pytest
from restshape_apps.metallophone import application
from restshape_apps.metallophone.sounding.blow import struck
from restshape_apps.metallophone.sounding.place import on_plate
from restshape_apps.metallophone.sounding.wav import write_wav

from restshape.cli.main import main
from restshape.interface.first_frame import first_frame
from restshape.replay.recording.recording import Recording

SCENES, EDITS = (application.folder / name for name in ("scenes", "edits"))
QUICK = ["effects.modal.model=plate", "effects.modal.modes=3", 'mesh.size="8 mm"']


def settings(*overrides: str) -> list[str]:
    return [word for override in (*QUICK, *overrides) for word in ("--set", override)]


@pytest.mark.slow
def test_recording_holds_frequencies_tones_and_modes(command, tmp_path):
    scene, edits = SCENES / "bar_100.toml", EDITS / "bar_100.jsonl"
    done = command("replay", scene, "--edits", edits, *settings(), "--out", "bar.vtkhdf", "--json", "bar.json")
    assert done.returncode == 0, done.stderr
    recording = Recording(tmp_path / "bar.vtkhdf")
    table = recording.table
    assert np.all(np.diff(np.column_stack([table[f"f_{k}"] for k in (1, 2, 3)]), axis=1) > 0.0)
    first = recording.field(0, "mode_1")
    assert first.shape[1] == 3 and np.abs(first).max() == pytest.approx(1.0)
    reported = json.loads((tmp_path / "bar.json").read_text())["quantities"]["pitch"]
    assert reported[0] == pytest.approx(table["f_1"][0])
    # 2090 Hz lies 3 cents below C7 (2093.0 Hz).
    assert table["tone"][0] in (b"C7", "C7") and table["cents"][0] == pytest.approx(-2, abs=3)


@pytest.mark.slow
@pytest.mark.parametrize("a4", ['"442 Hz"', "442", '"1.3*tuned"'])
def test_notes_of_tables_are_tuned_as_the_scene_says(command, tmp_path, a4):
    text = (SCENES / "bar_100.toml").read_text().replace("[quantities]", '[parameters]\ntuned = "340 Hz"\n[quantities]')
    scene = tmp_path / "bar.toml"
    scene.write_text(text.replace("modes = 1", f"modes = 1\na4 = {a4}"))
    replayed = command("replay", scene, *settings(), "--out", "bar.vtkhdf", "--json", "bar.json")
    assert replayed.returncode == 0, replayed.stderr
    pitch = json.loads((tmp_path / "bar.json").read_text())["quantities"]["pitch"][0]
    # C7 is 27 half tones above A4.
    cents = round(1200.0 * np.log2(pitch / 442.0) - 2700.0)
    words = f"C7 {cents:+d} cents".replace("-", "\N{MINUS SIGN}")
    reported = command("report", "bar.vtkhdf", "--animation", "none")
    for table in (replayed.stdout, reported.stdout):
        assert words in table


@pytest.mark.slow
def test_notes_of_the_last_frame_are_tuned_as_a_script_has_set(command, tmp_path):
    script = tmp_path / "tuned.jsonl"
    head = {"format": "restshape-edits", "version": 1, "scene": str(SCENES / "bar_100.toml")}
    lines = [
        head,
        {"t": 0.0, "do": "idle", "frames": 1},
        {"t": 0.5, "do": "set", "key": "effects.modal.a4", "value": "466.16 Hz"},
    ]
    script.write_text("\n".join(map(json.dumps, lines)))
    scene = SCENES / "bar_100.toml"
    replayed = command(
        "replay", scene, "--edits", script, *settings(), "--out", "bar.vtkhdf", "--json", "bar.json", "--csv", "bar.csv"
    )
    assert replayed.returncode == 0, replayed.stderr
    pitch = json.loads((tmp_path / "bar.json").read_text())["quantities"]["pitch"]
    assert pitch[0] == pytest.approx(pitch[-1], rel=1e-6)
    # The same frequency is a half tone lower where A4 is a half tone higher.
    wanted = []
    for name, a4, keys in (("C7", 440.0, 27), ("B6", 466.16, 26)):
        cents = round(1200.0 * np.log2(pitch[0] / a4) - 100.0 * keys)
        wanted.append(f"{name} {cents:+d} cents".replace("-", "\N{MINUS SIGN}"))
    reported = command("report", "bar.vtkhdf", "--animation", "none")
    for table in (replayed.stdout, reported.stdout):
        assert all(words in table for words in wanted)


@pytest.mark.slow
def test_report_draws_a_recording_of_modes(command, tmp_path):
    scene, edits = SCENES / "bar_100.toml", EDITS / "bar_100.jsonl"
    command("replay", scene, "--edits", edits, *settings(), "--out", "bar.vtkhdf")
    done = command("report", "bar.vtkhdf", "--animation", "none")
    assert done.returncode == 0, done.stderr
    assert list(tmp_path.glob("bar-report/*.png"))


@pytest.mark.slow
def test_pictures_are_drawn(tmp_path):
    words = [str(SCENES / "fish.toml"), "--set", "effects.modal.modes=2", "--set", 'mesh.size="12 mm"']
    modes, rasp = tmp_path / "modes.png", tmp_path / "rasp.png"
    assert main(["modes", *words, "--out", str(modes), "--rasp", str(rasp)]) == 0
    assert modes.stat().st_size > 10_000 and rasp.stat().st_size > 10_000


def test_rasping_is_not_drawn_for_one_of_a_pair(tmp_path, capsys):
    rasp = tmp_path / "rasp.png"
    words = [str(SCENES / "disc.toml"), "--set", "supports={}", "--set", "mesh.size=0.2"]
    assert main(["modes", *words, "--rasp", str(rasp)]) == 2
    assert "does not stand alone" in capsys.readouterr().err and not rasp.exists()


def test_sound_has_the_frequencies_of_the_modes(tmp_path):
    path = tmp_path / "bar.wav"
    words = [str(SCENES / "bar_200.toml"), *settings(), "--out", str(path), "--seconds", "1", "--at", "0.1", "0.015"]
    assert main(["sound", *words, "--json", str(tmp_path / "a.json")]) == 0
    found = json.loads((tmp_path / "a.json").read_text())
    # Bending deflects the middle of a free bar, the bar that twists does not move there.
    assert found["frequencies"][0] == pytest.approx(523.3, rel=0.02) and found["deflections"][0] > 0.0
    assert found["at"] == pytest.approx([0.1, 0.015], abs=0.01)
    words = [*words[: words.index("--out")], "--json", str(tmp_path / "b.json")]
    assert main(["modes", *words]) == 0
    found = json.loads((tmp_path / "b.json").read_text())
    # 523.25 Hz is C5.
    assert found["tones"][0] == "C5" and abs(found["cents"][0]) < 40
    assert len(found["frequencies"]) == len(found["cents"])
    samples, rate = heard(path)
    spectrum = np.abs(np.fft.rfft(samples))
    loudest = np.argmax(spectrum) * rate / len(samples)
    # 3D elasticity of the free bar: bending 523 Hz and, struck in the middle, 2828 Hz; twisting is not heard there.
    assert min(abs(loudest / f - 1) for f in (523.3, 2828.2)) < 0.02


@pytest.mark.slow
@pytest.mark.parametrize("model", ["plate", "solid"])
def test_what_is_struck_lies_on_the_plate(tmp_path, capsys, model):
    """A bar of 100 x 30 mm: places in it, on its corner, beside it, in millimetres, and no number."""
    scene, path = str(SCENES / "bar_100.toml"), tmp_path / "bar.wav"
    words = [*settings(f"effects.modal.model={model}"), "--out", str(path), "--seconds", "0.1"]
    for at in (("0.05", "0.015"), ("0.1", "0.03"), ("0", "0")):
        assert main(["sound", scene, *words, "--at", *at]) == 0
        x, y = map(float, re.search(r"struck at \(([^,]+), ([^)]+)\) m", capsys.readouterr().out).groups())
        assert np.hypot(x - float(at[0]), y - float(at[1])) < 0.008
    path.unlink()
    for at in (("0.11", "0.015"), ("0.05", "-0.002"), ("50", "15"), ("nan", "0")):
        assert main(["sound", scene, *words, "--at", *at]) == 2
        said = capsys.readouterr().err
        assert "lies off the plate" in said and "from 0 to 0.1 m along x" in said and not path.exists()


def test_the_rim_of_a_disc_can_be_struck_and_its_holes_cannot():
    t = np.linspace(0.0, 2.0 * np.pi, 13)
    rim = np.stack([np.cos(t), np.sin(t)], axis=1)
    # Twelve trapezoids between circles of radius 1 and 0.5, two triangles each.
    outer = np.stack([rim[:-1], rim[1:], 0.5 * rim[:-1]], axis=1)
    inner = np.stack([0.5 * rim[:-1], rim[1:], 0.5 * rim[1:]], axis=1)
    ring = np.concatenate([outer, inner])
    between = np.array([np.cos(np.pi / 12), np.sin(np.pi / 12)])
    assert all(on_plate(ring, r * between) for r in (1.0, 0.75, 0.5))
    assert not any(on_plate(ring, r * between) for r in (1.1, 0.3, 0.0))


def heard(path: Path) -> tuple[np.ndarray, int]:
    with wave.open(str(path)) as file:
        assert (file.getnchannels(), file.getsampwidth()) == (1, 2)
        return np.frombuffer(file.readframes(file.getnframes()), dtype="<i2").astype(float), file.getframerate()


def test_sum_of_modes_dies_away_as_its_damping_says(tmp_path):
    f, damping = 500.0, 2e-3
    tone = struck(np.array([f]), np.array([1.0]), damping, 1.0)
    period = round(44100 / f)
    early, late = (np.abs(tone[k : k + 4 * period]).max() for k in (4410, 22050))
    assert late / early == pytest.approx(np.exp(-damping * 2 * np.pi * f * 0.4), rel=0.01)
    path = tmp_path / "tone.wav"
    write_wav(path, tone)
    assert np.abs(heard(path)[0]).max() == pytest.approx(0.9 * 32767, abs=1)


def peak(samples: np.ndarray, rate: int, f: float) -> float:
    """The largest size of the spectrum within 3 % of a frequency."""
    windowed = samples * np.hanning(len(samples))
    spectrum = np.abs(np.fft.rfft(windowed, 8 * len(samples)))
    at = np.fft.rfftfreq(8 * len(samples), 1.0 / rate)
    return float(spectrum[np.abs(at / f - 1.0) < 0.03].max())


def test_modes_sound_as_they_are_struck_and_heard():
    """A blow gives a mode phi; its speed at the same place is phi again, and its acceleration grows with f."""
    f, phi = (500.0, 1250.0), (0.8, -0.5)
    tone = struck(np.array(f), np.array(phi), 0.0, 1.0)
    heard_ratio = peak(tone, 44100, f[1]) / peak(tone, 44100, f[0])
    assert heard_ratio == pytest.approx((1250.0 * 0.25) / (500.0 * 0.64), rel=5e-3)


def test_corner_of_a_bar_twists_louder_than_it_bends(tmp_path):
    """Of unit mass m, ends move with 2 / sqrt(m) in bending, and corners with sqrt(6) / sqrt(m) in torsion."""
    path, scene = tmp_path / "corner.wav", str(SCENES / "bar_200.toml")
    words = ["--seconds", "1", "--damping", "0", "--contact", "0", "--at", "0", "0"]
    assert main(["sound", scene, *settings(), "--out", str(path), *words]) == 0
    analysis = first_frame(SCENES / "bar_200.toml", QUICK).analysis
    bends, twists = float(analysis.frequencies[0]), float(analysis.frequencies[2])
    samples, rate = heard(path)
    ratio = peak(samples, rate, twists) / peak(samples, rate, bends)
    assert ratio == pytest.approx(6.0 / 4.0 * twists / bends, rel=0.06)


def test_modes_beyond_the_rate_are_left_out():
    assert np.array_equal(struck(np.array([30000.0]), np.array([1.0]), 0.0, 0.01), np.zeros(441))


@pytest.mark.parametrize("command", ["modes", "sound"])
def test_bad_input_ends_with_2(command, tmp_path, capsys):
    out = ["--out", str(tmp_path / {"modes": "x.png", "sound": "x.wav"}[command])]
    assert main([command, str(tmp_path / "nothing.toml"), *out]) == 2
    plate = SCENES.parents[1] / "solid" / "scenes" / "plate.toml"
    assert main([command, str(plate), *out]) == 2
    assert "metallophone" in capsys.readouterr().err


def test_new_scene_and_check(tmp_path, capsys):
    assert main(["new", "metallophone", str(tmp_path / "bar")]) == 0
    assert main(["check", str(tmp_path / "bar" / "scene.toml"), str(tmp_path / "bar" / "edits.jsonl")]) == 0


def test_check_names_a_grain_where_there_is_one(capsys):
    assert main(["check", str(SCENES / "rosewood.toml")]) == main(["check", str(SCENES / "square.toml")]) == 0
    lines = [line for line in capsys.readouterr().out.splitlines() if line.startswith("material ")]
    assert ["grain 0 rad" in line for line in lines] == [True, False]


@pytest.mark.parametrize(
    "scene, override, reported",
    [
        ("solid/scenes/plate.toml", "mesh.layers=2", "layers"),
        ("solid/scenes/plate.toml", 'supports.wall.fix=["z"]', "no direction 'z'"),
        ("solid/scenes/plate.toml", "material.steel.thickness='0.01 + 0*x'", "one thickness"),
    ],
)
def test_plane_applications_refuse_what_has_a_thickness(capsys, scene, override, reported):
    folder = SCENES.parents[1]
    assert main(["check", str(folder / scene), "--set", override]) == 2
    assert reported in capsys.readouterr().err
