"""A study keeps to its time, writes each point as it comes, and goes on where it was stopped."""

import csv
from dataclasses import replace
from math import inf
from pathlib import Path
from time import monotonic
from types import SimpleNamespace

import pytest
from restshape_studies.accuracy import study as module
from restshape_studies.accuracy.kept_points import COLUMNS, KeptPoints
from restshape_studies.accuracy.reference import Plan
from restshape_studies.accuracy.setting import Choice, Setting
from restshape_studies.accuracy.study import SPENT, Asked, Case, Deadline, expected, study, too_slow
from restshape_studies.bench.job import STOPPED, Outcome
from restshape_studies.commands.accuracy import write_csv
from small_scenes import across, drag, plate, write_scene, write_script

from restshape.errors import UserError

PLAN = Plan(0.25, 2, 4.0, "rebuild", (1e-10,))


def known_point(name, **more):
    """A point, as far as the study looks at it."""
    return {"name": name, "problem": "", "error": 0.1, "frame_ms": 1.0, "pareto": False} | more


def test_points_of_the_same_question_are_known_again_and_others_are_not(tmp_path):
    folder = tmp_path / ".a-points"
    kept = KeptPoints(folder, {"scene": 1})
    kept.add(known_point("a", error=inf))
    kept.add(known_point("slow", problem=f"{STOPPED} after 3 s"))
    assert kept.reference(PLAN) is None
    (folder / "fine").mkdir()
    kept.keep_reference(PLAN, {"x": 1}, {"x": 2})
    again = KeptPoints(folder, {"scene": 1})
    # One that had too little time is tried again.
    assert list(again.records) == ["a"] and again.records["a"]["error"] is None
    assert again.reference(PLAN) == ({"x": 1}, {"x": 2}) and (folder / "fine").is_dir()
    other = KeptPoints(folder, {"scene": 2})
    assert other.records == {} and other.reference(PLAN) is None and not (folder / "fine").exists()
    other.done()
    assert not folder.exists()


def test_a_half_finished_reference_is_begun_again(tmp_path):
    kept = KeptPoints(tmp_path / ".a-points", {})
    (kept.folder / "coarse").mkdir()
    assert kept.reference(PLAN) is None and not (kept.folder / "coarse").exists()


def test_no_job_gets_more_than_is_left():
    given = []

    def play(job, seconds):
        given.append(seconds)
        return Outcome([])

    for budget, most in ((inf, 30.0), (1000.0, 30.0), (12.0, 12.0), (-5.0, 0.1)):
        Deadline(monotonic(), budget, play).play(None, 30.0)
        assert given[-1] == pytest.approx(most, abs=0.5)
    spent, stopped = Deadline(monotonic(), 0.0, play), known_point("a", problem=f"{STOPPED} after 1 s")
    assert spent.whole(stopped) is None and spent.whole(known_point("b")) is not None
    assert Deadline(monotonic(), inf, play).whole(stopped) is stopped
    assert Asked(seconds=30.0, reference_seconds=120.0).most(3) == 330.0 and Asked(budget=20.0).most(3) == 20.0


def test_only_what_is_left_is_estimated_and_a_budget_that_is_too_short_is_named(tmp_path):
    tried = [Setting(factor, 1, "auto", 1e-6) for factor in (2.0, 1.0, 0.5)]
    kept = KeptPoints(tmp_path / ".a-points", {})
    asked = Asked(seconds=30.0, reference_seconds=120.0)
    assert expected(asked, tried, kept, False) == [
        "3 points of at most 30 s, two references of at most 120 s: at most 330 s in all (--budget, --seconds)"
    ]
    kept.records = {tried[1].name: known_point(tried[1].name)}
    assert expected(asked, tried, kept, True) == [
        f"kept: the reference and 1 point: {tried[1].name}",
        "2 points left of at most 30 s: at most 60 s in all (--budget, --seconds)",
    ]
    short = expected(replace(asked, budget=200.0), tried, kept, False)
    assert short[-1].startswith("note: --budget of 200 s may end before both references are known")
    assert "240 s" in short[-1] and "--reference-seconds" in short[-1]
    assert not any("note" in line for line in expected(replace(asked, budget=200.0), tried, kept, True))


def test_finer_meshes_than_one_that_is_too_slow_are_not_tried():
    slow = {"name": "coarse", "order": 1, "policy": "auto", "varied": "", "size_factor": 1.0, "frame_ms": 20.0}
    finer = Setting(0.5, 1, "auto", 1e-6)
    assert too_slow([slow], finer, 16.0) == "coarse takes 20 ms a frame already (--within)"
    assert not too_slow([slow], finer, None) and not too_slow([slow], finer, 25.0)
    assert not too_slow([slow], Setting(2.0, 1, "auto", 1e-6), 16.0)
    assert not too_slow([slow], Setting(0.5, 2, "auto", 1e-6), 16.0)
    assert not too_slow([slow], Setting(0.5, 1, "auto", 1e-6, "solve.tolerance", 1e-4), 16.0)


