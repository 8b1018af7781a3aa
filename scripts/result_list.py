"""The committed results: which files, by which commands, of which code."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from stamps import ROOT

RESULTS = ROOT / "results"
OUTPUTS = (".png", ".gif", ".wav", ".md", ".json")
INPUTS = (".toml", ".jsonl")
"""Endings of results, and of scenes and scripts."""


@dataclass(frozen=True)
class Result:
    """One or several files that commands write.

    Args:
        files: patterns below results/, of what is committed.
        commands: after each other; the first word is `restshape`, or a module or file for Python.
        code: modules that it depends on besides the applications whose scenes are named; `.*` for a whole package.
        scenes: that commands read without naming them: patterns below apps/.
        timed: holds times, which only an idle machine gives.
    """

    files: tuple[str, ...]
    commands: tuple[str, ...]
    code: tuple[str, ...]
    scenes: tuple[str, ...] = ()
    timed: bool = False

    @property
    def name(self) -> str:
        """What distinguishes it: its first file, without its ending."""
        return re.sub(r"\.\*$|[-/]?\*|\.\w+$", "", self.files[0])

    @property
    def paths(self) -> list[Path]:
        """Its files that there are."""
        return sorted(path for pattern in self.files for path in RESULTS.glob(pattern) if path.suffix in OUTPUTS)

    @property
    def data(self) -> list[Path]:
        """The scenes and scripts that it reads, and the results that it is drawn from."""
        words = " ".join(self.commands)
        named = re.findall(r"(?:apps|docs)/\S+\.(?:toml|jsonl)", words)
        named += re.findall(r"--(?:redraw|before) (results/\S+\.json)", words)
        found = [path for pattern in self.scenes for path in (ROOT / "apps").glob(pattern) if path.suffix in INPUTS]
        return sorted({*(ROOT / name for name in named), *found})

    @property
    def entries(self) -> list[str]:
        """The modules whose imports are followed."""
        scenes = (tomllib.loads(path.read_text(encoding="utf-8")) for path in self.data if path.suffix == ".toml")
        return [*self.code, *dict.fromkeys(f"restshape_apps.{scene['app']}" for scene in scenes if "app" in scene)]


def reports(
    name: str,
    scene: str,
    edits: str,
    settings: Sequence[str] = (),
    looks: str = "--animation none",
    also: Sequence[str] = (),
) -> tuple[Result, Result]:
    """The report of a replay: pictures of what was found, others also, and of levels and the timeline, with times."""
    commands = (recorded(name, scene, edits, *settings), f"restshape report results/{name}.vtkhdf {looks}")
    kept = ("frames.png", "quantities.png", *also, *["animation.gif"] * ("none" not in looks))
    found = tuple(f"{name}-report/{file}" for file in kept)
    times = (f"{name}-report/timeline.png", f"{name}-report/levels.png")
    return Result(found, commands, REPORT), Result(times, commands, REPORT, timed=True)


def recorded(name: str, scene: str, edits: str = "", *settings: str) -> str:
    """The command that records a replay, with settings that differ from the scene's."""
    asked = "".join(f" --set '{setting}'" for setting in settings)
    return f"restshape replay {scene}{f' {edits}' if edits else ''} --out results/{name}.vtkhdf{asked}"


def bench(kind: str, words: str, files: Sequence[str], *scenes: str) -> Result:
    """A study of `restshape bench`."""
    code = (f"restshape_studies.commands.bench_{kind}", "restshape_studies.bench.*", "restshape.interface.run")
    return Result(tuple(files), (f"restshape bench {words}",), code, scenes, timed=True)


def studied(name: str, scene: str, quantity: str) -> Result:
    """The page of accuracy of a flow, over a drag that ends before eddies or plumes do."""
    words = f"{scene} --edits apps/{name}/edits/{name}-early.jsonl --of {quantity} --sizes 1.41,1,0.71"
    return Result(
        (f"accuracy-{name}/*.md", f"accuracy-{name}/*.png"),
        (
            f"restshape accuracy {words} --policies auto,refactor --budget 120s --seconds 10 --reference-seconds 60 "
            f"--out results/accuracy-{name}",
        ),
        ("restshape_studies.commands.accuracy", "restshape_studies.accuracy.*"),
        timed=True,
    )


