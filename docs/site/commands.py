"""Runs every command of every page, in order, in a fresh clone.

``make docs CHECK=1`` calls it. It clones the repository, runs the commands as a reader would type
them, and writes a table with the result of each. A page marks what is peculiar in comments:

    <!-- not run: REASON -->      the next block is not run
    <!-- page not run: REASON --> nothing of the page is run
    <!-- file: NAME -->           the block of code titled NAME is written before the next block
    <!-- before: COMMAND -->      a command that the next block needs and a reader has done

A command that needs no end, such as ``./furuta run``, is interrupted after a while, and so is one
that takes longer than the limit. What runs in the background ends with its section.
"""

import argparse
import os
import re
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[2]
# First words of a block of shell commands; other indented blocks are equations and output.
SHELL = re.compile(
    r"(?:(?:\./)?furuta|install/|make|mkdir|tools/in_environment|\.\./tools|ros2|colcon|rosdep|cd|pip"
    r"|source|echo)\b|[A-Z_]+=\S+ |keys="
)
NOTE = re.compile(r"<!-- (page not run|not run|file|before): (.*?) -->")
# What no fresh clone on this machine can run, by a part of the command.
NOT_RUN = {
    r"^make (test|bench|soak|docs)|pytest|colcon test": "tests, which run by themselves",
    r"^(make course|jupyter lab)$": "opens JupyterLab; make course CHECK=1 runs the notebooks",
    r"pictures\.py": "changes the pages' pictures, for some minutes",
    r"(standard_errors|late_rigs)\.py": "takes minutes to hours",
    r"\b(ros2|colcon|rosdep)\b": "needs ROS 2 installed",
    r"/dev/tty|--port P\b": "needs a rig",
    r"\b(log|step|sine|swing)\.csv": "needs a recording of another rig",
    r"\bmine\.yaml\b": "needs a file of a rig of one's own",
    r"broken_bag": "needs a damaged bag",
    r"robot\.bag": "needs a bag of ROS 1",
    r"tcp://": "needs a cluster",
    r"^pip install": "tests/workspace/test_wheel.py installs the wheel",
}
# Ends with Ctrl-C only.
ENDLESS = re.compile(r"\./furuta (run(?!.*--seconds)|view)|_node\.py|hw emulate")
# Time until an endless command is interrupted [s]. It includes the start.
SHOWN = 25.0
# Time that a reader leaves what runs in the background to start [s].
SETTLED = 10.0
# Time in which what runs in the background must let a command succeed [s].
READY = 90.0
# Statuses of an interrupted command: ended in order, or before it was ready; that of make.
INTERRUPTED = (0, 130)
INTERRUPTED_MAKE = 2


class Block(NamedTuple):
    """Commands that stand together on a page, and the notes before them."""

    page: str
    line: int
    heading: str
    commands: tuple[str, ...]
    notes: tuple[tuple[str, str], ...]


class Result(NamedTuple):
    """What became of a command: ran, interrupted, cut short, not run, or FAILED."""

    block: Block
    command: str
    state: str
    detail: str
    seconds: float


def page_files() -> list[Path]:
    """The files of all pages: the front page first, then in the order of the site."""
    front, contents = ROOT / "README.md", ROOT / "docs" / "README.md"
    links = re.findall(r"^- \[.*?\]\((.*?)\)", contents.read_text(), re.MULTILINE)
    files = [(contents.parent / link).resolve() for link in links]
    return [front, *(file for file in files if file != front)]


def blocks(file: Path) -> Iterator[Block]:
    """The blocks of shell commands of a page."""
    page, heading = file.relative_to(ROOT).as_posix(), ""
    notes: list[tuple[str, str]] = []
    lines = file.read_text().splitlines()
    number = 0
    while number < len(lines):
        line = lines[number]
        start = number
        number += 1
        if line.startswith("```"):
            while number < len(lines) and not lines[number].startswith("```"):
                number += 1
            body = [f"    {line}" for line in lines[start + 1 : number]]
            number += 1
            if line.strip() != "```sh":
                continue
        elif line.startswith("    ") and (start == 0 or not lines[start - 1].strip()):
            while number < len(lines) and lines[number].startswith("    "):
                number += 1
            body = lines[start:number]
        else:
            heading = line.lstrip("# ") if line.startswith("#") else heading
            notes += NOTE.findall(line)
            continue
        if SHELL.match(body[0].strip()):
            yield Block(page, start + 1, heading, tuple(_commands(body)), tuple(notes))
            notes = [note for note in notes if note[0] == "page not run"]


def _commands(lines: list[str]) -> Iterator[str]:
    """Commands of a block: lines, with those that a backslash continues."""
    command = ""
    for line in lines:
        text = line.strip()
        command = f"{command} {text}".strip()
        if command.endswith("\\"):
            command = command[:-1].rstrip()
            continue
        if command:
            yield command
        command = ""


def without_comment(command: str) -> str:
    """A command without the remark at its end."""
    return re.split(r"\s+#(?=\s|$)", command)[0].rstrip()


def titled_code(name: str) -> str:
    """The code with this title on any page."""
    for file in page_files():
        match = re.search(
            rf"^```\w+ title={re.escape(name)}\n(.*?)^```",
            file.read_text(),
            re.DOTALL | re.MULTILINE,
        )
        if match:
            return match[1]
    raise ValueError(f"no page has a block of code titled {name}")


def reason_not_to_run(command: str, notes: tuple[tuple[str, str], ...]) -> str:
    """Why a command is not run; empty if it is."""
    for kind, text in notes:
        if kind in ("not run", "page not run"):
            return text
    command = without_comment(command)
    return next((why for part, why in NOT_RUN.items() if re.search(part, command)), "")


