"""Opens the page in the user's browser, where there is one."""

from __future__ import annotations

import os
import subprocess
import sys
import threading
import webbrowser

DISPLAYS = ("DISPLAY", "WAYLAND_DISPLAY", "BROWSER")


def open_browser(address: str) -> None:
    """Opens an address beside what else is done, or says on stderr why it was not opened."""
    if sys.platform.startswith("linux") and not any(os.environ.get(name) for name in DISPLAYS):
        print("note: there is no display here: no browser was opened", file=sys.stderr)
        return
    try:
        browser = webbrowser.get()
    except webbrowser.Error:
        print("note: no browser was found: open the address yourself", file=sys.stderr)
        return
    threading.Thread(target=_open, args=(browser, address), daemon=True).start()


def _open(browser: webbrowser.BaseBrowser, address: str) -> None:
    try:
        opened = browser.open(address)
    except (OSError, subprocess.SubprocessError, webbrowser.Error):
        opened = False
    if not opened:
        print("note: the browser did not start: open the address yourself", file=sys.stderr)
