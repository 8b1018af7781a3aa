"""The page of a scene for a program, or inside a notebook."""

from __future__ import annotations

import html
import os
import signal
import subprocess
import sys
import tempfile
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Self

from restshape.errors import UserError
from restshape.live.server_process import PARENT

if TYPE_CHECKING:
    from restshape.scene.edit_script import Script
    from restshape.scene.model import Scene

COMMAND = "restshape.cli.main"
HEIGHT = 720
"""Pixels of the page in a notebook."""
LAST_WORDS = 30.0
"""Seconds that a session has to end in order."""
STEM = "live"


class LivePage:
    """A live session of a scene that runs beside the program, made by `restshape.live`; a notebook shows its page.

    The page must be on the machine where the program runs, or its port be forwarded. Close it, or use it in a ``with``
    statement; it ends with the program at latest.

    Args:
        scene: where it starts; it is written down for the session, so that the program may go on with its own.
        port: of the loopback; None: any that is free.
        height: [px] in a notebook.

    Attributes:
        address: of the page, for a browser.

    Raises:
        UserError: the page was not built, or the port cannot be had. Of a scene that cannot be simulated the page says
            so, and `closed` holds.
    """

    def __init__(self, scene: Scene, port: int | None = None, height: int = HEIGHT) -> None:
        from restshape.interface.scenes import save_scene

        self._scene, self._height = scene, height
        self._folder = tempfile.TemporaryDirectory(prefix="restshape-live-")
        folder = Path(self._folder.name)
        self._out = folder / f"{STEM}.jsonl"
        written = folder / scene.path.with_suffix(".toml").name
        save_scene(_with_whole_paths(scene), written)
        words = [str(written), "--out", str(self._out), "--allow-path", str(scene.folder)]
        words += ["--port", str(port)] if port else []
        command = [sys.executable, "-m", COMMAND, "live", *words]
        self._said = folder / "stderr.txt"
        with self._said.open("w") as said:
            self._process = subprocess.Popen(
                command,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=said,
                text=True,
                env=os.environ | {PARENT: str(os.getpid())},
                # Ctrl-C, and the interrupt of a notebook's cell, are for the program.
                start_new_session=True,
            )
        assert self._process.stdout
        self.address = self._process.stdout.readline().strip()
        if not self.address:
            self._fail()

    def _fail(self) -> None:
        self.close()
        said = self._said.read_text().strip()
        raise UserError(said.removeprefix("restshape live: ") or "the live session did not start")

    @property
    def script(self) -> Script:
        """What was done so far, as a script that `restshape.save_script` writes and `restshape.replay` replays."""
        from restshape.scene.edit_script import Script, load_script

        return load_script(self._out, self._scene) if self._out.exists() else Script.empty(self._scene)

    @property
    def closed(self) -> bool:
        """Whether the session has ended."""
        return self._process.poll() is not None

    def close(self) -> None:
        """Ends the session, in order; `script` can be read until the program ends."""
        if not self.closed:
            self._process.send_signal(signal.SIGINT)
            try:
                self._process.wait(LAST_WORDS)
            except subprocess.TimeoutExpired:
                self._process.kill()
                self._process.wait()
        if self._process.stdout:
            self._process.stdout.close()

    def __enter__(self) -> Self:
        """It."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Closes it."""
        self.close()

    def __repr__(self) -> str:
        """Where it is."""
        return f"<live page {'closed' if self.closed else self.address}>"

    def _repr_html_(self) -> str:
        """The page itself, for a notebook."""
        if self.closed:
            return "<p>This live session has ended.</p>"
        address = html.escape(self.address, quote=True)
        style = f"width: 100%; height: {self._height}px; border: 0"
        return f'<iframe src="{address}" title="restshape live" style="{style}" allow="autoplay"></iframe>'


def _with_whole_paths(scene: Scene) -> Scene:
    """A scene that names the same files from another folder."""
    from restshape.interface.scenes import changed
    from restshape.scene.plain_values import named_files

    for key, file in named_files(scene.raw):
        scene = changed(scene, ".".join(key), str((scene.folder / file).resolve()))
    return scene


def live(scene: Scene, port: int | None = None, height: int = HEIGHT) -> LivePage:
    """The page of a scene in which a hand holds the shape; arguments and errors as of `LivePage`."""
    return LivePage(scene, port, height)
