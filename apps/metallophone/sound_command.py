"""`restshape sound`: the sound of a plate that is struck, once or all through an edit."""

from __future__ import annotations

import argparse
from math import inf, nan
from typing import TYPE_CHECKING, Any

from restshape_apps.metallophone.stage import add_frame, analysed, metallophone

from restshape.cli.options import add_json, write_json
from restshape.errors import UserError, one_line
from restshape.outputs.kinds import SoundFile
from restshape.outputs.si_numbers import counted

if TYPE_CHECKING:
    from restshape_apps.metallophone.sounding.drag import ModesAt

SECONDS, EVERY, CONTACT = 2.0, 0.5, 5e-4
"""How long a blow is heard, time between blows of a drag, and for which the mallet touches [s]."""
LONGEST = 600.0
"""A sound at most [s]."""


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    add_frame(parser)
    parser.add_argument("--out", type=SoundFile, required=True, metavar="FILE", help="the sound (.wav)")
    parser.add_argument("--drag", action="store_true", help="through all edits, as long as they take, with their tones")
    parser.add_argument("--sine", action="store_true", help="with --drag: the first tone alone, instead of blows")
    parser.add_argument("--every", type=float, metavar="SECONDS", help=f"with --drag: from blow to blow ({EVERY})")
    parser.add_argument("--at", type=float, nargs=2, metavar=("X", "Y"), help="where it is struck [m]")
    parser.add_argument(
        "--contact",
        type=float,
        metavar="SECONDS",
        help=f"how long the mallet touches: a hard one shorter ({CONTACT:g})",
    )
    parser.add_argument(
        "--damping", type=float, metavar="SHARE", help="share of critical damping of all modes (default: by material)"
    )
    parser.add_argument("--seconds", type=float, metavar="SECONDS", help=f"how long one blow is heard ({SECONDS:g})")
    add_json(parser)


def run(args: argparse.Namespace) -> int:
    """Write the sound; 0."""
    _refuse_nonsense(args)
    return _drag(args) if args.drag else _blow(args)


def _refuse_nonsense(args: argparse.Namespace) -> None:
    """Refuse numbers that make no sense, and options that do not belong together."""
    if args.damping is not None and not 0.0 <= args.damping < 1.0:
        raise UserError("a share of critical damping is from 0 to below 1", "--damping", "leave it out, or give 1e-3")
    if args.contact is not None and not 0.0 <= args.contact <= 0.1:
        raise UserError("a mallet touches for 0 to 0.1 s", "--contact", "leave it out, or give 5e-4")
    if args.seconds is not None and not 0.0 < args.seconds <= LONGEST:
        raise UserError(f"a sound lasts longer than 0 and at most {LONGEST:g} s", "--seconds", "leave it out")
    if args.every is not None and not args.every > 0.0:
        raise UserError("the time between blows is positive", "--every", "leave it out, or give 0.5")
    alone = {"--sine": args.sine, "--every": args.every is not None}
    within = {"--frame": args.frame is not None, "--seconds": args.seconds is not None}
    for option, given in (within if args.drag else alone).items():
        if given:
            what = "is of one blow, not of a drag" if args.drag else "is of a drag"
            raise UserError(f"{option} {what}", option, f"leave {option} or --drag out" if args.drag else "add --drag")
    blown = {"--every": args.every, "--at": args.at, "--contact": args.contact, "--damping": args.damping}
    for option, value in blown.items():
        if args.sine and value is not None:
            raise UserError(
                f"{option} is of blows, which a sine does not have", option, f"leave {option} or --sine out"
            )


def _contact(args: argparse.Namespace) -> float:
    return CONTACT if args.contact is None else args.contact


def _blow(args: argparse.Namespace) -> int:
    analysis = analysed(args)
    from restshape_apps.metallophone.sounding.blow import struck
    from restshape_apps.metallophone.sounding.damping import damping_of
    from restshape_apps.metallophone.sounding.place import struck_place
    from restshape_apps.metallophone.sounding.wav import write_wav

    place, deflections = struck_place(analysis, args.at)
    frequencies, damping = analysis.frequencies, damping_of(analysis, args.damping)
    seconds = SECONDS if args.seconds is None else args.seconds
    write_wav(args.out, struck(frequencies, deflections, damping.shares, seconds, _contact(args)))
    decays = damping.decay_times(frequencies)
    found = {"frequencies": frequencies, "deflections": deflections, "damping": damping.shares, "decay_times": decays}
    lists: dict[str, Any] = {name: values.tolist() for name, values in found.items()}
    lists["decay_times"] = [one if one < inf else None for one in lists["decay_times"]]
    write_json(args, {"at": place.tolist(), **lists, "contact": _contact(args)})
    tones = ", ".join(f"{f:.1f}" for f in frequencies)
    print(f"wrote {one_line(args.out)}: struck at ({place[0]:.4g}, {place[1]:.4g}) m, {tones} Hz")
    if _contact(args) > 0.0:
        print(
            f"mallet: touches for {_contact(args):.3g} s; modes above {1.0 / _contact(args):.0f} Hz lose half or more"
        )
    times = ", ".join(f"{time:.3g} s" if time < inf else "never" for time in decays)
    print(f"damping: {damping.source}; -60 dB after: {times}")
    return 0


def _drag(args: argparse.Namespace) -> int:
    scene = metallophone(args)
    from restshape_apps.metallophone.sounding import drag
    from restshape_apps.metallophone.sounding.wav import write_wav

    from restshape.interface.first_frame import run_of

    run = run_of(scene, args.edits)
    every = EVERY if args.every is None else args.every
    if not _contact(args) < every:
        raise UserError("the mallet touches until the next blow", "--contact, --every", "give a shorter contact")
    known: list[ModesAt] = []
    times: list[float] = []
    for row in run.rows():
        times.append(float(row["t"]))
        # Frames that are not analysed have no frequency of their own.
        if row.get("f_1", nan) > 0.0:
            known.append(drag.modes_at(run.replay.analysis, times[-1], args.at, args.damping))
    if args.edits is None:
        raise UserError("without edits there is no drag to hear", "--drag", "name a script (.jsonl), or leave it out")
    frames = drag.in_order(known, times[0], times[-1])
    length = frames[-1].t - frames[0].t
    if length > LONGEST:
        raise UserError(f"the edits last {length:g} s, a sound at most {LONGEST:g} s", "--drag", "shorten the script")
    sound = drag.sine(frames) if args.sine else drag.blows(frames, every, _contact(args))
    write_wav(args.out, sound)
    tones = [{"t": frame.t, "frequencies": frame.frequencies.tolist()} for frame in frames]
    write_json(args, {"seconds": length, "frames": tones})
    first, last = (frame.frequencies[0] for frame in (frames[0], frames[-1]))
    many = counted(len(times), "frame")
    way = "a sine" if args.sine else f"a blow each {every:g} s"
    print(f"wrote {one_line(args.out)}: {length:.3g} s, {many}, {way}, {first:.1f} to {last:.1f} Hz")
    return 0
