"""Each option of each command has an effect, or is refused with another one as it declares.

A new option is covered by its declaration and its type. One that takes free text needs a line in
``TEXTS``, a new command one in ``BASES`` or ``ELSEWHERE``.
"""

import json
import re
import sys
from collections.abc import Sequence
from functools import cache
from pathlib import Path

import click
import numpy as np
import pytest
from click.testing import CliRunner
from processes.conftest import commands

import furuta
from furuta.results.table import Table
from furuta_bringup.main import furuta as main
from furuta_bringup.option_types import OutputFile
from furuta_bringup.options import Option
from furuta_model.parameters import ParameterError
from furuta_ros.errors import UserError

# Values of options of free text; where the command takes them, they differ from what it has.
GIVEN = """--set zeta1=0.8 --set alpha0=0.3 | --params PARAMETERS.yaml | --rig qube_servo_2 |
--own-parts os:cpu_count | --compensation lugre | --law coulomb | --feedback 9 4 60 20 |
--over alpha0=0.1:0.2:2 | --candidate coulomb | --namespace other |
--scheduler tcp://127.0.0.1:9 | --friction alpha0=0.2 | --counts 500 | --lead 10mm |
--joint other | --position wrist | --command wrist | --time time2 | --goal wrist |
--moving wrist2=wrist |
--columns a,b | --urdf ARM.urdf | --arm wrist | --pendulum wrist | --states states |
--zero hanging | --axis JOINT.yaml | --topic x | --validate RIG.csv |
--pid 3 6 0.2 | --cascade 10 0.3 1 | --port mock | --record BAG | --remap a:=b | --out OTHER |
--prefix left_ | --seconds 14 | --arm-guard 0.3 | --pendulum-guard 0.01"""
TEXTS = dict(each.strip().split(" ", 1) for each in GIVEN.split("|"))
# Cheap calls of each command. Those of LONG take seconds each.
BASES = {
    "simulate": ["--seconds 12"],
    "swing-up": ["--starts 2"],
    "sweep": [f"{each} --seconds 12 --out RUNS.csv" for each in ("omega1=6.5,7", "seed=1,2")],
    "compare": ["--rigs 2 --seconds 6 --candidate none --candidate lugre"],
    "linearize": ["", "--figure-4", "--passivity"],
    "limit-cycle": ["", "--predict"],
    "export c": ["--out CODE", "--out CODE --axis JOINT.yaml"],
    "export description": [""],
    "export urdf": ["--axis JOINT.yaml"],
    "export sdf": ["--axis JOINT.yaml"],
    "export mjcf": ["--axis JOINT.yaml", "--axis JOINT.yaml --lugre"],
    "identify": ["SWING.csv --command none", "GOAL.csv --body servo --goal goal"],
    "bag export": ["RIG.csv --out X.csv", "SERIES.csv --out X.csv", "SERIES.npz --out X.csv"],
    "param defaults": ["controller"],
    "hw rig": ["paper"],
}
LONG = {
    "tune": ["--seconds 60"],
    "identify": [
        *("RIG.csv", "AXIS.csv --body axis"),
        "AXIS.csv --body joint --joint position --moving wrist=wrist",
    ],
    "axis": [
        *(
            "JOINT.yaml",
            "--inertia 0.01 --friction alpha0=0.1,alpha1=0.05 --law stiction --pid 2 6 .12",
        )
    ],
    "limit-cycle": ["--over omega1=6:6.2", "--over omega1=6:7:2 --over omega2=5:6:2"],
}
NOTHING_TO_DRAW = "--set alpha0=0 --set alpha1=0"
# Commands of graphs, rigs and bags, of which only the declarations are tried.
ELSEWHERE = ("demo", "page", "run", "view", "bag info", "bag rec", "bag rep", "hw ", "param ")
# What waits for a graph or a cluster, or compares dozens of rigs; what rightly changes nothing.
SLOW, NO_EFFECT = (
    {"--running", "--scheduler", "--truths", "--bandwidths"},
    {"--force", "--own-parts"},
)


COMMANDS = {" ".join(n): c for n, c in commands(main) if not isinstance(c, click.Group)}


def options(name: str) -> dict[str, click.Option]:
    """The options of a command by their first names."""
    return {o.opts[0]: o for o in COMMANDS[name].params if isinstance(o, click.Option)}


