"""Nothing of the user's is overwritten: what a command writes is new, or restshape's own."""

import os
import signal
import subprocess
import sys
import threading
from argparse import ArgumentParser, _SubParsersAction
from collections.abc import Iterator
from pathlib import Path

import h5py
import numpy as np
import pytest
from matplotlib.figure import Figure
from small_scenes import plate, write_scene

from restshape.application import brought_commands
from restshape.cli.main import all_commands, command_parser, main
from restshape.errors import UserError
from restshape.outputs.atomic_files import write_whole
from restshape.outputs.kinds import JsonFile, OutputFile, PictureFile, RecordingFile, SoundFile, mark_sound
from restshape.outputs.locks import Lock, Locked
from restshape.outputs.picture_files import save_picture
from restshape.replay.recording.recorder import Recorder
from restshape.replay.recording.recording import Recording

ROOT = Path(__file__).parents[2]
FOREIGN = {
    "notes.txt": b"mine\n",
    "photo.png": b"\x89PNG\r\n\x1a\n mine",
    "package.json": b'{\n  "name": "mine"\n}\n',
    "table.csv": b"a,b\n1,2\n",
}
CORNERS = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])


def options(parser: ArgumentParser) -> Iterator[tuple[str, object]]:
    """All options of a parser and its commands: name and type."""
    for action in parser._actions:
        if isinstance(action, _SubParsersAction):
            for sub in action.choices.values():
                yield from options(sub)
        elif action.option_strings:
            yield action.option_strings[-1], action.type


def test_options_that_name_a_file_to_write_say_so_by_their_type():
    kinds: dict[str, set] = {}
    brought = {one.name: one.load() for many in brought_commands().values() for one in many}
    for command, module in (all_commands() | brought).items():
        for name, kind in options(command_parser(command, "", module)):
            kinds.setdefault(name, set()).add(kind)
    for name in ("--json", "--csv", "--picture", "--write"):
        assert all(issubclass(kind, OutputFile) for kind in kinds[name]), name
    # A folder where it is no file.
    assert {kind for kind in kinds["--out"] if not issubclass(kind, OutputFile)} == {Path}


@pytest.mark.parametrize(
    ("words", "ends"),
    [
        ("modes {} --out a.txt", ".png or .svg"),
        ("modes {} --period a.png", ".gif"),
        ("tune {} --to C6 --rasp --picture a", ".png or .svg"),
        ("instrument {} --wav a.mp3", ".wav"),
        ("sound {} --out a.mp3", ".wav"),
        ("sweep {} --set mesh.size=0.1,0.2 --out a.pdf", ".png or .svg"),
    ],
)
def test_a_name_that_hides_what_a_file_is_is_refused_before_any_work(tmp_path, monkeypatch, capsys, words, ends):
    """The scene is not there: it is not looked at before."""
    monkeypatch.chdir(tmp_path)
    assert main(words.format("none.toml").split()) == 2
    assert f"name ends in {ends}\n" in capsys.readouterr().err and not list(tmp_path.iterdir())


def test_the_library_opens_no_file_for_writing_past_the_module_of_outputs():
    writing = (".write_text(", ".write_bytes(", ".savefig(", ".print_png(", '"wb")', "np.savetxt(")
    own = {"atomic_files.py", "picture_files.py", "geo_process.py", "wav.py"}
    for path in (*(ROOT / "lib" / "restshape").rglob("*.py"), *(ROOT / "apps").rglob("*.py")):
        if "tests" not in path.parts and path.name not in own:
            assert not [word for word in writing if word in path.read_text(encoding="utf-8")], path


@pytest.mark.parametrize("option", ["--json", "--csv", "--out"])
def test_inputs_foreign_files_and_each_other_are_refused(command, tmp_path, option):
    scene = write_scene(tmp_path, plate(), "plate.toml")
    for name, data in FOREIGN.items():
        (tmp_path / name).write_bytes(data)
    with h5py.File(tmp_path / "other.vtkhdf", "w") as file:
        file["x"] = 1
    (tmp_path / "link.vtkhdf").symlink_to(scene)
    os.link(scene, tmp_path / "hard.vtkhdf")
    before = {path: path.read_bytes() for path in tmp_path.iterdir()}
    for name, why in [
        *((name, "is not a") for name in (*FOREIGN, "other.vtkhdf")),
        ("plate.toml", "the file that scene"),
        ("link.vtkhdf", "the file that scene"),
        ("hard.vtkhdf", "the file that scene"),
    ]:
        ended = command("replay", scene, option, name)
        assert ended.returncode == 2 and why in ended.stderr and f"{option} {name}" in ended.stderr, ended.stderr
        assert "try: name another file" in ended.stderr
    ended = command("replay", scene, "--csv", "a", "--json", "./a")
    assert ended.returncode == 2 and "the file that --json writes" in ended.stderr
    assert {path: path.read_bytes() for path in tmp_path.iterdir()} == before


