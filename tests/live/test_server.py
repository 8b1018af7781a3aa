"""The server of live sessions, with a stand-in that simulates: pages, hands, frames, failures."""

import asyncio
import json
import random
import webbrowser
from types import SimpleNamespace

import aiohttp
import pytest
from live_client import Served, StandIn, run

from restshape.live import server_session
from restshape.live.server_address import listening
from restshape.live.server_browser import DISPLAYS, open_browser
from restshape.live.server_frames import KeptFrames
from restshape.live.server_pages import MOST_TEXTS, Page
from restshape.live.server_session import LiveSession

pytestmark = pytest.mark.cli


def test_a_page_is_greeted_and_gets_each_frame_and_answer(tmp_path):
    async def story(server: Served) -> None:
        page = await server.page()
        assert (await page.until("welcome"))["role"] == "hand"
        await page.until("frame", number=0)
        number = await page.do("drag")
        assert (await page.until("frame", number=1))["id"] == number
        await page.until("done", id=number)
        number = await page.do("refuse")
        assert (await page.until("refused", id=number))["todo"] == "t"

    run(tmp_path, story)


def test_a_page_that_comes_back_in_mid_drag_sees_the_same_state_and_keeps_the_hand(tmp_path):
    async def story(server: Served) -> None:
        page, looker = await server.page("a"), await server.page("b")
        await looker.until("welcome", role="looker")
        await page.do("press")
        await page.until("done", id=await page.do("drag"))
        await page.socket.close()
        again = await server.page("a")
        assert (await again.until("welcome"))["role"] == "hand"
        frame = await again.until("frame")
        assert frame["number"] == 2 and again.arrays == page.arrays
        assert set(again.arrays) == {("shape", "points"), ("shape", "displacement")}

    run(tmp_path, story)


def test_the_second_page_only_looks_until_the_first_is_gone_and_it_asks(tmp_path):
    async def story(server: Served) -> None:
        hand, looker = await server.page("a"), await server.page("b")
        await looker.until("frame")
        assert "another page" in (await looker.until("refused", id=await looker.do("drag")))["message"]
        await looker.until("refused", id=await looker.say(type="hand"))
        await hand.do("drag")
        await looker.until("frame", number=1)
        await hand.socket.close()
        await looker.until("note")
        await looker.say(type="hand")
        await looker.until("role", role="hand")
        await looker.until("done", id=await looker.do("drag"))
        assert looker.arrays["shape", "displacement"][:4] == b"\0\0\0@"

    run(tmp_path, story)


def test_a_second_socket_of_a_page_replaces_the_first(tmp_path):
    async def story(server: Served) -> None:
        first = await server.page("a")
        await first.until("frame")
        second = await server.page("a")
        await second.until("welcome", role="hand")
        with pytest.raises(ConnectionError, match="CLOSE 4001"):
            await first.until("never")
        await second.until("done", id=await second.do("drag"))

    run(tmp_path, story)


def test_what_was_refused_is_not_shown_to_pages_that_open_later_and_what_was_shown_stays(tmp_path):
    async def story(server: Served) -> None:
        page = await server.page("a")
        await page.until("frame")
        for field, seen in (("unknown", "a"), ("b", "b")):
            number = await page.say(type="show", field=field, predict=7)
            await page.until("done" if field == "b" else "refused", id=number)
            looker = await server.page(field)
            assert (await looker.until("welcome"))["field"] == seen
        await page.do("crash")
        await page.until("lost", restarting=True)
        assert (await page.until("welcome"))["field"] == "b"
        assert server.session.state.predict is None

    run(tmp_path, story)


def test_a_session_that_is_ended_before_its_process_is_heard_ends():
    async def led() -> int:
        session = LiveSession(StandIn([]))
        await session.end()
        return await asyncio.wait_for(session.lead(), 5.0)

    assert asyncio.run(led()) == 0


def test_frames_are_not_queued_for_a_page_that_is_busy_with_others(tmp_path):
    async def story(server: Served) -> None:
        page = await server.page()
        await page.until("frame")
        await page.say(type="shown")
        for _ in range(40):
            await page.until("done", id=await page.do("drag"))
        assert [frame["number"] for frame in page.frames] == [0, 1, 2]
        await page.say(type="shown")
        frame = await page.until("frame")
        assert frame["number"] == 40 and page.arrays["shape", "displacement"][:4] == b"\0\0 B"
        # Another message can say it, too.
        await page.say(type="event", event={"do": "drag"}, shown=2)
        await page.until("frame", number=41)

    run(tmp_path, story)


def test_what_a_script_gains_within_a_moment_is_reported_together(tmp_path):
    async def story(server: Served) -> None:
        page = await server.page()
        await page.until("frame")
        for _ in range(40):
            await page.until("done", id=await page.do("wait", seconds=0.0))
        while not (heard := [one for one in page.texts if one["type"] == "written"]) or heard[-1]["count"] < 40:
            await page.hear()
        assert sum(one["lines"].count("\n") for one in heard) == 40 and len(heard) < 20

    run(tmp_path, story)


