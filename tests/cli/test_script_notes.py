"""What is odd about a script is reported before it is replayed under many settings."""

import ezdxf
from small_scenes import CLAMPED, HEAD, STEEL, across, drag, plate, write_scene, write_script
from vibrating import SHAKEN, dynamics, tower

from restshape.cli.main import main
from restshape.cli.script_notes import note_script
from restshape.cli.start_notes import UNMOVED, start_notes
from restshape.scene.edit_script import Script, load_script
from restshape.scene.load import load_scene


def test_refused_edits_are_counted_and_the_first_is_reported(tmp_path, capsys):
    scene = load_scene(write_scene(tmp_path, plate()))
    good = drag("window", (0.5, 0.5), across((0.5, 0.5), (0.6, 0.5), 4))
    path = write_script(tmp_path, [*good, *drag("eyes", (0.5, 0.5), [(0.6, 0.5), (0.7, 0.5)])])
    note_script(scene, load_script(path, scene), path)
    printed = capsys.readouterr().err
    # The press, two drags and the release.
    assert "4 frames of" in printed and "the first in line 5" in printed and "eyes" in printed


def test_a_good_script_needs_no_word(tmp_path, capsys):
    scene = load_scene(write_scene(tmp_path, plate()))
    path = write_script(tmp_path, drag("window", (0.5, 0.5), across((0.5, 0.5), (0.6, 0.5), 4)))
    note_script(scene, load_script(path, scene), path)
    assert capsys.readouterr().err == ""


def test_a_quantity_that_is_not_there_is_reported_before_any_run(tmp_path, capsys):
    scene = write_scene(tmp_path, plate())
    script = write_script(tmp_path, drag("window", (0.5, 0.5), across((0.5, 0.5), (0.6, 0.5), 4)))
    words = ["accuracy", str(scene), "--edits", str(script), "--of", "nothing", "--out", str(tmp_path / "out")]
    assert main(words) == 2
    assert scene.name in capsys.readouterr().err and not (tmp_path / "out").exists()


def test_a_replay_without_its_script_says_where_one_is(tmp_path, capsys):
    scene = write_scene(tmp_path, plate(0.3))
    script = tmp_path / "edits.jsonl"
    script.write_text(f'{{"format": "restshape-edits", "version": 1, "scene": "{scene.name}", "units": "m"}}\n')
    assert main(["replay", str(scene)]) == 0
    assert f"its edits: {script}" in capsys.readouterr().err
    other = tmp_path / "again.jsonl"
    other.write_text(script.read_text())
    assert main(["replay", str(scene)]) == 0
    assert f"its edits: {other}, {script}\n" in capsys.readouterr().err


def test_fields_without_a_recording_are_said_to_do_nothing(tmp_path, capsys):
    scene, out = str(write_scene(tmp_path, plate(0.4))), str(tmp_path / "a.vtkhdf")
    assert main(["replay", scene, "--fields", "stress"]) == 0
    assert "without --out FILE.vtkhdf it does nothing" in capsys.readouterr().err
    assert main(["replay", scene, "--fields", "stress", "--out", out]) == 0
    assert "it does nothing" not in capsys.readouterr().err


def test_a_replay_of_motion_without_a_script_says_where_time_begins(tmp_path):
    scene = load_scene(tower(tmp_path, SHAKEN, dynamics()))
    assert UNMOVED in start_notes(scene, Script.empty(scene))
    lasting = write_script(tmp_path, [{"do": "idle", "frames": 2}])
    assert UNMOVED not in start_notes(scene, load_script(lasting, scene))
    still = load_scene(write_scene(tmp_path, plate(0.3)))
    assert UNMOVED not in start_notes(still, Script.empty(still))


def test_a_replay_says_how_large_the_gaps_are_that_were_closed_in_a_drawing(tmp_path):
    drawing = ezdxf.new("R2010", units=4)
    corners = [(0, 0), (200, 0), (200, 100), (0, 100), (0, 0.3)]
    drawing.modelspace().add_lwpolyline(corners, dxfattribs={"layer": "rim"})
    drawing.saveas(tmp_path / "x.dxf")
    shape = '[shape]\nfile = "x.dxf"\ntolerance = "1 mm"\n'
    held = CLAMPED.replace('"left"', '"outline"')
    scene = load_scene(write_scene(tmp_path, f"{HEAD}{shape}{STEEL}{held}[mesh]\nsize = 0.05\n"))
    note = "shape.tolerance: 1 gap is closed in x.dxf, the largest of 300 µm; restshape check lists them"
    assert note in start_notes(scene, Script.empty(scene))
