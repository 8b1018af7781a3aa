"""Binary messages of frames: a header of JSON, and the arrays of the picture that have changed."""

from __future__ import annotations

import struct
from collections.abc import Mapping, Sequence

from restshape.arrays import AnyArray
from restshape.live.frame_arrays import ALIGNED, MessageBody, PicturePart
from restshape.live.link import Buffer, encoded
from restshape.live.mark_messages import placed
from restshape.live.shown_marks import Mark

LENGTH = struct.Struct("<I")


class FrameEncoder:
    """Makes messages of frames, without the arrays that the other side has.

    Which it has is known by identity: arrays that are sent never change.
    """

    def __init__(self) -> None:
        self._sent: dict[str, dict[str, AnyArray]] = {}

    def forget(self) -> None:
        """The next message has all arrays."""
        self._sent = {}

    def __call__(
        self, header: Mapping[str, object], parts: Sequence[PicturePart], marks: Sequence[Mark] | None = None
    ) -> list[Buffer]:
        """The pieces of the message of a frame.

        Args:
            header: but its parts and marks.
            parts: of the picture; those of the frame before that are not among them are gone.
            marks: at the hand; None: as before.
        """
        body = MessageBody()
        said = [self._part(part, body) for part in parts]
        names = {part.name for part in parts}
        said += [{"name": name, "gone": True, "arrays": {}} for name in self._sent if name not in names]
        self._sent = {part.name: dict(part.arrays) for part in parts}
        whole = {**header, "parts": said}
        if marks is not None:
            whole["marks"] = [placed(mark, body) for mark in marks]
        text = encoded(whole).encode()
        text += b" " * (-(LENGTH.size + len(text)) % ALIGNED)
        return [LENGTH.pack(len(text)), text, *body.pieces]

    def _part(self, part: PicturePart, body: MessageBody) -> dict[str, object]:
        known = self._sent.get(part.name, {})
        arrays = {key: body.add(values) for key, values in part.arrays.items() if known.get(key) is not values}
        return {"name": part.name, "kind": part.kind, "role": part.role, **part.said, "arrays": arrays}