def test_places_of_the_hand_that_wait_are_replaced_by_the_latest(tmp_path):
    async def story(server: Served) -> None:
        page = await server.page()
        await page.until("frame")
        await page.do("wait", seconds=0.3)
        # More than socket pair and stream hold, so that some wait in the server.
        places = [await page.do("drag", latest=True, on="a", filler="x" * 2_000) for _ in range(600)]
        last = await page.do("release")
        await page.until("done", id=last)
        answered = {message["id"] for message in page.texts if message["type"] == "done"}
        assert places[-1] in answered and len(answered) < 550

    run(tmp_path, story)


def test_a_process_that_dies_is_started_again_with_the_script_so_far(tmp_path):
    async def story(server: Served) -> None:
        page = await server.page()
        await page.until("done", id=await page.do("drag"))
        number = await page.do("crash")
        assert "exit code 7" in (await page.until("lost", restarting=True))["message"]
        await page.until("refused", id=number)
        frame = await page.until("frame")
        assert frame["number"] == 1
        await page.until("done", id=await page.do("drag"))
        assert page.arrays["shape", "displacement"][:4] == b"\0\0\0@"

    run(tmp_path, story)


def test_frames_of_a_process_that_dies_while_it_comes_to_rest_are_kept(tmp_path):
    async def story(server: Served) -> None:
        page = await server.page()
        for do in ("drag", "rest", "rest"):
            await page.until("done", id=await page.do(do))
        await page.do("crash")
        # Another line of the event takes the place of the one before it.
        await page.until("lost", restarting=True)
        assert (await page.until("frame"))["number"] == 2

    run(tmp_path, story)


def test_one_that_takes_long_is_said_to_be_busy_and_is_cancelled(tmp_path):
    async def story(server: Served) -> None:
        page = await server.page()
        await page.until("done", id=await page.do("drag"))
        number = await page.do("wait", seconds=60)
        busy = await page.until("busy", what="wait")
        assert busy["seconds"] >= 0.5
        await page.say(type="cancel")
        await page.until("lost", restarting=True)
        await page.until("refused", id=number)
        assert (await page.until("frame"))["number"] == 1
        await page.until("done", id=await page.do("drag"))

    run(tmp_path, story)


def test_an_event_of_many_quick_frames_is_said_to_be_busy_and_is_cancelled(tmp_path, monkeypatch):
    monkeypatch.setattr(server_session, "PATIENCE", 0.1)

    async def story(server: Served) -> None:
        page = await server.page()
        await page.until("done", id=await page.do("drag"))
        number = await page.do("many", frames=3000)
        busy = await page.until("busy", what="many", shows=True)
        assert busy["seconds"] >= 0.1 and sum(one["id"] == number for one in page.frames) > 1
        await page.say(type="cancel")
        await page.until("refused", id=number)
        assert (await page.until("frame", id=0))["number"] == 1

    run(tmp_path, story)


async def asked(server: Served, path: str, **said: str) -> tuple[int, str]:
    """Status and text of a request."""
    url = f"http://127.0.0.1:{server.address.port}{path}"
    async with server.http.get(url, headers=said, allow_redirects=False) as answer:
        return answer.status, await answer.text()


def test_only_those_who_know_the_token_find_anything_and_only_under_its_own_name(tmp_path):
    async def story(server: Served) -> None:
        token, port = server.address.token, server.address.port
        assert await asked(server, f"/{token}/") == (200, "<title>page</title>")
        for path in ("/", "/x/", f"/{token[:-1]}/", f"/{token}/nothing", f"/{token}/..%2f..%2fserver.py", "//"):
            assert (await asked(server, path))[0] == 404, path
        assert (await asked(server, f"/{token}/", Host=f"evil.example:{port}"))[0] == 421
        assert (await asked(server, f"/{token}/", Host=f"localhost:{port}"))[0] == 200
        assert (await asked(server, f"/{token}"))[0] == 302
        assert [(await asked(server, f"/{server.address.once}/"))[0] for _ in range(2)] == [302, 404]
        for origin in ("http://evil.example", f"http://127.0.0.1:{port + 1}", "null", ""):
            with pytest.raises(aiohttp.WSServerHandshakeError, match="403"):
                await server.page(origin=origin)
        async with server.http.post(str(server.address), data=b"x") as answer:
            assert answer.status == 405

    run(tmp_path, story)


def nonsense(random_state: random.Random) -> str:
    """A message that no page sends, or hardly any."""
    values = [None, True, -1, 1e308, "event", [], {}, "x" * 50, 2**70, ["a", {"b": []}]]
    keys = ["type", "id", "event", "do", "latest", "on", "of", "frame"]
    types = ["event", "show", "nothing", "play", "shown", "hand", "cancel"]
    made = {key: random_state.choice(values) for key in random_state.sample(keys, random_state.randrange(6))}
    if random_state.random() < 0.5:
        made["type"] = random_state.choice(types)
    text = json.dumps(made)
    return text if random_state.random() < 0.8 else text[: random_state.randrange(len(text))]


