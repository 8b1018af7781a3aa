"""The process of a live session that simulates: it takes the page's messages, and answers with frames.

    python -m restshape.live.worker --link FD SCENE [--edits F] [--out SCRIPT] [--force] [--policy P]

Source: docs/live-protocol.md.
"""

from __future__ import annotations

import sys
from argparse import ArgumentParser, Namespace
from collections.abc import Callable, Sequence
from logging import getLogger
from pathlib import Path
from time import monotonic
from typing import cast

from restshape.application import application_of
from restshape.errors import UserError
from restshape.live import messages as page
from restshape.live.frame_header import header_of
from restshape.live.frame_message import FrameEncoder
from restshape.live.link import Link, LinkClosed
from restshape.live.live_simulation import LiveSimulation
from restshape.live.shown_marks import Mark
from restshape.live.welcome import events_said, fields_said, quantities_said, true_scale
from restshape.scene.load import load_scene

log = getLogger("restshape.live")
OFTEN = 0.2
"""Seconds between two words of progress."""


class Worker:
    """Answers the messages of a page, one after the other.

    Args:
        link: to the server; live: what is simulated.
        out: name of the script's file, for people.
    """

    def __init__(self, link: Link, live: LiveSimulation, out: str = "") -> None:
        self._link, self._live, self._out = link, live, out
        self._waiting: list[page.Message] = []
        self._encoder = FrameEncoder()
        self._answered = 0
        self._marks = True
        self._handlers: dict[type, Callable[..., None]] = {
            page.EventMessage: self._event,
            page.ShowMessage: self._show,
            page.RatesMessage: self._rates,
            page.SaveMessage: self._save,
        }

    def run(self) -> None:
        """Answers until the server ends the link."""
        self._welcome()
        self._send_frame()
        try:
            while True:
                self._step()
        except LinkClosed:
            log.info("The server has ended")

    def _step(self) -> None:
        """Takes what waits, and answers one message."""
        for content in self._link.waiting():
            self._take(content)
        if not self._waiting:
            content = self._link.receive()
            if content is not None:
                self._take(content)
            return
        message = self._waiting.pop(0)
        self._answer(message)

    def _take(self, content: str | bytes) -> None:
        """Lets a message wait; one that is none is answered at once."""
        try:
            page.merged(self._waiting, page.read(content))
        except page.MalformedMessage as error:
            self._refuse(error.id, UserError(str(error), "a message of the page", "load the page again"))

    def _answer(self, message: page.Message) -> None:
        """Does what a message asks for."""
        self._answered = message.id
        handler = self._handlers.get(type(message))
        try:
            if handler is None:
                raise UserError(f"there is nothing to {message.type} here")
            handler(message)
        except UserError as error:
            self._refuse(message.id, error)

    def _refuse(self, number: int, error: UserError) -> None:
        said = {"message": error.what, "place": error.where, "todo": error.do}
        self._link.send({"type": "refused", "id": number, **said})

    def _event(self, message: page.EventMessage) -> None:
        for _ in self._live.do(message.event):
            self._send_frame()

    def _show(self, message: page.ShowMessage) -> None:
        live = self._live
        if message.field is not None:
            if message.field not in live.picture.choice.looks:
                known = ", ".join(live.picture.choice.looks) or "none"
                raise UserError(f"there is no field {message.field!r}", do=f"use one of: {known}")
            live.picture.field = message.field
        if message.marks is not None:
            self._marks = message.marks
        if message.predict is not None and message.predict != live.predict:
            live.reopen(message.predict, self._progress("frames are computed again"))
        self._send_frame()

    def _rates(self, message: page.RatesMessage) -> None:
        found = self._live.sim.frame.derivative(message.of)
        units = {name: one.unit for name, one in self._live.scene.quantities.items()}
        rates = {name: rate.reshape(-1).tolist() for name, rate in found.items()}
        self._link.send({"type": "rates", "id": message.id, "of": message.of, "rates": rates, "units": units})

    def _save(self, message: page.SaveMessage) -> None:
        if not self._out:
            raise UserError("no file was named for the script", do="start restshape live with --out SCRIPT")
        count = self._live.sim.written.count
        self._link.send({"type": "saved", "id": message.id, "path": self._out, "events": count})

    def _progress(self, what: str) -> Callable[[int, int], None]:
        """What says from time to time how far a long piece of work is."""
        start = said = monotonic()

        def progress(done: int, of: int) -> None:
            nonlocal said
            if monotonic() - said > OFTEN:
                said = monotonic()
                self._link.send({"type": "busy", "seconds": said - start, "what": f"{what}: {done} of {of}"})

        return progress

    def _welcome(self) -> None:
        live, scene = self._live, self._live.scene
        self._link.send(
            {
                "type": "welcome",
                "scene": scene.path.name,
                "app": scene.app,
                "dim": 3 if live.picture.in_space else 2,
                "role": "hand",
                "trueScale": true_scale(scene),
                "fields": fields_said(live.picture),
                "field": live.picture.field,
                "numbers": [],
                "quantities": quantities_said(scene),
                "things": [one.said() for one in live.picture.things()],
                "events": events_said(scene),
                "script": "",
                "player": False,
                "frames": 0,
                "predicts": ["none", "linear", "gmls"],
                "out": self._out,
                "recordable": False,
            }
        )

    def _send_frame(self) -> None:
        """Sends the last frame."""
        live, frame = self._live, self._live.sim.frame
        header = header_of(frame.index, self._answered, frame.row, live.scene, live.hand)
        marks = cast("Sequence[Mark]", application_of(live.scene).marked(live.sim)) if self._marks else ()
        self._link.send_binary(self._encoder(header, live.picture.parts(), marks))


def arguments(words: Sequence[str]) -> Namespace:
    """What the command line says."""
    parser = ArgumentParser("restshape.live.worker")
    parser.add_argument("scene", type=Path)
    parser.add_argument("--link", type=int, required=True, help="descriptor of the socket to the server")
    parser.add_argument("--edits", type=Path)
    parser.add_argument("--out", type=Path)
    parser.add_argument("--force", action="store_true")
    parser.add_argument("--policy")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", dest="overrides")
    return parser.parse_args(words)


def main(words: Sequence[str]) -> int:
    """Simulates until the server ends the link; 2 where the scene cannot be simulated."""
    options = arguments(words)
    link = Link.of_descriptor(options.link)
    try:
        live = LiveSimulation(load_scene(options.scene, options.overrides), options.policy, options.out)
    except UserError as error:
        link.send({"type": "lost", "message": str(error), "restarting": False})
        link.close()
        return 2
    Worker(link, live, str(options.out or "")).run()
    live.close()
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
