"""A browser that all tests of a worker share, and sessions for it."""

import asyncio
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from browser import WORDS, BrowserPage, Session, context_of
from live_worker import BRACKET, COARSE

from restshape.live.server_files import FIRST, FOLDER

if TYPE_CHECKING:
    from playwright.sync_api import Browser, BrowserContext

NAMES = ("chromium", "chromium-browser", "google-chrome")


@pytest.fixture(scope="session")
def shared_browser() -> Iterator[tuple["Browser", asyncio.AbstractEventLoop]]:
    """A browser, and the loop of events of its driver."""
    api = pytest.importorskip("playwright.sync_api", reason="playwright is not here: pip install -e '.[test]'")
    path = next(filter(None, map(shutil.which, NAMES)), None)
    if path is None:
        pytest.skip("there is no Chromium: make setup installs that of the distribution")
    if not (FOLDER / FIRST).exists():
        pytest.skip("the live page is not built: scripts/page.sh")
    with api.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=path, args=WORDS)
        loop = asyncio.get_running_loop()
        # The driver's loop stands still between tests; others have their own.
        asyncio._set_running_loop(None)
        yield browser, loop
        asyncio._set_running_loop(loop)
        browser.close()


@pytest.fixture
def browser(shared_browser: tuple["Browser", asyncio.AbstractEventLoop]) -> Iterator["Browser"]:
    """The browser while a test runs."""
    browser, loop = shared_browser
    asyncio._set_running_loop(loop)
    yield browser
    for context in browser.contexts:
        context.close()
    asyncio._set_running_loop(None)


@pytest.fixture
def context(browser: "Browser") -> "BrowserContext":
    """A window."""
    return context_of(browser)


@pytest.fixture
def session(start_restshape: Callable, tmp_path: Path) -> Callable[..., Session]:
    """Starts a session of a scene: its script is session.jsonl."""
    return lambda scene, **more: Session(start_restshape, scene, tmp_path / "session.jsonl", **more)


@pytest.fixture
def bracket_session(session: Callable[..., Session]) -> Callable[..., Session]:
    """Starts a session of a bracket with a window."""
    return lambda *words: session(BRACKET, words=words, settings=COARSE)


@pytest.fixture
def opened(context: "BrowserContext") -> Callable[[Session], BrowserPage]:
    """Opens a page of a session."""
    return lambda session: BrowserPage(context, session.address)