@pytest.mark.slow
def test_files_of_its_own_are_replaced_and_a_script_only_if_nobody_changed_it(command, tmp_path):
    scene = write_scene(tmp_path, plate(), "plate.toml")
    for _ in range(2):
        words = ("--csv", "a.csv", "--json", "a.json", "--out", "a.vtkhdf")
        assert command("replay", scene, *words).returncode == 0
        done = command("script", scene, "idle 3", "--out", "made.jsonl")
        assert done.returncode == 0, done.stderr
        assert command("schema", "scene", "--out", "schema.json").returncode == 0
        assert command("list", "--json", "/dev/null").returncode == 0
        assert command("report", "a.vtkhdf").returncode == 0
    assert not list(tmp_path.glob("*.part*")) and not list(tmp_path.glob("*.lock"))
    made = tmp_path / "made.jsonl"
    made.write_text(made.read_text() + "\n")
    changed = made.read_bytes()
    ended = command("script", scene, "idle 3", "--out", "made.jsonl")
    assert ended.returncode == 2 and "nobody changed" in ended.stderr and made.read_bytes() == changed
    (tmp_path / "a-report" / "frames.png").write_bytes(FOREIGN["photo.png"])
    ended = command("report", "a.vtkhdf", "--animation", "none")
    assert ended.returncode == 2 and "is not a picture that restshape drew" in ended.stderr


@pytest.mark.parametrize("name", ["a.png", "a.svg"])
def test_a_picture_by_another_program_of_matplotlib_is_not_replaced(tmp_path, name):
    path, figure = tmp_path / name, Figure()
    save_picture(figure, path)
    assert PictureFile(path).ours()
    save_picture(figure, path)
    figure.savefig(path)
    before = path.read_bytes()
    assert b"Matplotlib" in before and not PictureFile(path).ours()
    with pytest.raises(UserError, match=name):
        save_picture(figure, path)
    assert path.read_bytes() == before


def test_a_failed_write_leaves_what_was_there(tmp_path):
    path = tmp_path / "a.json"
    write_whole(path, "{}\n")
    with pytest.raises(UnicodeEncodeError):
        write_whole(path, "\ud800")
    assert path.read_text() == "{}\n" and list(tmp_path.iterdir()) == [path]
    link = tmp_path / "b.json"
    link.symlink_to(path)
    write_whole(link, "[]\n")
    assert link.is_symlink() and path.read_text() == "[]\n"
    assert JsonFile(path).ours() and not JsonFile(Path(__file__)).ours()


def test_a_sound_is_marked_as_riff_says(tmp_path):
    path = SoundFile(tmp_path / "a.wav")
    path.write_bytes(b"RIFF\x05\0\0\0WAVE\0")
    assert not path.ours()
    with path.open("r+b") as file:
        mark_sound(file)
    assert path.ours() and int.from_bytes(path.read_bytes()[4:8], "little") == path.stat().st_size - 8


def begin(path: Path) -> Recorder:
    """A recorder with a frame that is safe."""
    recorder = Recorder.start(path, {}, {})
    recorder.topology(np.array([[0, 1, 2]], dtype=np.int32))
    recorder.frame(0.0, CORNERS, {}, {}, {})
    for _ in range(500):
        if path.exists():
            return recorder
        threading.Event().wait(0.01)
    raise AssertionError("the first frame is not safe after 5 s")


@pytest.mark.slow
def test_a_second_run_is_refused_at_its_start_and_a_lock_left_by_a_killed_one_is_free(tmp_path):
    path = tmp_path / "a.vtkhdf"
    recorder = begin(path)
    with pytest.raises(UserError, match="another run is writing this recording"):
        Recorder.start(path, {}, {})
    os.kill(recorder.process_id, signal.SIGKILL)
    with pytest.raises(UserError):
        recorder.close()
    assert (tmp_path / "a.vtkhdf.lock").exists()
    begin(path).close()
    with Recording(path) as recording:
        assert recording.status == "done"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.slow
def test_a_recording_removed_meanwhile_is_reported(tmp_path):
    path = tmp_path / "a.vtkhdf"
    recorder = begin(path)
    path.unlink()
    with pytest.raises(UserError, match="removed while it was being written: what was in it is no longer there"):
        recorder.close()
    recorder = begin(path)
    path.unlink()
    path.write_text("mine")
    with pytest.raises(UserError, match="the recording was replaced while it was being written"):
        recorder.close()
    assert path.read_text() == "mine"


@pytest.mark.slow
def test_parts_and_locks_follow_no_links(tmp_path):
    (tmp_path / "mine").write_text("mine")
    (tmp_path / "a.vtkhdf.part").symlink_to(tmp_path / "mine")
    (tmp_path / "a.vtkhdf.lock").symlink_to(tmp_path / "mine")
    with pytest.raises(UserError):
        Recorder.start(tmp_path / "a.vtkhdf", {}, {})
    (tmp_path / "a.vtkhdf.lock").unlink()
    begin(tmp_path / "a.vtkhdf").close()
    assert (tmp_path / "mine").read_text() == "mine" and RecordingFile(tmp_path / "a.vtkhdf").ours()
    (tmp_path / "a.vtkhdf.lock").write_text("mine")
    with pytest.raises(UserError, match="is no lock"):
        Recorder.start(tmp_path / "a.vtkhdf", {}, {})


@pytest.mark.cli
def test_a_lock_excludes_other_processes(tmp_path):
    lock = Lock(tmp_path / "a")
    with pytest.raises(Locked):
        Lock(tmp_path / "a")
    code = f"from pathlib import Path\nfrom restshape.outputs.locks import Lock\nLock(Path({str(tmp_path / 'a')!r}))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 1 and "another run is writing" in done.stderr
    lock.release()
    assert subprocess.run([sys.executable, "-c", code]).returncode == 0
    assert (tmp_path / "a.lock").exists()