def test_a_study_that_is_stopped_goes_on_with_the_points_that_are_left(tmp_path, monkeypatch):
    """Two points, of which the first run has time for one."""
    scene = write_scene(tmp_path, plate(0.25))
    edits = write_script(tmp_path, drag("window", (0.5, 0.5), across((0.5, 0.5), (0.55, 0.5), 3)))
    asked = Asked(Choice((2.0, 1.0), (1,), (1e-6,), ("auto",)), samples=2, budget=50.0)
    clock, ran, said, written = [0.0], [], [], []

    def one(found, setting, folder, play):
        assert Path(folder).is_dir()
        ran.append(setting.name)
        clock[0] += 30.0
        return known_point(setting.name)

    monkeypatch.setattr(module, "monotonic", lambda: clock[0])
    monkeypatch.setattr(module, "one", one)
    monkeypatch.setattr(module, "referred", lambda *_: (clock.__setitem__(0, clock[0] + 25.0), empty_study())[1])

    def started():
        clock[0] = 0.0

        def on_point(records):
            written.append([one["name"] for one in records])

        return study(Case("plate", scene, edits), asked, said.append, out=tmp_path, on_point=on_point)

    first = started()
    assert "2 points of at most 30 s, two references of at most 120 s: at most 50 s in all" in said[0]
    assert len(first.records) == 1 and [one.why for one in first.omissions] == [SPENT]
    assert (tmp_path / ".plate-points").is_dir() and written == [ran[:1]]
    said.clear()
    second = started()
    assert said[0] == f"plate: kept: 1 point: {ran[0]}" and said[1].startswith("plate: 1 point left of at most 30 s")
    assert len(ran) == len(set(ran)) == 2 and [one["name"] for one in second.records] == ran
    assert not second.omissions and written[1:] == [ran[:1], ran] and not (tmp_path / ".plate-points").exists()


@pytest.mark.parametrize(("after", "words"), [(0, "nothing is kept"), (1, "the reference and 1 point; the same")])
def test_a_study_that_is_interrupted_says_what_is_kept(tmp_path, monkeypatch, after, words):
    scene = write_scene(tmp_path, plate(0.25))
    edits = write_script(tmp_path, drag("window", (0.5, 0.5), across((0.5, 0.5), (0.55, 0.5), 3)))
    asked, ran, said = Asked(Choice((2.0, 1.0), (1,), (1e-6,), ("auto",)), samples=2), [], []

    def one(found, setting, folder, play):
        if len(ran) == 1:
            raise KeyboardInterrupt
        ran.append(setting.name)
        return known_point(setting.name)

    def referred(*given):
        if not after:
            raise KeyboardInterrupt
        (given[6].folder / "reference.json").write_text("{}")
        return empty_study()

    monkeypatch.setattr(module, "one", one)
    monkeypatch.setattr(module, "referred", referred)
    with pytest.raises(KeyboardInterrupt):
        study(Case("plate", scene, edits), asked, said.append, out=tmp_path)
    assert words in said[-1] and said[-1].startswith("plate: interrupted")
    assert (str(tmp_path / ".plate-points") in said[-1]) == bool(after) == (tmp_path / ".plate-points").exists()


def test_a_reference_without_a_solution_leaves_no_folder(tmp_path, monkeypatch):
    scene = write_scene(tmp_path, plate(0.25))
    edits = write_script(tmp_path, drag("window", (0.5, 0.5), across((0.5, 0.5), (0.55, 0.5), 3)))

    def referred(*given):
        assert given[6].folder.is_dir()
        raise UserError("the reference was not finished", "plate", "--reference-seconds")

    monkeypatch.setattr(module, "referred", referred)
    with pytest.raises(UserError):
        asked = Asked(Choice((2.0, 1.0), (1,), (1e-6,), ("auto",)), samples=2)
        study(Case("plate", scene, edits), asked, lambda text: None, out=tmp_path)
    assert not (tmp_path / ".plate-points").exists()


def empty_study():
    """A study with a reference and no points."""
    return SimpleNamespace(
        records=[], omissions=[], case=SimpleNamespace(name="plate"), asked=SimpleNamespace(within=None)
    )


def test_points_are_a_table(tmp_path):
    path = tmp_path / "a.csv"
    write_csv(path, [known_point("a, b", uncertainty=None)])
    write_csv(path, [known_point("a, b", uncertainty=None), known_point("c", error=0.25)])
    with path.open() as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0]) == list(COLUMNS) and [row["name"] for row in rows] == ["a, b", "c"]
    assert rows[0]["uncertainty"] == "" and float(rows[1]["error"]) == 0.25
    write_csv(None, [])


def test_a_reference_that_the_budget_stops_names_it(tmp_path):
    scene = write_scene(tmp_path, plate(size=0.25), "plate.toml")
    case = Case("plate", scene, write_script(tmp_path, drag("window", (0.5, 0.5), [(0.51, 0.5), (0.52, 0.5)])))

    def late(job, seconds):
        return Outcome([], f"{STOPPED} after {seconds:.0f} s")

    for budget, named, other in ((30.0, "--budget", "--reference-seconds"), (1e6, "--reference-seconds", "--budget")):
        choice = Choice((1.0,), (1,), (1e-2,), ("auto",))
        asked = Asked(choice, frames=3, samples=2, reference_seconds=60.0, budget=budget)
        with pytest.raises(UserError) as refusal:
            study(case, asked, lambda words: None, late)
        assert named in refusal.value.what + refusal.value.do and other not in refusal.value.what + refusal.value.do
        assert ("nothing is kept before the reference" in refusal.value.what) == (named == "--budget")
