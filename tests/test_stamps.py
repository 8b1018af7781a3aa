"""Committed results are of this code, and stamps say so."""

import json
import sys
import wave
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from restshape.outputs.kinds import SoundFile, mark_sound
from restshape.outputs.picture_files import SOURCE, fingerprint

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "scripts"))
import results  # noqa: E402
import stamps  # noqa: E402
from result_list import ELSEWHERE, LIST, OUTPUTS, RESULTS  # noqa: E402
from stamps import Stamp, closure, code_hash, content_hash, parsed, plain, read_stamp, write_stamp  # noqa: E402

sys.path.remove(str(ROOT / "scripts"))

STAMP = Stamp("0123456789ab", "5c1f0a9e64f2b7d8", "9b2e4c01d3a7f655")


def of_this_code(result):
    # Times want an idle machine: what holds them is renewed less often.
    return pytest.param(result, id=result.name, marks=[pytest.mark.weekly] if result.timed else [])


@pytest.mark.results
@pytest.mark.parametrize("result", [of_this_code(result) for result in LIST])
def test_a_result_is_of_this_code(result):
    assert results.faults(result) == [], "make results, or see docs/results.md"


@pytest.mark.parametrize("result", LIST, ids=lambda result: result.name)
def test_a_result_is_as_it_was_made(result):
    # What is still to be made for the first time is not of this code either.
    assert not result.paths or results.faults(result, of_this_code=False) == []


PAIRS = [
    (picture, data)
    for result in LIST
    for data in result.paths
    for picture in result.paths
    if data.suffix == ".json" and picture.suffix == ".png"
]


@pytest.mark.parametrize(("picture", "data"), PAIRS, ids=lambda path: path.name)
def test_a_picture_is_of_the_data_that_were_written_with_it(picture, data):
    with Image.open(picture) as image:
        assert image.info.get(SOURCE) == fingerprint(json.loads(data.read_text(encoding="utf-8")))


def test_every_committed_file_belongs_to_one_result():
    owned = [path for result in LIST for path in result.paths]
    without_stamp = (*ELSEWHERE, "accuracy.json")
    there = [path for path in RESULTS.rglob("*.*") if path.suffix in OUTPUTS and path.name not in without_stamp]
    assert sorted(owned) == sorted(there)
    assert len({result.name for result in LIST}) == len(LIST)


def test_a_picture_of_other_results_depends_on_these():
    stages = next(result for result in LIST if result.name == "bench-stages")
    assert [path.name for path in stages.data] == ["bench-before.json", "bench-reuse.json", "bench-scenes.json"]
    assert all(path.parent == RESULTS for path in stages.data)


@pytest.mark.slow
def test_all_that_results_depend_on_is_there():
    for result in LIST:
        assert all(path.is_file() for path in result.data), result.name
        modules = closure(result.entries)
        assert set(result.code) <= set(modules) | {name for name in result.code if name.endswith("*")}, result.name
        assert any(name.startswith("restshape.") for name in modules), result.name


def test_the_index_of_accuracy_lists_every_page():
    index = (RESULTS / "accuracy" / "README.md").read_text(encoding="utf-8")
    pages = [path for path in (RESULTS / "accuracy").glob("*.*") if path.suffix in (".md", ".png")]
    assert len(pages) > 10
    assert [path.name for path in pages if path.name != "README.md" and f"({path.name})" not in index] == []


def files(folder):
    """A file of each format, with what it holds."""
    Image.fromarray(np.arange(48, dtype=np.uint8).reshape(4, 4, 3)).save(folder / "a.png")
    shades = [Image.fromarray(np.full((4, 4), shade, dtype=np.uint8)) for shade in (10, 200)]
    shades[0].save(folder / "a.gif", save_all=True, append_images=shades[1:], duration=50, loop=0)
    with wave.open(str(folder / "a.wav"), "wb") as sound:
        sound.setparams((1, 2, 8000, 0, "NONE", ""))
        sound.writeframes(b"\1\2\3\4")
    (folder / "a.md").write_text("# Title\n\ntext\n")
    (folder / "table.json").write_text('{"b": 1, "a": [2, 3]}')
    (folder / "rows.json").write_text('[{"a": 1}]')
    return sorted(folder.iterdir())


