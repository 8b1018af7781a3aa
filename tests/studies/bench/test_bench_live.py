"""How a live session's drag is summed up, what `bench live` refuses, and whose the processor's time is."""

import json
import os
import socket
import subprocess
import sys
from argparse import ArgumentParser, Namespace
from math import isnan

import pytest
from restshape_studies.bench import live_drag
from restshape_studies.bench.live_drag import summed_up
from restshape_studies.bench.live_mouse import Mouse, framed
from restshape_studies.bench.live_processes import Spent, kind_of, spent
from restshape_studies.bench.live_sessions import SESSIONS
from restshape_studies.commands import bench_live

from restshape.errors import UserError


def arguments(*words: str) -> Namespace:
    parser = ArgumentParser()
    bench_live.declare(parser)
    return parser.parse_args(words, Namespace(scenes=[]))


def test_a_drag_is_summed_up_by_first_drawings():
    sent = [[number, [10.0 * number, 10.0 * number - 4]] for number in range(10)]
    drawn = [[number, 10.0 * number + 5 + number] for number in range(0, 10, 2)]
    noted = {"sent": sent, "drawn": [*drawn, [8, 500.0], [77, 505.0]], "bytes": [30, 10, 20], "turns": [0, 16, 32, 50]}
    found = summed_up(noted, Spent({"server": 0.7}, 1.0), 2.0)
    assert found["shown_ms"] == {"p50": 9.0, "p95": 13.0}
    assert found["input_ms"] == {"p50": 13.0, "p95": 17.0}
    assert (found["answers"], found["bytes"], found["elsewhere"]) == (5, 20, 0.5)
    assert (found["frames_per_second"], found["turns_per_second"]) == (12.0, 60.0)
    assert found["processor_ms"] == pytest.approx({"server": 100.0})
    nothing = summed_up({"sent": [], "drawn": [], "bytes": [], "turns": []}, Spent({}, 0.0), 1.0)
    assert isnan(nothing["shown_ms"]["p95"]) and isnan(nothing["frames_per_second"])


def test_frames_are_shown_as_a_share_of_those_of_an_empty_drag(capsys):
    noted = {"sent": [], "drawn": [[k, 20.0 * k] for k in range(9)], "bytes": [], "turns": []}
    found = summed_up(noted, Spent({}, 0.0), 1.0) | {"first_s": 1.0, "ceiling_per_second": 62.5, "held": "hole"}
    bench_live.show(Namespace(), "plate", found)
    heads, row = (line for line in capsys.readouterr().out.splitlines() if "frames/s" in line or "50.0" in line)
    assert heads.index("share") < row.index("0.800") + 5 < heads.index("answers")
    assert "62.5" in row


@pytest.mark.cli
def test_time_of_descendants_is_the_session_s():
    busy = "import time\nwhile time.process_time() < 0.15: pass\nprint(flush=True)\ninput()"
    before = spent({os.getpid(): "own"})
    with subprocess.Popen([sys.executable, "-c", busy], stdin=subprocess.PIPE, stdout=subprocess.PIPE) as process:
        assert process.stdin is not None and process.stdout is not None
        process.stdout.readline()
        found = spent({process.pid: "server"})
        whole = spent({os.getpid(): "own"}).since(before)
        process.communicate(b"\n")
    assert set(found.by) == {"server"} and found.by["server"] == pytest.approx(0.15, abs=0.1)
    assert whole.by["driver"] == pytest.approx(found.by["server"], abs=0.05)


def test_kinds_of_processes_by_their_words():
    assert kind_of("/usr/lib/chromium/chromium --type=gpu-process --x") == "GPU process"
    assert kind_of("/usr/lib/chromium/chromium --type=utility") == "browser"
    assert kind_of("python -m restshape.live.worker --link 4") == "simulating process"


def test_what_cannot_be_measured_is_refused(monkeypatch):
    with pytest.raises(UserError, match="measure nothing"):
        bench_live.check(arguments("--places", "3"))
    with pytest.raises(UserError, match="cases"):
        bench_live.check(arguments("--cases", "whale"))
    monkeypatch.setattr(live_drag.shutil, "which", lambda _: None)
    with pytest.raises(UserError, match="installed"):
        bench_live.check(arguments("--cases", "plate"))
    monkeypatch.setattr(os, "getloadavg", lambda: (99.0, 0.0, 0.0))
    with pytest.raises(UserError, match="busy"):
        bench_live.check(arguments("--cases", "beside", "--quiet"))


def test_sessions_have_scenes():
    assert all(session.scene.is_file() for session in SESSIONS.values())


@pytest.mark.parametrize("size", [3, 125, 126, 300])
def test_a_mouse_says_whole_masked_messages(size):
    text = bytes(range(size % 256)) + bytes(size - size % 256)
    said = framed(text)
    assert said[0] == 0x81 and said[1] & 0x80
    length, head = (said[1] & 0x7F, 2) if size <= 125 else (int.from_bytes(said[2:4], "big"), 4)
    key, content = said[head : head + 4], said[head + 4 :]
    assert length == size and bytes(one ^ key[k % 4] for k, one in enumerate(content)) == text


def test_a_mouse_has_all_that_it_says_before_it_moves():
    here, there = socket.socketpair()
    with here, there:
        Mouse(here).move_along([(1.0, 2.0), (3.0, 4.0)], 1000.0)
        whole = there.recv(4096)
    said = [json.loads(b"{" + one.partition(b"{")[2]) for one in whole.split(bytes([0x81]))[1:]]
    assert [(one["params"]["x"], one["params"]["y"]) for one in said] == [(1.0, 2.0), (3.0, 4.0)]