def words(option: click.Option) -> list[str]:
    """The option with a value that is not its default."""
    kind, own, default = option.type, option.opts[0], option.default
    if option.is_flag:
        return [own]
    if isinstance(kind, OutputFile):
        return [own, f"NEW{kind.suffixes[0].upper()}"]
    if isinstance(kind, click.Choice):
        return [own, [each for each in kind.choices if each != default][-1]]
    if own not in TEXTS and isinstance(kind, click.IntRange | click.FloatRange):
        known = isinstance(default, int | float) and default
        value = 1.5 * default if known else max(3.0, 1.5 * (kind.min or 0.0))
        value = value if kind.max is None else min(value, kind.max)
        return [own, str(round(value) if isinstance(kind, click.IntRange) else value)]
    assert own in TEXTS, f"{own} needs a line in TEXTS"
    return [own, *TEXTS[own].split()]


def refusal(name: str, *texts: str) -> str:
    """Why a command's parser refuses options, named alone or with a value; empty if it does not."""
    known = options(name)
    for group in getattr(COMMANDS[name], "one_of", ()):
        if not {text.split()[0] for text in texts} & {*group}:
            texts += (min(group, key=lambda each: (bool(needs(name, each)), each == "FILE")),)
    given = [
        word
        for text in texts
        if text in known or " " in text
        for word in (text.split() if " " in text else words(known[text]))
    ]
    given += [w for o in known.values() if o.required and o.opts[0] not in given for w in words(o)]
    arguments = [each for each in COMMANDS[name].params if isinstance(each, click.Argument)]
    given += ["X" for each in arguments if each.required or "FILE" in texts]
    try:
        COMMANDS[name].make_context("x", given)
    except click.UsageError as error:
        assert error.exit_code == 2
        return error.message
    return ""


def with_needs(name: str, *texts: str) -> list[str]:
    """The options, and the first of those that each needs."""
    found: dict[str, str] = {}
    pending = [*texts]
    while pending:
        text = pending.pop(0)
        if (own := text.split()[0]) not in found:
            found[own] = text
            pending += needs(name, own)[:1]
    return list(found.values())


def needs(name: str, text: str) -> Sequence[str]:
    """What an option needs; an argument needs nothing."""
    return getattr(options(name).get(text), "needs", ())


RULES = [
    (name, option, kind, other)
    for name in COMMANDS
    for option, declared in options(name).items()
    if isinstance(declared, Option)
    for kind in ("needs", "not_with", "once_with")
    for other in getattr(declared, kind)
]


