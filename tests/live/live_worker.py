"""Live sessions without a server: in this process, driven step by step, or in a process of their own."""

from __future__ import annotations

import json
import socket
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from struct import unpack_from
from typing import Any

import numpy as np

import restshape
from restshape.live.answering import Worker
from restshape.live.growing_script import GrowingScript
from restshape.live.link import Link
from restshape.live.live_recording import LiveRecording
from restshape.live.live_simulation import USUAL, LiveSimulation
from restshape.live.played_events import played_events
from restshape.live.player_controls import PlayerControls
from restshape.live.script_player import ScriptPlayer

BRACKET = Path(__file__).parents[2] / "docs" / "examples" / "bracket.toml"
COARSE = ("mesh.size='30 mm'", "mesh.near.window='15 mm'", "mesh.order=1")
TYPES = {"f4": "<f4", "u2": "<u2", "u4": "<u4", "u1": "u1"}
SECONDS = 60.0


class Page:
    """What a page sees: it says messages, and keeps the picture.

    Attributes:
        heard: all answers; of frames their headers, with those marks that have stayed in their places.
        marks: at the hand now.
        arrays: of the picture, by part and name.
        bytes: of each frame.
    """

    def __init__(self) -> None:
        self.number = 0
        self.heard: list[dict[str, Any]] = []
        self.arrays: dict[tuple[str, str], np.ndarray] = {}
        self.bytes: list[int] = []
        self.marks: list[dict[str, Any]] = []

    def take(self, content: str | bytes) -> dict[str, Any]:
        """Takes an answer."""
        found = json.loads(content) if isinstance(content, str) else self._frame(content)
        self.heard.append(found)
        return found

    def of(self, kind: str) -> list[dict[str, Any]]:
        """The answers of a type."""
        return [one for one in self.heard if one["type"] == kind]

    def rows(self) -> list[dict[str, Any]]:
        """The columns of all frames, each as it was shown last."""
        return [frame["columns"] for frame in {one["number"]: one for one in self.of("frame")}.values()]

    def message(self, type: str, **keys: object) -> dict[str, object]:
        """The next message."""
        self.number += 1
        return {"type": type, "id": self.number, **keys}

    def _frame(self, content: bytes) -> dict[str, Any]:
        self.bytes.append(len(content))
        (length,) = unpack_from("<I", content)
        header: dict[str, Any] = json.loads(content[4 : 4 + length])
        for part in header["parts"]:
            if part.get("gone"):
                self.arrays = {key: value for key, value in self.arrays.items() if key[0] != part["name"]}
            for key, place in part["arrays"].items():
                count = int(np.prod(place["shape"]))
                found = np.frombuffer(content, TYPES[place["type"]], count, 4 + length + place["at"])
                self.arrays[part["name"], key] = found.reshape(place["shape"])
        if "marks" in header:
            self.marks = [self.marks[place] if one is None else one for place, one in enumerate(header["marks"])]
            header["marks"] = self.marks
        return header


class LocalSession(Page):
    """A session in this process: what is said is answered before `say` returns."""

    def __init__(
        self,
        scene: restshape.Scene,
        out: Path | None = None,
        script: restshape.Script | None = None,
        record: Path | None = None,
    ) -> None:
        super().__init__()
        here, there = socket.socketpair()
        for end in (here, there):
            end.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 1 << 23)
        self.link, self.live = Link(here), LiveSimulation(scene, USUAL)
        self.worker = Worker(Link(there), self.live, GrowingScript(out), LiveRecording(record))
        if script is not None:
            player = ScriptPlayer(self.live, played_events(script), self.worker.moment)
            self.worker.player = PlayerControls(player, self.worker, script.text)
        self.worker.start()
        self.drain()

    def drain(self) -> list[dict[str, Any]]:
        """Takes what was answered."""
        return [self.take(content) for content in self.link.waiting()]

    def say(self, type: str, **keys: object) -> list[dict[str, Any]]:
        """The answers to a message."""
        return self.say_all([self.message(type, **keys)])

    def say_all(self, messages: Sequence[dict[str, object] | str]) -> list[dict[str, Any]]:
        """The answers to messages that come at once; a text is sent as it is."""
        for one in messages:
            if isinstance(one, str):
                self.link._send(0, [one.encode()])
            else:
                self.link.send(one)
        found = []
        while self.worker.waits():
            self.worker.next()
            found += self.drain()
        return [one for one in found + self.drain() if one["type"] != "busy"]

    def event(self, do: str, **keys: object) -> list[dict[str, Any]]:
        """The answers to an event, but what the script has gained."""
        return [one for one in self.say("event", event={"do": do, **keys}) if one["type"] != "written"]

    def rest(self) -> int:
        """Lets what goes on by itself come to rest; the frames that it took."""
        before = len(self.of("frame"))
        while self.worker.player is None and not self.live.settled:
            self.worker.next()
            self.drain()
        self.worker.end_rest()
        self.drain()
        return len(self.of("frame")) - before

    def end(self) -> None:
        """Ends it, as the server does."""
        self.worker.end_rest()
        self.worker.recording.end(self.live)
        self.live.close()
        self.worker.file.close()
        self.drain()


def bracket() -> restshape.Scene:
    """A bracket with a window, on a coarse mesh."""
    return restshape.load(BRACKET, *COARSE)


def cut(row: dict[str, Any]) -> dict[str, Any]:
    """The columns of a row that a frame of the page has, but times."""
    return {
        name: value
        for name, value in row.items()
        if not name.startswith("ms") and value != "" and value == value and name not in ("t", "estimate_time")
    }


def replayed(scene: restshape.Scene, script: Path, predict: str = "none") -> list[dict[str, Any]]:
    """The rows of a replay of a script, cut likewise."""
    return [cut(frame.row) for frame in restshape.replay(scene, restshape.load_script(script, scene), predict=predict)]


class RemoteSession(Page):
    """The server's side of a process that simulates."""

    def __init__(self, link: Link) -> None:
        super().__init__()
        self.link = link

    def next(self) -> dict[str, Any]:
        """The next answer."""
        found = self.link.receive(SECONDS)
        assert found is not None, "no answer came"
        return self.take(found)

    def until(self, kind: str, number: int = 0) -> dict[str, Any]:
        """The next answer of a type, to the message of a number or a later one."""
        while True:
            found = self.next()
            if found["type"] == kind and found.get("id", number) >= number:
                return found

    def say(self, type: str, **keys: object) -> int:
        """Sends a message; its number."""
        self.link.send(self.message(type, **keys))
        return self.number


@contextmanager
def remote_session(scene: Path, *words: str) -> Iterator[tuple[RemoteSession, subprocess.Popen[bytes]]]:
    """A process that simulates a scene, as the server starts it; it ends with the block."""
    ours, theirs = socket.socketpair()
    command = [sys.executable, "-m", "restshape.live.worker", "--link", str(theirs.fileno()), str(scene), *words]
    with subprocess.Popen(command, pass_fds=[theirs.fileno()], stderr=subprocess.PIPE) as process:
        theirs.close()
        session = RemoteSession(Link(ours))
        try:
            yield session, process
        finally:
            session.link.close()
            process.wait(SECONDS)