class Reader:
    """Types the commands of the pages into a shell in ``folder``."""

    def __init__(self, folder: Path, limit: float) -> None:
        self._folder = folder
        self._limit = limit
        self._background: list[subprocess.Popen[str]] = []
        self._place = ("", "")

    def read(self, block: Block) -> Iterator[Result]:
        """Run the commands of a block."""
        if (block.page, block.heading) != self._place:
            self.end_background()
            self._place = (block.page, block.heading)
        skipped = all(reason_not_to_run(command, block.notes) for command in block.commands)
        for kind, text in block.notes if not skipped else ():
            if kind == "file":
                (self._folder / text).write_text(titled_code(text))
            elif kind == "before":
                yield self._run(block, text)
        for command in block.commands:
            reason = reason_not_to_run(command, block.notes)
            if reason or _needs_ros(block):
                yield Result(block, command, "not run", reason or "needs ROS 2 installed", 0.0)
            else:
                yield self._run(block, without_comment(command))

    def end_background(self) -> None:
        """Interrupt what still runs in the background."""
        for process in self._background:
            _interrupt(process)
        self._background = []

    def _run(self, block: Block, command: str) -> Result:
        start = time.monotonic()
        if command.endswith("&"):
            self._background.append(self._start(command.rstrip("& "), subprocess.DEVNULL))
            time.sleep(SETTLED)
            return Result(block, command, "ran", "in the background", 0.0)
        while True:
            state, detail = self._once(command)
            seconds = time.monotonic() - start
            waiting = any(process.poll() is None for process in self._background)
            if state != "FAILED" or not waiting or seconds > READY:
                return Result(block, command, state, detail, seconds)

    def _once(self, command: str) -> tuple[str, str]:
        process = self._start(command)
        endless = ENDLESS.search(command)
        try:
            output, _ = process.communicate(timeout=SHOWN if endless else self._limit)
        except subprocess.TimeoutExpired:
            output = _interrupt(process)
            state = "interrupted" if endless else "cut short"
            made = command.startswith("make") and process.returncode == INTERRUPTED_MAKE
            good = made or process.returncode in INTERRUPTED
        else:
            state, good = "ran", process.returncode == 0
        last = (output.strip().splitlines() or [""])[-1]
        detail = last if not good else ""
        if "Traceback" in output:
            good, detail = False, f"traceback: {last}"
        return (state, detail) if good else ("FAILED", f"{process.returncode}: {detail}")

    def _start(self, command: str, output: int = subprocess.PIPE) -> subprocess.Popen[str]:
        # A shell cannot trap a signal that was ignored when it started, as after nohup.
        return subprocess.Popen(
            ["env", "--default-signal=INT", "bash", "-c", f"set -o pipefail; {command}"],
            cwd=self._folder,
            stdin=subprocess.DEVNULL,
            stdout=output,
            stderr=subprocess.STDOUT,
            text=True,
            start_new_session=True,
            env=os.environ | {"BROWSER": "true"},
        )


def _needs_ros(block: Block) -> bool:
    return any(re.search(r"^(ros2|colcon|rosdep)\b", command) for command in block.commands)


def _interrupt(process: subprocess.Popen[str]) -> str:
    """Ctrl-C for a command and its children; return its output."""
    if process.poll() is None:
        os.killpg(process.pid, signal.SIGINT)
    try:
        output, _ = process.communicate(timeout=30.0)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        output, _ = process.communicate()
    return output or ""


def run_all(folder: Path, limit: float, only: list[str]) -> list[Result]:
    """Run the commands of all pages, or of those named, and print each result."""
    reader, results = Reader(folder, limit), []
    try:
        for file in page_files():
            if only and file.relative_to(ROOT).as_posix() not in only:
                continue
            for block in blocks(file):
                for result in reader.read(block):
                    results.append(result)
                    print(_row(result), flush=True)
    finally:
        reader.end_background()
    return results


def _row(result: Result) -> str:
    block = result.block
    command = result.command.replace("|", "\\|")
    return (
        f"| {block.page}:{block.line} | `{command}` | {result.state} | {result.seconds:.0f} "
        f"| {result.detail} |"
    )


def report(results: list[Result]) -> str:
    """The number of commands by state, and the table."""
    states = Counter(result.state for result in results)
    counts = ", ".join(f"{number} {state}" for state, number in states.items())
    head = [f"{len(results)} commands: {counts}", "", "| page | command | result | s | |"]
    return "\n".join([*head, "|---|---|---|---|---|", *map(_row, results)]) + "\n"


def main() -> int:
    """Clone, run, report; return the exit status."""
    parser = argparse.ArgumentParser(description="Run every command of every page in a clone.")
    parser.add_argument("--out", type=Path, help="file for the table")
    parser.add_argument("--limit", type=float, default=180.0, help="longest time of a command [s]")
    parser.add_argument("--page", action="append", default=[], help="only this page; repeatable")
    parser.add_argument("--list", action="store_true", help="only list the commands")
    given = parser.parse_args()
    if given.list:
        for file in page_files():
            for block in blocks(file):
                for command in block.commands:
                    print(f"{block.page}:{block.line}: {command}")
        return 0
    with tempfile.TemporaryDirectory(prefix="furuta_docs_") as folder:
        clone = Path(folder) / "furuta_ws"
        subprocess.run(["git", "clone", "--quiet", str(ROOT), str(clone)], check=True)
        # The first command makes the environment, which takes longer than the limit.
        subprocess.run([clone / "furuta", "--version"], check=True)
        results = run_all(clone, given.limit, given.page)
    text = report(results)
    print(text.splitlines()[0])
    if given.out:
        given.out.parent.mkdir(parents=True, exist_ok=True)
        given.out.write_text(text)
    return any(result.state == "FAILED" for result in results)


if __name__ == "__main__":
    sys.exit(main())
