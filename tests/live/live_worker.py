"""A worker of live sessions in a process of its own, as the server starts it."""

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

from restshape.live.link import Link

TYPES = {"f4": "<f4", "u4": "<u4", "u1": "u1"}
SECONDS = 30.0
ANSWERS = ("frame", "refused", "done", "rates", "saved")


class LiveWorker:
    """The server's side of a worker: it sends what a page says, and keeps the picture as a page does."""

    def __init__(self, link: Link) -> None:
        self.link, self.number = link, 0
        self.arrays: dict[tuple[str, str], np.ndarray] = {}
        self.bytes: list[int] = []

    def send(self, type: str, **keys: object) -> int:
        """Sends a message; its number."""
        self.number += 1
        self.link.send({"type": type, "id": self.number, **keys})
        return self.number

    def event(self, do: str, latest: bool = False, **keys: object) -> int:
        """Sends an event."""
        return self.send("event", event={"do": do, **keys}, latest=latest)

    def next(self) -> dict[str, Any]:
        """The next answer; of a frame its header."""
        found = self.link.receive(SECONDS)
        assert found is not None, "no answer came"
        return json.loads(found) if isinstance(found, str) else self._frame(found)

    def until(
        self, number: int, types: Sequence[str] = ("frame", "refused", "done", "rates", "saved")
    ) -> dict[str, Any]:
        """The first answer of these types to the message of a number, or a later one."""
        while True:
            found = self.next()
            if found["type"] in types and found.get("id", 0) >= number:
                return found

    def _frame(self, content: bytes) -> dict[str, Any]:
        self.bytes.append(len(content))
        (length,) = unpack_from("<I", content)
        header = json.loads(content[4 : 4 + length])
        for part in header["parts"]:
            for key, place in part["arrays"].items():
                count = int(np.prod(place["shape"]))
                found = np.frombuffer(content, TYPES[place["type"]], count, 4 + length + place["at"])
                self.arrays[part["name"], key] = found.reshape(place["shape"])
        return header


@contextmanager
def live_worker(scene: Path | str, *words: str) -> Iterator[LiveWorker]:
    """A worker of a scene; it ends with the block."""
    ours, theirs = socket.socketpair()
    command = [sys.executable, "-m", "restshape.live.worker", "--link", str(theirs.fileno()), str(scene), *words]
    with subprocess.Popen(command, pass_fds=[theirs.fileno()]) as process:
        theirs.close()
        worker = LiveWorker(Link(ours))
        try:
            yield worker
        finally:
            worker.link.close()
            process.wait(SECONDS)