def test_stamps_are_read_as_they_were_written_and_change_nothing_else(tmp_path):
    accepted = Stamp("0123456789ab+", "5c1f0a9e64f2b7d8", "9b2e4c01d3a7f655", "one, two (three), " * 20 + "four")
    timed = Stamp("0123456789ab", "5c1f0a9e64f2b7d8", "9b2e4c01d3a7f655", "a, b", "on core 1 of 2 at load 0.3")
    assert Stamp.of(str(timed)) == timed
    for path in files(tmp_path):
        content = content_hash(path)
        assert read_stamp(path) is None
        for stamp in (STAMP, accepted, timed, STAMP):
            write_stamp(path, stamp)
            assert read_stamp(path) == stamp and content_hash(path) == content
    with Image.open(tmp_path / "a.png") as image:
        assert image.info["Stamp"] == str(STAMP)
        np.testing.assert_array_equal(np.asarray(image).ravel(), np.arange(48))
    with Image.open(tmp_path / "a.gif") as image:
        assert image.n_frames == 2
        image.seek(1)
        assert np.all(np.asarray(image.convert("L")) == 200)
    assert str(STAMP).encode() in (tmp_path / "a.gif").read_bytes()
    with wave.open(str(tmp_path / "a.wav")) as sound:
        assert sound.readframes(9) == b"\1\2\3\4"
    assert (tmp_path / "a.md").read_text() == f"# Title\n\ntext\n\n<!-- stamp: {STAMP} -->\n"
    assert json.loads((tmp_path / "table.json").read_text()) == {"stamp": str(STAMP), "b": 1, "a": [2, 3]}
    assert json.loads((tmp_path / "rows.json").read_text()) == {"stamp": str(STAMP), "rows": [{"a": 1}]}


def test_a_stamped_sound_stays_one_of_the_program(tmp_path):
    path = next(path for path in files(tmp_path) if path.suffix == ".wav")
    with path.open("r+b") as raw:
        mark_sound(raw)
    for _ in range(2):
        write_stamp(path, STAMP)
        assert SoundFile(path).ours() and read_stamp(path) == STAMP


def test_changed_contents_are_seen(tmp_path):
    path = tmp_path / "a.md"
    path.write_text("# Title\n")
    write_stamp(path, Stamp("a", "b", content_hash(path)))
    path.write_text(path.read_text().replace("Title", "Other"))
    assert read_stamp(path).content != content_hash(path)


@pytest.fixture
def module(tmp_path, monkeypatch):
    """Writes a module of a project of its own, and gives the hash of what imports it."""
    monkeypatch.setattr(stamps, "ROOT", tmp_path)
    (tmp_path / "studies").mkdir()
    (tmp_path / "studies" / "first.py").write_text(
        "def f():\n    from restshape_studies.second import g\n    return g()\n"
    )
    (tmp_path / "studies" / "third.py").write_text("X = 1\n")

    def write(text):
        parsed.cache_clear()
        (tmp_path / "studies" / "second.py").write_text(text)
        return code_hash(["restshape_studies.first"], [])

    yield write
    parsed.cache_clear()


def test_code_counts_and_words_about_it_do_not(module):
    known = module("def g():\n    return 1\n")
    assert module('"""What."""\n\n\ndef g():  # why\n    """How."""\n    return (1)\n') == known
    assert module("def g():\n    return 2\n") != known
    assert module('LATER = "restshape_studies.third:X"\n\n\ndef g():\n    return 1\n') != known


