"""The files of the page, as they lie in the package, and what a browser may do with them."""

from __future__ import annotations

from pathlib import Path

from restshape.errors import UserError

FOLDER = Path(__file__).parent / "page" / "dist"
FIRST = "index.html"
TYPES = {
    ".html": "text/html",
    ".css": "text/css",
    ".js": "text/javascript",
    ".svg": "image/svg+xml",
    ".png": "image/png",
    ".woff2": "font/woff2",
    ".json": "application/json",
}


def page_files(folder: Path = FOLDER) -> dict[str, Path]:
    """The files of the page by name: no other file is ever served.

    Raises:
        UserError: the page was not built.
    """
    found = {path.name: path for path in folder.iterdir() if path.suffix in TYPES} if folder.is_dir() else {}
    if FIRST not in found:
        what = "the page was not built when restshape was installed"
        do = "scripts/page.sh in the folder of restshape's sources; it needs Node.js 18 or newer with npm"
        raise UserError(what, str(folder), do)
    return found


def headers(port: int) -> dict[str, str]:
    """What goes with each file: the page may load nothing but its own, and be framed by local pages alone."""
    local = [f"{scheme}://{name}" for scheme in ("http", "https") for name in ("127.0.0.1:*", "localhost:*")]
    sockets = f"ws://127.0.0.1:{port} ws://localhost:{port}"
    policy = {
        "default-src": "'self'",
        "connect-src": f"'self' {sockets}",
        "img-src": "'self' data: blob:",
        "style-src": "'self' 'unsafe-inline'",
        "base-uri": "'none'",
        "form-action": "'none'",
        "frame-ancestors": " ".join(local),
    }
    return {
        "Content-Security-Policy": "; ".join(f"{name} {value}" for name, value in policy.items()),
        "Cache-Control": "no-store",
        "Referrer-Policy": "no-referrer",
        "X-Content-Type-Options": "nosniff",
    }
