"""Makes the notebooks of the course from their Markdown sources, and runs the solutions.

A source holds the solution. Between ``# BEGIN SOLUTION`` and ``# END SOLUTION`` (in text between
``<!-- BEGIN SOLUTION -->`` and ``<!-- END SOLUTION -->``) stands what students find themselves.

    python course/notebooks.py write output/course    # exercises/ and solutions/, as .ipynb
    python course/notebooks.py check output/course    # run all solutions
    python course/notebooks.py sheet submissions      # which checks each notebook in it passes
"""

import argparse
import csv
import os
import re
import shutil
import sys
from pathlib import Path
from time import perf_counter
from typing import Any, NamedTuple

from furuta_bringup.page.one_file import one_file

COURSE = Path(__file__).resolve().parent
SOURCES = sorted(COURSE.glob("[1-9]_*.md"))
# Longest time of one cell [s].
CELL_TIMEOUT = 300

# The page of `furuta page`; beside the notebooks, because Jupyter serves only what is there.
PAGE, PAGE_LINK = "furuta.html", "../docs/view.md#without-ros"

_CODE = re.compile(r"^( *)# BEGIN SOLUTION\n.*?^ *# END SOLUTION\n", re.MULTILINE | re.DOTALL)
_TEXT = re.compile(r"<!-- BEGIN SOLUTION -->\n.*?<!-- END SOLUTION -->", re.DOTALL)
_MARKS = re.compile(r"^( *# (BEGIN|END) SOLUTION|<!-- (BEGIN|END) SOLUTION -->)\n", re.MULTILINE)
_CELL = re.compile(r"^```python\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def exercise(source: str) -> str:
    """The Markdown of a notebook without its solutions."""
    text = _CODE.sub(_your_code, source)
    return _TEXT.sub("*Your answer:*", text)


def _your_code(found: re.Match[str]) -> str:
    """Within a function, what its check needs is missing; elsewhere a name has no value yet."""
    return f"{found[1]}need(None)  # your code here\n" if found[1] else "# your code here\n"


def solution(source: str) -> str:
    """The Markdown of a notebook with its solutions, without their marks."""
    return _MARKS.sub("", source)


def code_cells(markdown: str) -> list[str]:
    """The code of a notebook, cell by cell."""
    return _CELL.findall(markdown)


def write(directory: Path) -> None:
    """Write exercises and solutions as notebooks; exercises that exist are left as they are."""
    for folder, version in (("exercises", exercise), ("solutions", solution)):
        _prepare(directory / folder)
        for source in SOURCES:
            path = directory / folder / f"{source.stem}.ipynb"
            if folder == "exercises" and path.exists():
                print(f"{path} exists and is left as it is")
                continue
            _save(_notebook(version(source.read_text(encoding="utf-8"))), path)
            print(path)


def check(directory: Path, names: list[str]) -> bool:
    """Run the solutions; returns whether all cells ran and all answers are right."""
    from nbclient.exceptions import CellExecutionError

    folder, failed = directory / "check", []
    _prepare(folder)
    for source in SOURCES:
        if names and source.stem not in names:
            continue
        notebook = _notebook(solution(source.read_text(encoding="utf-8")))
        began, fault = perf_counter(), ""
        try:
            _run(notebook, folder)
        except (CellExecutionError, TimeoutError) as error:
            failed.append(source.stem)
            fault = f"FAILED: {str(error).strip().splitlines()[-1]}"
        _save(notebook, folder / f"{source.stem}.ipynb")
        print(f"{source.stem:20} {perf_counter() - began:6.1f} s  {fault}", flush=True)
    return not failed


class Passed(NamedTuple):
    """What an exercise has shown: its checks that hold, and the hint of the first other one."""

    exercise: str
    right: list[str]
    hint: str


def passed(notebook: Any) -> list[Passed]:
    """The checks of each exercise, from the printed output of a notebook that has run."""
    found: list[Passed] = []
    for cell in notebook.cells:
        if title := re.search(r"^### (Exercise \d+.*)$", cell.source, re.MULTILINE):
            found.append(Passed(title[1], [], ""))
        if cell.cell_type != "code" or not found:
            continue
        last = found[-1]
        printed = "\n".join(map(_text, cell.outputs))
        last.right.extend(re.findall(r"^Right: (.*)\.$", printed, re.MULTILINE))
        if hints := re.findall(r"^Not yet: (.*)$", printed, re.MULTILINE):
            found[-1] = last._replace(hint=last.hint or hints[0])
    return found


def _text(output: Any) -> str:
    """What an output of a cell says; of an error its last line."""
    return str(output.get("text", "") or "\n".join(output.get("traceback", [])))


def sheet(directory: Path) -> None:
    """Run each notebook below ``directory``, and write ``sheet.csv`` there: a line an exercise.

    The notebooks are programs of others: run them where that does no harm.
    """
    import nbformat

    rows = [("notebook", "exercise", "right", "checks", "not yet")]
    for file in sorted(directory.rglob("*.ipynb")):
        if ".ipynb_checkpoints" in file.parts:
            continue
        name = file.relative_to(directory).as_posix()
        _prepare(file.parent)
        notebook = nbformat.read(file, as_version=4)
        _run(notebook, file.parent, allow_errors=True)
        for each in passed(notebook):
            checks = "; ".join(each.right)
            rows.append((name, each.exercise, str(len(each.right)), checks, each.hint))
            print(f"{name}  {each.exercise}: {len(each.right)} right  {each.hint}", flush=True)
    with (directory / "sheet.csv").open("w", encoding="utf-8", newline="") as out:
        csv.writer(out).writerows(rows)


def _run(notebook: Any, folder: Path, allow_errors: bool = False) -> None:
    """Run all cells of a notebook in a folder."""
    from nbclient import NotebookClient

    os.environ.pop("MPLBACKEND", None)  # pictures go into the notebook
    NotebookClient(
        notebook,
        timeout=CELL_TIMEOUT,
        startup_timeout=CELL_TIMEOUT,
        allow_errors=allow_errors,
        extra_arguments=["--log-level=ERROR"],
        resources={"metadata": {"path": str(folder)}},
    ).execute()


def _prepare(folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    shutil.copy(COURSE / "lab.py", folder)
    (folder / PAGE).write_bytes(one_file())


def _notebook(markdown: str) -> Any:
    import jupytext
    import nbformat

    notebook = jupytext.reads(markdown.replace(PAGE_LINK, PAGE), fmt="md")
    kernel = {"display_name": "Python 3", "language": "python", "name": "python3"}
    notebook.metadata = nbformat.from_dict({"kernelspec": kernel})
    return notebook


def _save(notebook: Any, path: Path) -> None:
    import nbformat

    nbformat.write(notebook, path)


def main() -> None:
    """Entry point."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("do", choices=["write", "check", "sheet"])
    parser.add_argument("directory", type=Path)
    parser.add_argument("names", nargs="*", help="check only these, such as 1_model")
    options = parser.parse_args()
    if options.do == "write":
        write(options.directory)
    elif options.do == "sheet":
        sheet(options.directory)
    elif not check(options.directory, options.names):
        sys.exit(1)


if __name__ == "__main__":
    main()