def test_what_is_named_to_be_imported_later_counts(module, tmp_path):
    text = 'LATER = "restshape_studies.third:X"\n'
    known = module(text)
    (tmp_path / "studies" / "third.py").write_text("X = 2\n")
    assert module(text) != known


def test_values_of_scenes_and_code_of_kernels_count(tmp_path):
    scene, kernel = tmp_path / "a.toml", tmp_path / "a.hpp"
    scene.write_text("# steel\na = 1  # m\n")
    kernel.write_text("// why\nint f() { /* how */ return 1; }\n")
    before = plain(scene), plain(kernel)
    scene.write_text("a = 1\n")
    kernel.write_text("int f() {\n    return 1;\n}\n")
    assert (plain(scene), plain(kernel)) == before
    scene.write_text("a = 2\n")
    assert plain(scene) != before[0]


@pytest.mark.cli
def test_a_picture_that_comes_out_the_same_keeps_its_bytes(tmp_path, monkeypatch):
    """One command draws the same, one something else, and one file belongs to another result."""
    from result_list import Result

    for module in (results, sys.modules["result_list"]):
        monkeypatch.setattr(module, "RESULTS", tmp_path)
    for name in ("same.md", "other.md", "foreign.md"):
        (tmp_path / name).write_text("old\n")
    script = tmp_path / "draw.py"
    script.write_text(
        "from pathlib import Path\nhere = Path(__file__).parent\n"
        "for name, text in (('same', 'old'), ('other', 'new'), ('foreign', 'new')):\n"
        "    (here / f'{name}.md').write_text(text + '\\n')\n"
    )
    made = Result(("same.md", "other.md"), (str(script),), ("restshape.errors",))
    assert results.make(made, set()) == "" and results.faults(made) == []
    assert (tmp_path / "foreign.md").read_text() == "old\n"
    assert (tmp_path / "other.md").read_text().startswith("new\n")
    script.write_text("raise SystemExit('no')\n")
    before = (tmp_path / "same.md").read_bytes()
    assert "ends with 1" in results.make(made, set()) and (tmp_path / "same.md").read_bytes() == before


def test_the_stamp_of_a_result_does_not_count_where_another_one_is_drawn_from_it(tmp_path):
    path = tmp_path / "a.json"
    path.write_text('{"a": 1}')
    write_stamp(path, STAMP)
    before = plain(path)
    write_stamp(path, Stamp("f" * 12, "5c1f0a9e64f2b7d8", "9b2e4c01d3a7f655"))
    assert plain(path) == before
    path.write_text(path.read_text().replace('"a": 1', '"a": 2'))
    assert plain(path) != before


@pytest.mark.cli
@pytest.mark.skipif(results.last_core() is None, reason="this system does not pin processes")
def test_results_with_times_are_made_on_one_core_and_their_stamps_say_so(tmp_path, monkeypatch):
    from result_list import Result

    for module in (results, sys.modules["result_list"]):
        monkeypatch.setattr(module, "RESULTS", tmp_path)
    script = tmp_path / "draw.py"
    script.write_text(
        "import os, sys\nfrom pathlib import Path\n"
        "Path(__file__).with_name('a.md').write_text(str(sorted(os.sched_getaffinity(0))) + '\\n')\n"
    )
    core, path = results.last_core(), tmp_path / "a.md"
    path.write_text("old\n")
    timed = Result(("a.md",), (str(script),), ("restshape.errors",), timed=True)
    assert results.make(timed, set(), core) == "" and path.read_text().startswith(f"[{core}]\n")
    assert read_stamp(path).timed.startswith(f"on core {core} of ")
    free = Result(("a.md",), (str(script),), ("restshape.errors",))
    assert results.make(free, set(), core) == "" and read_stamp(path).timed == ""
    # A recorder has a core of its own.
    replay = "restshape replay a.toml --out results/a.vtkhdf"
    assert results.pinned(replay, core) == results.words_of(replay)
