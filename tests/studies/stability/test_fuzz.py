"""Random scenes and edits never break: a small share, the same in each run; what breaks is reported, kept, made
small."""

import json
import os
from pathlib import Path

import pytest
from forked import examples_forked
from restshape_studies.bench.job import ending
from restshape_studies.stability.batch import DAMAGED, KINDS, Batch
from restshape_studies.stability.example import Example
from restshape_studies.stability.fuzz import fuzz
from restshape_studies.verification import verifications

from restshape.cli.main import main

APPS = tuple(app for app, known in verifications().items() if known.random_scenes)


@pytest.fixture(scope="module")
def tried():
    """Of a batch that is drawn and of one that is damaged."""
    with pytest.MonkeyPatch.context() as changed, examples_forked():
        changed.setattr("restshape_studies.stability.fuzz.BATCH", dict.fromkeys(KINDS, 12))
        return fuzz(24, 4, APPS)


@pytest.mark.slow
def test_nothing_breaks(tried):
    assert not tried.found, [vars(found) for found in tried.found.values()]
    assert tried.examples >= 24 and tried.examples == tried.valid + tried.refused + tried.too_large
    assert tried.written < tried.examples / 2
    assert 0 < tried.damaged < tried.examples and tried.valid >= 4 and tried.frames > 15 and 3 < tried.largest <= 200


@pytest.mark.slow
def test_the_same_seed_gives_the_same_examples(forked_examples):
    """Drawn, and then damaged."""
    once, again, other = (fuzz(4, seed, APPS, kinds=[DAMAGED]) for seed in (1, 1, 1001))
    times = {"seconds": 0, "processor_seconds": 0, "parts": ()}
    assert vars(again) | times == vars(once) | times
    assert other.messages != once.messages


DYING = """
import os, time
from restshape_studies.stability import player

def play(folder, example):
    if "{when}" in example.scene:
        {then}
    return player.Played(frames=1)

player.play = play
from restshape_studies.stability.fuzz_process import main
main()
"""


@pytest.fixture
def break_process(tmp_path, monkeypatch, forked_examples):
    """Lets the process that plays do something where a scene holds a text."""

    def change(then, when='app = \\"plane\\"'):
        (tmp_path / "broken_process.py").write_text(DYING.format(when=when, then=then))
        monkeypatch.setenv("PYTHONPATH", str(tmp_path) + os.pathsep + os.environ.get("PYTHONPATH", ""))
        monkeypatch.setattr("restshape_studies.stability.fuzz.PROCESS", "broken_process")

    return change


@pytest.mark.cli
@pytest.mark.slow
@pytest.mark.parametrize(
    ("then", "kind", "words"),
    [
        ("raise ZeroDivisionError('by nothing')", "fault", "ZeroDivisionError: by nothing"),
        ("os.kill(os.getpid(), 11)", "crash", "crash at broken_process.py:7"),
        ("time.sleep(60)", "hang", "reported nothing for 1.5 s"),
    ],
)
def test_what_breaks_is_reported_and_kept(tmp_path, break_process, then, kind, words):
    break_process(then)
    # A machine that is busy may be slow; what hangs is to be found soon.
    tried = fuzz(2, 3, ("plane",), keep=tmp_path / "kept", each=1.5 if kind == "hang" else 20.0)
    found = next(iter(tried.found.values()))
    assert (
        found.kind == kind
        and words in found.what
        and 'app = "plane"' in (Path(found.folder) / "scene.toml").read_text()
    )
    example = Example(**json.loads((Path(found.folder) / "example.json").read_text()))
    assert found.command == example.command and (Path(found.folder) / "edits.jsonl").read_text() == example.edits
    if kind == "fault":
        # As small as may be: no more than what every scene has.
        assert len(example.edits.splitlines()) <= 4 and len(tried.found) == 1


@pytest.mark.cli
@pytest.mark.slow
def test_what_was_held_up_once_is_played_again_and_is_no_hang(tmp_path, break_process):
    mark = tmp_path / "held_up"
    break_process(
        f"import pathlib; there = pathlib.Path({str(mark)!r}); there.exists() or (there.touch(), time.sleep(99))"
    )
    tried = fuzz(1, 3, ("plane",), each=1.5)
    assert mark.exists() and tried.repeated == 1 and not tried.found
    assert tried.examples == tried.valid == 1 and tried.mutated == {"drawn": {"0": 1}}


@pytest.mark.slow
def test_command(tmp_path, capsys):
    assert main(["stability", "--fuzz", "5", "--seed", "1", "--json", str(tmp_path / "a.json")]) == 0
    printed = json.loads((tmp_path / "a.json").read_text())
    assert printed["examples"] >= 5 and printed["faults"] == [] and printed["seed"] == 1 and "messages" in printed
    assert "fuzz of seed 1" in capsys.readouterr().out
    assert main(["stability", "--fuzz", "5", "--policy", "auto"]) == 2


def test_hard_cases_have_no_kind(capsys):
    assert main(["stability", "--kind", "recordings"]) == 2
    assert "add --fuzz N" in capsys.readouterr().err


def test_a_batch_survives_its_journey():
    assert json.loads(json.dumps(vars(Batch(1, 2, APPS, True))))["apps"] == list(APPS)


def test_a_crash_keeps_its_place_however_much_was_imported():
    stderr = 'Fatal Python error\n  File "broken.py", line 7 in play\nExtension modules: ' + "numpy.linalg, " * 500
    assert ending(-11, stderr) == 'ended with code -11:   File "broken.py", line 7 in play'
