"""Where the server is found: a port of the loopback, and a token that nobody guesses."""

from __future__ import annotations

import errno
import hmac
import secrets
import socket
from dataclasses import dataclass

from restshape.errors import UserError

HOST = "127.0.0.1"
NAMES = (HOST, "localhost")


@dataclass(frozen=True)
class Address:
    """Of one server.

    Args:
        port: that it listens on.
        token: first part of all its paths; once: that of one path which leads there a single time.
    """

    port: int
    token: str
    once: str

    @classmethod
    def of_port(cls, port: int) -> Address:
        """With new tokens."""
        return cls(port, secrets.token_urlsafe(18), secrets.token_urlsafe(18))

    @property
    def for_a_browser(self) -> str:
        """An address that opens one page: other users of the machine see the words that programs are started with."""
        return f"http://{HOST}:{self.port}/{self.once}/"

    def __str__(self) -> str:
        """As a browser takes it."""
        return f"http://{HOST}:{self.port}/{self.token}/"

    def has_token(self, token: str) -> bool:
        """Whether a path begins rightly."""
        return same(token, self.token)

    def has_host(self, host: str) -> bool:
        """Whether a request names this machine: another name may be of a page that has bent it to the loopback."""
        return host in {f"{name}:{self.port}" for name in NAMES}

    def has_origin(self, origin: str) -> bool:
        """Whether a page of this server opened a socket."""
        return origin in {f"http://{name}:{self.port}" for name in NAMES}


def same(given: str, secret: str) -> bool:
    """Whether two texts are the same; how long this takes does not depend on where they differ."""
    return hmac.compare_digest(given.encode(errors="replace"), secret.encode())


def listening(port: int | None) -> tuple[socket.socket, str]:
    """A socket that listens on the loopback, and what there is to note.

    Args:
        port: that is asked for; None: any.

    Raises:
        UserError: the port cannot be had, whoever has it.
    """
    note = ""
    found = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    try:
        found.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            found.bind((HOST, port or 0))
        except OSError as error:
            if error.errno != errno.EADDRINUSE or not port:
                what = f"it cannot be listened on: {(error.strerror or str(error)).lower()}"
                raise UserError(what, f"--port {port}", "leave --port out, or name one above 1023") from error
            found.bind((HOST, 0))
            note = f"port {port} is taken by another program: this is on port {found.getsockname()[1]}"
        found.listen(64)
    except BaseException:
        found.close()
        raise
    return found, note
