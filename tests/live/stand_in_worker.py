"""A simulating process for tests of the server: it answers at once, and fails, waits or ends as events ask for.

Its shape is a surface whose places are all the number of events done; a note is of the text of the event.
"""

import json
import struct
import sys
import time
from array import array

from restshape.live.link import Link, LinkClosed


def frame(number: int, answers: int, arrays: dict[str, list[float]]) -> list[bytes]:
    """The pieces of a frame with these arrays of a part."""
    places, content = {}, b""
    for name, values in arrays.items():
        places[name] = {"at": len(content), "type": "f4", "shape": [len(values)]}
        content += array("f", values).tobytes()
        content += bytes(-len(content) % 8)
    part = {"name": "shape", "kind": "surface", "role": "shape", "arrays": places}
    header = {"type": "frame", "number": number, "id": answers, "columns": {}, "parts": [part]}
    text = json.dumps(header).encode()
    text += b" " * (-(4 + len(text)) % 8)
    return [struct.pack("<I", len(text)), text, content]


class Shown:
    """What it has done."""

    def __init__(self, link: Link) -> None:
        self.link, self.done, self.size, self.field = link, 0, 8, "a"

    def greet(self) -> None:
        """Says what pages must know, and shows a frame with all arrays."""
        self.link.send({"type": "welcome", "app": "stand-in", "field": self.field, "numbers": []})
        self.show(0, rest=True)

    def show(self, answers: int, rest: bool = False) -> None:
        """Shows a frame."""
        arrays = {"displacement": [self.done] * self.size} | ({"points": [0.0, 1.0]} if rest else {})
        self.link.send_binary(frame(self.done, answers, arrays))

    def take(self, message: dict) -> None:
        """Does what a message asks for."""
        number, event = message["id"], message.get("event", {})
        do = event.get("do")
        if do == "crash":
            sys.exit(7)
        if do == "wait":
            time.sleep(event["seconds"])
        if do == "many":
            for _ in range(event["frames"]):
                self.show(number)
                time.sleep(0.02)
        if do == "refuse" or message.get("field") == "unknown":
            self.link.send({"type": "refused", "id": number, "message": "no", "place": "p", "todo": "t"})
            return
        if do == "rest":
            self.link.send({"type": "resting", "line": f"{json.dumps(event)}\n"})
            self.link.send({"type": "done", "id": number})
            return
        if do == "grow":
            self.size = event["size"]
        self.done += 1
        self.show(number)
        self.link.send({"type": "written", "id": number, "lines": f"{json.dumps(event)}\n", "count": self.done})
        self.link.send({"type": "done", "id": number})


def main(words: list[str]) -> int:
    """Answers until the link closes."""
    if "dead" in words:
        return 7
    shown = Shown(Link.of_descriptor(int(words[words.index("--link") + 1])))
    if "bad" in words:
        shown.link.send({"type": "lost", "message": "bad.toml: it is bad", "restarting": False})
        return 2
    if "--resume" in words:
        resumed = json.loads(shown.link.receive())
        shown.done, shown.field = len(resumed["lines"].splitlines()), resumed["field"]
    shown.greet()
    try:
        while True:
            shown.take(json.loads(shown.link.receive()))
    except LinkClosed:
        pass
    return 0


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
