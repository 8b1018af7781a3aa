"""Binary messages of frames: a header of JSON, and the arrays of the picture that have changed."""

from __future__ import annotations

import struct
from collections.abc import Mapping, Sequence

from restshape.live.frame_arrays import ALIGNED, MessageBody, PicturePart
from restshape.live.json_text import json_bytes
from restshape.live.mark_messages import placed
from restshape.live.shown_marks import Mark

LENGTH = struct.Struct("<I")


class FrameEncoder:
    """Makes messages of frames, without what the other side has already.

    Which it has is known by identity: parts, arrays and marks that were sent never change.
    """

    def __init__(self) -> None:
        self._parts: dict[str, PicturePart] = {}
        self._marks: Sequence[Mark] | None = None

    def forget(self) -> None:
        """The next message has all."""
        self._parts, self._marks = {}, None

    def __call__(
        self, header: Mapping[str, object], parts: Sequence[PicturePart], marks: Sequence[Mark] = (), answered: int = 0
    ) -> list[bytes]:
        """The pieces of the message of a frame.

        Args:
            header: but its parts and marks.
            parts: of the picture; those of the frame before that are not among them are gone.
            marks: at the hand; answered: number of the message that it answers.
        """
        body, known = MessageBody(), self._parts
        now: dict[str, PicturePart] = {}
        said: list[dict[str, object]] = []
        for part in parts:
            name = part.name
            before, now[name] = known.get(name), part
            if part is not before and (changed := _changed_part(part, before, body)):
                said.append(changed)
        if now.keys() != known.keys():
            said += [{"name": name, "gone": True, "arrays": {}} for name in known if name not in now]
        self._parts = now
        whole = {**header, "id": answered, "parts": said}
        if (new := self._changed(marks, body)) is not None:
            whole["marks"] = new
        text = json_bytes(whole)
        filled = -(LENGTH.size + len(text)) % ALIGNED
        return [LENGTH.pack(len(text) + filled), text, b" " * filled, body.packed()]

    def _changed(self, marks: Sequence[Mark], body: MessageBody) -> list[dict[str, object] | None] | None:
        """The marks, None in the places of those that stay there; None for all where all of them stay."""
        known = self._marks
        self._marks = [*marks]
        if known is None:
            # Where nothing is known of the other side, it may have marks although there are none.
            return [placed(mark, body) for mark in marks]
        found: list[dict[str, object] | None] = []
        changed, last = len(marks) != len(known), len(known)
        for number, mark in enumerate(marks):
            if number < last and mark is known[number]:
                found.append(None)
            else:
                changed = True
                found.append(placed(mark, body))
        return found if changed else None


def _changed_part(part: PicturePart, known: PicturePart | None, body: MessageBody) -> dict[str, object]:
    """What has changed of a part, whose arrays that are no more are empty; nothing where all is as before."""
    if known is None:
        arrays = {key: body.add(values) for key, values in part.arrays.items()}
    else:
        before, arrays = known.arrays, {}
        for key, values in part.arrays.items():
            if before.get(key) is not values:
                arrays[key] = body.add(values)
        if before.keys() != part.arrays.keys():
            arrays |= {key: body.add(before[key][:0]) for key in before if key not in part.arrays}
        if not arrays and known.said == part.said:
            return {}
    return {"name": part.name, "kind": part.kind, "role": part.role, **part.said, "arrays": arrays}