@pytest.mark.parametrize(("name", "option", "kind", "other"), RULES)
def test_what_is_declared_is_refused(name: str, option: str, kind: str, other: str) -> None:
    """In one line that names both; without the other one, or with it, the option is taken."""
    assert refusal(name, *with_needs(name, option)) == ""
    if kind == "needs":
        groups = getattr(COMMANDS[name], "one_of", ())
        instead = [next(e for e in group if e != other) for group in groups if other in group]
        why = refusal(name, option, *(with_needs(name, *instead) if instead else ()))
    else:
        once = [option] if kind == "once_with" else []
        why = refusal(name, *with_needs(name, other, option), *once)
    assert option in why
    assert other.split(maxsplit=1)[0] in why


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of recordings and other files."""
    folder = tmp_path_factory.mktemp("files")
    time = 4e-3 * np.arange(1500)
    goal = 0.6 * np.sin(4.4 * time) + 0.2 * np.sin(11.9 * time)
    axis = furuta.Axis(0.01, furuta.Friction(alpha0=0.1, alpha1=0.05, viscous=0.02), "coulomb")
    pid = furuta.Pid(4.0, 6.0, 0.2)
    run = furuta.simulate_axis(axis, pid, reference=goal, counts=2**17, sample_time=4e-3)
    furuta.identify(run.recording, "axis").write(folder / "JOINT.yaml", pid)
    moved = {"position": run.measured, "torque": run.torque, "goal": goal, "wrist": 0.3 * goal**2}
    loop = furuta.Axis(1e-3, furuta.Friction(alpha0=0.05, alpha1=0.0, viscous=0.05), "coulomb")
    short = time[:1000]
    followed = furuta.simulate_axis(
        loop,
        furuta.Pid(1.0),
        reference=np.repeat(goal[:1000], 16),
        sample_time=2.5e-4,
        counts=2**17,
    )
    served = {"position": np.interp(short, followed.time, followed.measured)}
    excited = {"excitation.kind": "multisine", "excitation.amplitude": 1.0, "alpha0": 0.1}
    balanced = furuta.simulate(furuta.make_loop(excited), 10.0)
    for name in ("SERIES.csv", "SERIES.npz"):
        balanced.write(folder / name)
    series = balanced.series()
    arm, pendulum = series["measured_phi_rad"], series["measured_theta_rad"]
    driven = {"arm": arm, "pendulum": pendulum, "command": series["command_v"]}
    swing = np.exp(-0.1 * time) * np.cos(5.1 * time)
    for name, own, clock in (
        ("AXIS.csv", moved, time),
        ("GOAL.csv", {n: each[:1000] for n, each in moved.items()} | served, short),
        ("RIG.csv", driven | {"wrist": 2.0 * pendulum}, series["time_s"]),
        ("SWING.csv", {"arm": 0.0 * swing, "pendulum": swing, "wrist": swing**3}, time),
    ):
        Table({"time": clock, "time2": 2.0 * clock, **own}).write(folder / name)
    (folder / "PARAMETERS.yaml").write_text("/**: {ros__parameters: {zeta1: 0.8, alpha0: 0.3}}")
    return folder


@cache
def call(folder: Path, *arguments: str) -> tuple[int, str, str, dict[str, bytes]]:
    """Exit status, output, error, and files that were written, in a new folder of links."""
    own = folder.parent / f"run{len(list(folder.parent.iterdir()))}"
    own.mkdir()
    for each in folder.iterdir():
        (own / each.name).symlink_to(each)
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(own)
        patch.setattr(sys, "argv", ["furuta"])
        result = CliRunner().invoke(main, arguments, standalone_mode=False)
    error, status, why = result.exception, 0, result.stderr
    if isinstance(error, click.ClickException):
        status, why = error.exit_code, error.format_message()
    elif error is not None:
        assert isinstance(error, ParameterError | UserError | OSError), repr(error)
        status, why = 1, str(error)
        assert why
        assert "\n" not in why
    new = (path for path in own.rglob("*") if path.is_file() and not path.is_symlink())
    written = {path.name: path.read_bytes() for path in new}
    return status, re.sub(r"(wall_seconds\W+)[\d.e-]+", r"\g<1>0", result.stdout), why, written


pytestmark = pytest.mark.usefixtures("no_parts")
LASTING = [pytest.mark.long, pytest.mark.timeout(1800)]
CALLS = [
    pytest.param(name, base, marks=LASTING if bases is LONG else [])
    for bases in (BASES, LONG)
    for name, texts in bases.items()
    for base in texts
]


def test_every_command_is_here() -> None:
    assert all(name.startswith(ELSEWHERE) or name in BASES | LONG for name in COMMANDS)


def calls(name: str, base: str, *more: str) -> list[list[str]]:
    """A call of a command that prints JSON, if it can, and one that prints text."""
    given = [*name.split(), *base.split(), *more]
    return [[*given, "--json"], given] if "--json" in options(name) else [given]


@pytest.mark.parametrize(("name", "base"), CALLS)
def test_an_option_has_an_effect_or_is_refused(files: Path, name: str, base: str) -> None:
    """On the answer or on a file."""
    ignored = []
    for own, option in options(name).items():
        is_there = own in base.split() and not option.multiple
        if is_there or own in {*SLOW, *NO_EFFECT, "--json"} or isinstance(option.type, OutputFile):
            continue
        pairs = zip(calls(name, base), calls(name, base, *words(option)), strict=True)
        if all(call(files, *plain) == call(files, *changed) for plain, changed in pairs):
            ignored.append(own)
    assert call(files, *calls(name, base)[-1])[0] == 0
    assert not ignored


# How files begin, by their suffix.
BEGIN = {".png": b"\x89PNG", ".svg": b"<?xml", ".parquet": b"PAR1", ".npz": b"PK"}


@pytest.mark.parametrize(("name", "base"), [*CALLS, ("limit-cycle", NOTHING_TO_DRAW)])
def test_files_leave_the_answer_as_it_is(files: Path, name: str, base: str) -> None:
    """All together, with the last suffix of each or the first; also if one cannot be drawn."""
    base = base.replace(" --out RUNS.csv", "")
    for which, plain in enumerate(calls(name, base)):
        wanted: dict[str, str] = {}
        for own, option in options(name).items():
            if isinstance(option.type, OutputFile) and own not in base:
                suffix = option.type.suffixes[which - 1]
                more = [own, f"NEW{own}{suffix.upper()}"]
                assert call(files, *plain, own, "NEW.xyz")[0] == 2
                if call(files, *plain, *wanted, *more)[0] != 2:
                    wanted |= dict.fromkeys(more, suffix)
        status, out, why, written = call(files, *plain, *wanted)
        shown = parts(out)
        assert not [each for each in parts(call(files, *plain)[1]) if each not in shown], why
        assert status == (base == NOTHING_TO_DRAW), why
        for file in written.keys() & wanted.keys():
            assert written[file].startswith(BEGIN.get(wanted[file], b""))


def parts(out: str) -> list[str]:
    """Pairs of a JSON object, or lines; without those of the rows that a file may have."""
    pairs = map(str, json.loads(out).items()) if out.startswith("{") else out.splitlines()
    return [each for each in pairs if not re.search("file|rows|findings", each)]
