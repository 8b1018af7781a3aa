"""The command `restshape live`, its bad inputs, and the page of a program."""

import argparse
import os
import signal
import subprocess
import sys
import threading
import time
import urllib.request
from pathlib import Path

import pytest

import restshape
from restshape.cli import live as live_command
from restshape.live import notebook, server_files, worker
from restshape.live.server_files import FIRST, headers, page_files

SCENE = Path(__file__).parents[1] / "scenes" / "beam.toml"


@pytest.fixture
def built(monkeypatch, tmp_path):
    """The page is there, whatever was built."""
    folder = tmp_path / "dist"
    folder.mkdir()
    (folder / FIRST).write_text("<title>page</title>")
    monkeypatch.setattr(server_files, "FOLDER", folder)
    monkeypatch.setattr(page_files, "__defaults__", (folder,))


@pytest.mark.usefixtures("built")
@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["absent.toml"], "absent.toml: there is no such file"),
        (["."], "this is a folder"),
        (["scene.toml", "--edits", "absent.jsonl"], "absent.jsonl: there is no such file"),
        (["scene.toml", "--out", "there.jsonl"], "add --force"),
        (["scene.toml", "--record", "there.vtkhdf"], "add --force"),
        (["scene.toml", "--out", "script.txt"], "ends in .jsonl"),
        (["scene.toml", "--port", "70000"], "70000 is no port"),
        (["scene.toml", "--port", "-1"], "-1 is no port"),
    ],
)
def test_bad_input_has_place_and_remedy_before_anything_starts(command, tmp_path, words, said):
    for name, text in (
        ("scene.toml", ""),
        ("there.jsonl", '{"format": "restshape-edits"}\n'),
        ("there.vtkhdf", ""),
    ):
        (tmp_path / name).write_text(text)
    done = command("live", *words)
    assert done.returncode == 2 and said in done.stderr, done.stderr
    assert not done.stdout and (tmp_path / "there.jsonl").read_text()


def test_a_page_that_was_not_built_says_how_to_build_it(command, tmp_path, monkeypatch):
    monkeypatch.setattr(page_files, "__defaults__", (tmp_path / "none",))
    (tmp_path / "scene.toml").write_text("")
    done = command("live", "scene.toml")
    assert done.returncode == 2 and "scripts/page.sh" in done.stderr


def test_only_files_of_a_page_are_served_and_they_may_load_nothing_else(tmp_path):
    for name in (FIRST, "main.js", ".state", "notes.txt"):
        (tmp_path / name).write_text("")
    (tmp_path / "folder").mkdir()
    assert set(page_files(tmp_path)) == {FIRST, "main.js"}
    said = headers(8000)["Content-Security-Policy"]
    assert "default-src 'self'" in said and "ws://127.0.0.1:8000" in said and "unsafe-eval" not in said
    (framed,) = (one for one in said.split("; ") if one.startswith("frame-ancestors "))
    assert {one.partition("://")[2] for one in framed.split()[1:]} == {"127.0.0.1:*", "localhost:*"}


STAND_IN = """
import os, signal, sys, time
print("http://127.0.0.1:1/token/", flush=True)
out = sys.argv[sys.argv.index("--out") + 1]
open(out, "w").write(open(os.environ["WRITTEN"]).read())
open(out + ".words", "w").write(" ".join(sys.argv))
signal.signal(signal.SIGINT, lambda *_: sys.exit(0))
time.sleep(30)
"""


@pytest.mark.cli
def test_a_program_has_a_page_its_script_and_a_frame_for_notebooks(monkeypatch, tmp_path):
    (tmp_path / "stand_in_live.py").write_text(STAND_IN)
    scene = restshape.load(SCENE)
    script = restshape.new_script(scene, [{"do": "idle", "frames": 3}])
    restshape.save_script(script, tmp_path / "written.jsonl")
    monkeypatch.setenv("WRITTEN", str(tmp_path / "written.jsonl"))
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(tmp_path), os.environ["PYTHONPATH"]]))
    monkeypatch.setattr(notebook, "COMMAND", "stand_in_live")
    with restshape.live(scene, port=1234) as page:
        assert page.address == "http://127.0.0.1:1/token/" and not page.closed
        assert os.getpgid(page._process.pid) != os.getpgrp()
        assert 'src="http://127.0.0.1:1/token/"' in page._repr_html_()
        words = Path(f"{page._out}.words")
        while not (words.exists() and words.read_text()):
            time.sleep(0.01)
        assert "--port 1234" in words.read_text()
    assert page.closed and "ended" in page._repr_html_() and "closed" in repr(page)
    assert page.script.text == script.text


