"""Binary messages of frames: a header of JSON, and the arrays of the picture that have changed."""

from __future__ import annotations

import struct
from collections.abc import Mapping, Sequence

from restshape.live.frame_arrays import ALIGNED, MessageBody, PicturePart
from restshape.live.json_text import json_bytes
from restshape.live.link import Buffer
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
        self, header: Mapping[str, object], parts: Sequence[PicturePart], marks: Sequence[Mark] = ()
    ) -> list[Buffer]:
        """The pieces of the message of a frame.

        Args:
            header: but its parts and marks.
            parts: of the picture; those of the frame before that are not among them are gone.
            marks: at the hand.
        """
        body, names = MessageBody(), {part.name for part in parts}
        said = [self._part(part, body) for part in parts if part is not self._parts.get(part.name)]
        said = [one for one in said if one]
        said += [{"name": name, "gone": True, "arrays": {}} for name in self._parts if name not in names]
        self._parts = {part.name: part for part in parts}
        whole = {**header, "parts": said}
        if (changed := self._changed(marks, body)) is not None:
            whole["marks"] = changed
        text = json_bytes(whole)
        text += b" " * (-(LENGTH.size + len(text)) % ALIGNED)
        return [LENGTH.pack(len(text)), text, body.packed()]

    def _changed(self, marks: Sequence[Mark], body: MessageBody) -> list[dict[str, object] | None] | None:
        """The marks, None in the places of those that stay there; None for all where all of them stay."""
        known = self._marks
        self._marks = [*marks]
        if known is None:
            # Where nothing is known of the other side, it may have marks although there are none.
            return [placed(mark, body) for mark in marks]
        stay = [one is other for one, other in zip(marks, known)]
        if len(marks) == len(known) and all(stay):
            return None
        stay += [False] * (len(marks) - len(stay))
        return [None if stays else placed(mark, body) for mark, stays in zip(marks, stay)]

    def _part(self, part: PicturePart, body: MessageBody) -> dict[str, object]:
        """What has changed of a part, whose arrays that are no more are empty; nothing where all is as before."""
        known = self._parts.get(part.name)
        before = known.arrays if known else {}
        arrays = {key: body.add(values) for key, values in part.arrays.items() if before.get(key) is not values}
        if before.keys() - part.arrays.keys():
            arrays |= {key: body.add(before[key][:0]) for key in before if key not in part.arrays}
        if known and not arrays and known.said == part.said:
            return {}
        return {"name": part.name, "kind": part.kind, "role": part.role, **part.said, "arrays": arrays}
