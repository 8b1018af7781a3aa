"""What a page that opens now has to know, besides the frames: kept from what the simulating process has said."""

from __future__ import annotations

from typing import Any

from restshape.live.server_frames import KeptFrames

Table = dict[str, Any]


class ShownState:
    """The state of the session as pages show it.

    Attributes:
        frames: so far; welcome: what was said at the start, with what has changed since; None: nothing yet.
        predict: how frames of drags are predicted; None: as at the start.
    """

    def __init__(self) -> None:
        self.frames = KeptFrames()
        self.welcome: Table | None = None
        self.predict: str | None = None
        self._player: Table | None = None
        self._asked: dict[int, Table] = {}

    @property
    def runs(self) -> bool:
        """Whether time goes on by itself."""
        return self.frames.says("runs")

    def hear(self, message: Table) -> None:
        """Keeps what stays true of a message."""
        kind = message["type"]
        if kind == "welcome":
            self.welcome = message
        elif kind == "player":
            self._player = message
        elif kind == "known" and self.welcome:
            self.welcome |= {key: value for key, value in message.items() if key != "type"}
        elif kind == "refused":
            self._asked.pop(message["id"], None)

    def asks(self, message: Table) -> None:
        """The page that has the hand chooses what is shown; the next frame tells whether it is."""
        if message["type"] == "show":
            self._asked[message["id"]] = {
                key: message[key] for key in ("field", "predict") if isinstance(message.get(key), str)
            }

    def answered(self, number: int) -> None:
        """A frame answers the message of a number, and all before it: what they have chosen is shown."""
        for one in [one for one in self._asked if one <= number]:
            chosen = self._asked.pop(one)
            if self.welcome:
                self.welcome |= chosen
            self.predict = chosen.get("predict", self.predict)

    def resuming(self, lines: str) -> Table:
        """What another process is told of the one before, whose script had these lines."""
        field = self.welcome and self.welcome.get("field")
        return {"type": "resume", "lines": lines, "predict": self.predict, "field": field or None}

    def forget(self) -> None:
        """The process is another one: what it was asked to show is not."""
        self._asked.clear()

    def greeting(self, role: str, script: str) -> list[Table]:
        """What a page of this role is said when it opens; `script`: its lines so far."""
        # Where a script is played, the welcome has it.
        said = self.welcome and self.welcome | {"role": role, "script": script or self.welcome.get("script", "")}
        welcome = [said] if said else []
        return welcome + ([self._player] if welcome and self._player else [])