@pytest.mark.cli
def test_a_page_that_does_not_start_says_why(monkeypatch, tmp_path):
    (tmp_path / "stand_in_live.py").write_text("import sys\nsys.exit('restshape live: the port is gone')\n")
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(tmp_path), os.environ["PYTHONPATH"]]))
    monkeypatch.setattr(notebook, "COMMAND", "stand_in_live")
    with pytest.raises(restshape.UserError, match=r"^the port is gone"):
        restshape.live(restshape.load(SCENE))


SERVED = """
import sys
from pathlib import Path
from live_client import StandIn
from restshape.live.server import Serving, serve
from restshape.live.server_files import page_files

page_files.__defaults__ = (Path(sys.argv[1]),)
sys.exit(serve(StandIn(sys.argv[2:]), Serving(script=Path("script.jsonl"))))
"""


def started(folder: Path, *words: str) -> subprocess.Popen[str]:
    """A server with a stand-in that simulates, in a process of its own."""
    (folder / FIRST).write_text("<title>page</title>")
    path = os.pathsep.join([str(Path(__file__).parent), os.environ["PYTHONPATH"]])
    command = [sys.executable, "-c", SERVED, str(folder), *words]
    pipe = subprocess.PIPE
    return subprocess.Popen(command, stdout=pipe, stderr=pipe, text=True, env=os.environ | {"PYTHONPATH": path})


@pytest.mark.cli
@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 0), (signal.SIGTERM, 128 + signal.SIGTERM)])
def test_signals_end_a_session_in_order(tmp_path, number, code):
    process = started(tmp_path)
    assert process.stdout
    address, how = process.stdout.readline().strip(), process.stdout.readline()
    assert address.startswith("http://127.0.0.1:") and "Ctrl-C ends" in how and "script.jsonl" in how
    with urllib.request.urlopen(address) as answer:
        assert b"page" in answer.read()
    process.send_signal(number)
    assert process.communicate(timeout=10)[1] == "" and process.returncode == code


@pytest.mark.cli
def test_bad_input_of_the_simulation_is_the_exit_code_of_the_command(tmp_path):
    process = started(tmp_path, "bad")
    assert "bad.toml: it is bad" in process.communicate(timeout=10)[1] and process.returncode == 2


@pytest.mark.cli
def test_the_server_loads_nothing_of_the_simulation():
    code = "import restshape.live.server, sys; print(*{'numpy', 'petsc4py', 'pydantic', 'scipy'} & sys.modules.keys())"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0 and not done.stdout.strip(), done.stdout + done.stderr


LISTENER = "import socket, sys; socket.socket(fileno=int(sys.argv[1])).recv(1)"


@pytest.mark.cli
def test_the_server_beside_ranks_ends_where_they_cannot_simulate(monkeypatch):
    begin, started = subprocess.Popen, []

    def stand_in(command, **how):
        number = command[command.index("--link") + 1]
        started.append(begin([sys.executable, "-c", LISTENER, number], pass_fds=how["pass_fds"]))
        return started[0]

    monkeypatch.setattr(live_command.subprocess, "Popen", stand_in)
    monkeypatch.setattr(live_command, "first_rank", lambda: True)
    monkeypatch.setattr(worker, "main", lambda words: 2)
    args = argparse.Namespace(port=None, out=None, open=False)
    caller = threading.Thread(target=live_command._on_ranks, args=(args, []), daemon=True)
    caller.start()
    caller.join(5.0)
    ended = started[0].poll()
    started[0].kill()
    assert ended == 0