def test_random_messages_are_answered_and_do_no_harm(tmp_path):
    async def story(server: Served) -> None:
        looker, page = await server.page("b"), await server.page("a")
        await page.until("frame")
        random_state = random.Random(1)
        for _ in range(10_000):
            await page.socket.send_str(nonsense(random_state))
        await page.socket.send_str("[" * 100_000)
        await page.socket.send_bytes(b"\0\1")
        await page.until("refused", message="a page sends texts")
        asked = await looker.do("drag")
        assert (await looker.until("done", id=asked))["id"] == asked

    run(tmp_path, story)


def test_a_message_of_100_mb_is_refused_and_the_session_goes_on(tmp_path):
    async def story(server: Served) -> None:
        page = await server.page("a")
        await page.until("frame")
        with pytest.raises((ConnectionError, aiohttp.ClientError)):
            await page.socket.send_str("x" * 100_000_000)
            await page.until("never")
        again = await server.page("b")
        await again.until("done", id=await again.do("drag"))

    run(tmp_path, story)


def test_200_connects_and_drops_and_too_many_pages(tmp_path):
    async def dropped(server: Served, k: int) -> None:
        page = await server.page(f"p{k}")
        page.socket._response.connection.transport.abort()

    async def story(server: Served) -> None:
        for k in range(0, 200, 20):
            await asyncio.gather(*(dropped(server, k + one) for one in range(20)))
        page = await server.page("a")
        await page.until("welcome")
        await asyncio.sleep(0.05)
        assert len(server.session.pages) == 1 and server.session.pages.hand is not None
        others = [await server.page(f"q{k}") for k in range(31)]
        assert len(server.session.pages) == 1 + len(others)
        with pytest.raises(aiohttp.WSServerHandshakeError, match="503"):
            await server.page("one too many")

    run(tmp_path, story)


def test_a_page_that_takes_no_answers_is_not_heard_any_further():
    async def story() -> None:
        page = Page(SimpleNamespace(closed=False), "a", KeptFrames())
        for _ in range(MOST_TEXTS):
            page.say("x")
        with pytest.raises(TimeoutError):
            await asyncio.wait_for(page.room(), 0.05)
        page._texts.clear()
        await asyncio.wait_for(page.room(), 1.0)

    asyncio.run(story())


def test_a_hand_that_sends_at_1000_hz_is_kept_up_with(tmp_path):
    async def story(server: Served) -> None:
        page = await server.page()
        await page.until("frame")
        last = 0
        for _ in range(300):
            last = await page.do("drag", latest=True, on="a", to=[0.1, 0.2])
            await asyncio.sleep(0.001)
        answer = await asyncio.wait_for(page.until("done", id=last), 0.5)
        assert answer["id"] == last

    run(tmp_path, story)


@pytest.mark.parametrize(("word", "code", "why"), [("bad", 2, "bad.toml: it is bad"), ("dead", 7, "")])
def test_a_process_that_never_shows_anything_ends_the_session_with_its_code(word: str, code: int, why: str):
    async def led() -> tuple[int, str]:
        session = LiveSession(StandIn([word]))
        return await session.lead(), session.failure

    assert asyncio.run(led()) == (code, why)


def test_a_process_that_dies_again_and_again_waits_for_a_hand_to_start_it(tmp_path):
    async def story(server: Served) -> None:
        page = await server.page()
        await page.until("frame")
        server.session._process.words.append("dead")
        await page.do("crash")
        await page.until("lost", restarting=False)
        server.session._process.words.remove("dead")
        await page.until("done", id=await page.say(type="restart"))
        first = await page.until("frame", number=0)
        asked = await page.do("drag")
        assert first["number"] == 0 and (await page.until("done", id=asked))["id"] == asked

    run(tmp_path, story)


def test_a_port_that_is_taken_gives_way_to_another_one():
    first, none = listening(None)
    with first:
        port = first.getsockname()[1]
        second, note = listening(port)
        with second:
            other = second.getsockname()[1]
            assert not none and other != port and f"port {port} is taken" in note and str(other) in note
            assert second.getsockname()[0] == "127.0.0.1"


def test_a_browser_is_opened_only_where_there_is_a_display(monkeypatch, capsys):
    for name in DISPLAYS:
        monkeypatch.delenv(name, raising=False)
    open_browser("http://127.0.0.1:1/x/")
    assert "no display" in capsys.readouterr().err
    monkeypatch.setenv("DISPLAY", ":7")
    monkeypatch.setattr(webbrowser, "get", lambda: (_ for _ in ()).throw(webbrowser.Error("none")))
    open_browser("http://127.0.0.1:1/x/")
    assert "no browser was found" in capsys.readouterr().err