FINE = ('mesh.size="4 mm"', 'mesh.near.window="1 mm"', "quantities.stress_at_window.error=true")
"""A finer mesh than the README's example has, everywhere, and the error of its stress."""
EXAMPLE = "docs/examples/bracket"
"""The README's."""
REPLAY = ("restshape.cli.replay",)
REPORT = (*REPLAY, "restshape.cli.report")
ALL = ("*/scenes/*.toml", "*/edits/*.jsonl")
SOLID, CANTILEVER, COUTURE = "apps/solid/scenes", "apps/cantilever/scenes", "apps/couture"
NOTES = " ".join(f"apps/metallophone/scenes/{letter}5.toml" for letter in "cdefgab")
PLATE, BEAM, FISH = f"{SOLID}/plate.toml", f"{CANTILEVER}/cantilever.toml", "apps/metallophone/scenes/fish.toml"
BRIDGE, BUILDING = "apps/bridge/scenes/bridge.toml", "apps/vibration/scenes/building.toml"
FLOW, TEAPOT = "apps/flow/scenes/flow.toml", "apps/thermal/scenes/thermal.toml"
STREET = "--field pressure --show vectors --at 10,85,100,211 --view=-0.03,0.17,-0.045,0.045 --animation none"
PLUMES = "--field temperature --show vectors --at 60,125,205 --animation none"
"""Looks of the thesis's figures 4.5 and 4.6: velocities over pressure and over temperature."""
SPHERE, PINS, STRIP = (f"{COUTURE}/scenes/{name}.toml" for name in ("sphere", "pins", "strip"))
SHIRT, NESTED = f"{COUTURE}/scenes/shirt.toml", ("mesh.levels=3", "effects.drape.levels=3")
"""A shirt, which these let begin on as coarse a mesh where its finest is twice as coarse."""
BAR, TABLE = "apps/metallophone/scenes/bar_200.toml", "apps/furniture/scenes/table.toml"
CUSICK, MEASURED = f"{COUTURE}/scenes/cusick.toml", "results/couture-cusick.svg"
DRAPED = ("restshape_apps.couture.drapes_command", "restshape_apps.couture.picture")
MAIN = (PLATE, BEAM, BRIDGE, BUILDING, FISH, STRIP, TABLE)


def verifying(module: str) -> list[str]:
    """The modules of this name of all that verifies applications."""
    files = sorted((ROOT / "verification").glob(f"*/{module}.py"))
    return [f"restshape_verification.{path.parent.name}.{module}" for path in files]


def brought(picture: str, module: str, words: str, *scenes: str) -> Result:
    """What a command draws that an application brings along; the module has it, or draws for it."""
    return Result((picture,), (f"restshape {words}",), (module,), scenes)


ELSEWHERE = ("mutants.md", "bench-before.json")
"""Files that commands of their own renew; figures of an earlier commit, which no command makes again."""

LIST = (
    *reports("bracket", f"{EXAMPLE}.toml", f"{EXAMPLE}.jsonl", FINE, "--show supports,loads,hand"),
    *reports("plate", PLATE, "apps/solid/edits/plate.jsonl"),
    *reports("cantilever", BEAM, "apps/cantilever/edits/cantilever.jsonl"),
    Result(
        ("pipe-report/frames.png", "pipe-report/quantities.png"),
        (recorded("pipe", "apps/thermal/scenes/pipe.toml"), "restshape report results/pipe.vtkhdf --animation none"),
        REPORT,
    ),
    *reports("flow", FLOW, "apps/flow/edits/flow.jsonl", also=("history.png",)),
    Result(
        ("flow-street/frames.png",),
        (
            recorded("flow", FLOW, "apps/flow/edits/flow.jsonl"),
            f"restshape report results/flow.vtkhdf --out results/flow-street {STREET}",
        ),
        REPORT,
    ),
    *reports("thermal", TEAPOT, "apps/thermal/edits/thermal.jsonl", looks=PLUMES, also=("history.png",)),
    *reports("couture", SPHERE, f"{COUTURE}/edits/sphere-drag.jsonl"),
    Result(
        ("couture-sphere.png",),
        (
            recorded("couture", SPHERE, f"{COUTURE}/edits/sphere-drag.jsonl"),
            "restshape drapes results/couture.vtkhdf --frames 0 24 61 --out results/couture-sphere.png",
        ),
        (*REPLAY, *DRAPED),
    ),
    Result(
        ("couture-fit.png",),
        (
            recorded("couture-cusick", CUSICK),
            f"restshape shadow results/couture-cusick.vtkhdf --out {MEASURED} --noise 1mm",
            f"restshape fit {CUSICK} --outline {MEASURED} --set material.cotton.bending=15e-6"
            " --picture results/couture-fit.png",
        ),
        (*REPLAY, "restshape_apps.couture.shadow_command", "restshape_apps.couture.fit_command"),
    ),
    Result(
        ("couture-pins.png",),
        (
            recorded("couture-pins", PINS, f"{COUTURE}/edits/pins.jsonl"),
            "restshape drapes results/couture-pins.vtkhdf --frames 0 17 26 --out results/couture-pins.png",
        ),
        (*REPLAY, *DRAPED),
    ),
    *(
        Result(
            (f"couture-{name}.png",),
            (
                recorded(f"couture-{name}", f"{COUTURE}/{scene}", *(f"{COUTURE}/{edits}" for edits in script)),
                f"restshape drapes results/couture-{name}.vtkhdf --frames {frames} --out results/couture-{name}.png",
            ),
            (*REPLAY, *DRAPED),
        )
        for name, scene, script, frames in (
            ("poncho", "scenes/poncho.toml", (), "0"),
            ("skirt", "scenes/skirt.toml", (), "0"),
            ("napkin", "template/scene.toml", ("template/edits.jsonl",), "0 8 -1"),
            ("stool", "scenes/stool.toml", ("edits/stool.jsonl",), "0 -1"),
            ("darts", "scenes/darts.toml", ("edits/darts.jsonl",), "0 4 -1"),
            ("sewn-skirt", "scenes/sewn_skirt.toml", ("edits/sewn_skirt.jsonl",), "0 -1"),
            ("growing", "scenes/growing.toml", ("edits/growing.jsonl",), "0 2"),
            ("dress", "patterns/dress.toml", (), "0"),
            ("lined-skirt", "scenes/lined_skirt.toml", (), "0"),
            ("collar", "scenes/collar.toml", (), "0"),
        )
    ),
    Result(
        ("couture-dress-strain.png",),
        (
            recorded("couture-dress", f"{COUTURE}/patterns/dress.toml"),
            "restshape drapes results/couture-dress.vtkhdf --show strain --out results/couture-dress-strain.png",
        ),
        (*REPLAY, *DRAPED, "restshape.physics.cloth.pictures.pattern_beside_drape"),
    ),
    Result(
        ("couture-shirt.png",),
        (
            recorded("couture-shirt", SHIRT, "", 'mesh.size="19.2 mm"', *NESTED),
            "restshape drapes results/couture-shirt.vtkhdf --frames 0 --out results/couture-shirt.png",
        ),
        (*REPLAY, *DRAPED),
    ),
    brought(
        "bridge-study.png",
        "restshape_verification.bridge.study",
        "bridge-study --picture results/bridge-study.png",
        "bridge/*/*",
    ),
    brought(
        "vibration-resonance.png",
        "restshape_verification.vibration.resonance",
        "resonance --picture results/vibration-resonance.png",
        "vibration/*/building.*",
    ),
    Result(
        ("metallophone-modes.png", "metallophone-rasp.png"),
        (f"restshape modes {FISH} --out results/metallophone-modes.png --rasp results/metallophone-rasp.png",),
        ("restshape_apps.metallophone.picture",),
    ),
    brought(
        "metallophone-rasping.png",
        "restshape_apps.metallophone.rasping.map_picture",
        f"tune {FISH} --to C5 --measured 506 --rasp --picture results/metallophone-rasping.png",
    ),
    brought(
        "metallophone-space.png",
        "restshape_apps.metallophone.space_picture",
        f"modes {FISH} --set effects.modal.in_plane=true --set effects.modal.modes=7"
        " --space results/metallophone-space.png",
    ),
    brought(
        "metallophone-fish.wav",
        "restshape_apps.metallophone.sounding.blow",
        f"sound {FISH} --out results/metallophone-fish.wav --seconds 1",
    ),
    Result(
        ("metallophone-artist.png",),
        (
            recorded("artist", "apps/metallophone/scenes/artist.toml", "apps/metallophone/edits/artist.jsonl"),
            "restshape pitches results/artist.vtkhdf --out results/metallophone-artist.png",
        ),
        (*REPLAY, "restshape_apps.metallophone.pitches_command", "restshape_apps.metallophone.pitches_picture"),
    ),
    Result(
        ("metallophone-scale.png", "metallophone-scale.wav"),
        (f"restshape instrument {NOTES} --out results/metallophone-scale.png --wav results/metallophone-scale.wav",),
        ("restshape_apps.metallophone.instrument_command",),
        ("metallophone/scenes/[a-g]5.toml",),
    ),
    Result(
        ("metallophone-accuracy.png",),
        ("restshape bar-accuracy --picture results/metallophone-accuracy.png",),
        ("restshape_verification.metallophone.accuracy",),
        ("metallophone/*/*",),
        timed=True,
    ),
    brought(
        "column-modes.png",
        "restshape_apps.solid.picture",
        f"buckling {SOLID}/column.toml --out results/column-modes.png",
    ),
    Result(
        ("couture-bending.png",),
        ("tests/physics/bending_kinds.py --picture results/couture-bending.png",),
        ("tests.physics.bending_kinds",),
    ),
    brought(
        "couture-cycles.png",
        "restshape_verification.couture.cycles",
        "cloth-cycles --picture results/couture-cycles.png",
        "couture/scenes/sphere.toml",
    ),
    Result(
        ("furniture-*.png",),
        ("restshape furniture-pictures --out results/furniture",),
        ("restshape_apps.furniture.pictures",),
        ("furniture/*/*",),
    ),
    bench(
        "reuse",
        f"reuse {PLATE} {BEAM} {FLOW} {TEAPOT} --seconds 60 --out results --json results/bench-reuse.json",
        ["bench-reuse.*"],
    ),
    bench(
        "reuse",
        f"reuse {BUILDING} {BAR} --policies rebuild,refactor,auto --frames 50 --repeat 2 --out results "
        "--json results/bench-scenes.json",
        ["bench-scenes.json"],
    ),
    Result(
        ("bench-stages.png",),
        (
            "restshape bench reuse --redraw results/bench-reuse.json --redraw results/bench-scenes.json "
            "--before results/bench-before.json --out results",
        ),
        ("restshape_studies.pictures.stages",),
    ),
    bench(
        "peers",
        "peers --page results/peers/README.md --json results/peers/peers.json",
        ["peers/*.md", "peers/*.json"],
    ),
    bench(
        "scaling",
        "scaling plate --ranks 1,2 --strong --weak --triangles 20000,100000 --frames 150 --out results/scaling "
        "--json results/scaling/scaling.json",
        ["scaling/*.md", "scaling/*.png", "scaling/*.json"],
        "solid/*/plate.*",
    ),
    Result(("live.gif",), ("scripts/live_gif.py",), ("restshape.live.worker",), timed=True),
    bench("live", "live --json results/bench-live.json", ["bench-live.json"]),
    bench("limit", "limit --out results --json results/bench-limit.json", ["bench-limit.*"], "solid/*/plate.*"),
    bench("size", "size --out results --json results/bench-size.json", ["bench-size.*"], "solid/*/plate.*"),
    bench("large", "large --json results/bench-large.json", ["bench-large.json"], "*/scenes/*.toml"),
    bench("order", f"order {PLATE} --json results/bench-order.json", ["bench-order.json"]),
    bench("design", f"predict {BEAM} --out results --json results/bench-predict.json", ["bench-predict.*"]),
    bench(
        "design",
        f"derivative {BEAM} --out results --json results/bench-derivative.json",
        ["bench-derivative.json", "sensitivity-epsilon.png"],
    ),
    Result(
        ("bench-maps.*",),
        ("restshape bench maps --picture results/bench-maps.png --json results/bench-maps.json",),
        ("restshape_studies.commands.bench_maps", "restshape_studies.bench.maps", "restshape_studies.pictures.maps"),
    ),
    bench("eigen", f"eigen {BAR} --set effects.modal.modes=5 --json results/bench-eigen.json", ["bench-eigen.json"]),
    bench(
        "drape",
        f"drape {SPHERE} --set effects.cloth.bending=hinge --frames 20 --picture results/bench-drape.png",
        ["bench-drape.png"],
    ),
    Result(
        ("THESIS.md",),
        ("restshape tables",),
        ("restshape_studies.commands.tables", *verifying("thesis")),
        ALL,
        timed=True,
    ),
    Result(
        ("accuracy/*.md", "accuracy/*.png"),
        (f"restshape accuracy {' '.join(MAIN)} --out results/accuracy --json results/accuracy/accuracy.json",),
        (
            "restshape_studies.commands.accuracy",
            "restshape_studies.accuracy.*",
            *verifying("plank_study"),
        ),
        timed=True,
    ),
    studied("flow", FLOW, "drag"),
    studied("thermal", TEAPOT, "nusselt"),
    Result(
        ("stability.json",),
        ("restshape stability --json results/stability.json",),
        ("restshape_studies.commands.stability", "restshape_studies.stability.*", *verifying("stability")),
        ALL,
        timed=True,
    ),
    Result(
        ("fuzz.json", "fuzz-recordings.json", "fuzz-files.json"),
        (
            "restshape stability --fuzz 8500 --kind drawn --kind damaged --json results/fuzz.json",
            "restshape stability --fuzz 500 --kind recordings --json results/fuzz-recordings.json",
            "restshape stability --fuzz 1000 --kind files --json results/fuzz-files.json",
        ),
        ("restshape_studies.commands.stability", "restshape_studies.stability.*", *verifying("random_scenes")),
        timed=True,
    ),
)
