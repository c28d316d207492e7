"""Makes the notebooks of the course from their Markdown sources, and runs the solutions.

A source holds the solution. Between ``# BEGIN SOLUTION`` and ``# END SOLUTION`` (in text between
``<!-- BEGIN SOLUTION -->`` and ``<!-- END SOLUTION -->``) stands what students find themselves.

    python course/notebooks.py write output/course    # exercises/ and solutions/, as .ipynb
    python course/notebooks.py check output/course    # run all solutions
"""

import argparse
import os
import re
import shutil
import sys
from pathlib import Path
from time import perf_counter
from typing import Any

COURSE = Path(__file__).resolve().parent
SOURCES = sorted(COURSE.glob("[1-9]_*.md"))
# Longest time of one cell [s].
CELL_TIMEOUT = 300

_CODE = re.compile(r"^( *)# BEGIN SOLUTION\n.*?^ *# END SOLUTION\n", re.MULTILINE | re.DOTALL)
_TEXT = re.compile(r"<!-- BEGIN SOLUTION -->\n.*?<!-- END SOLUTION -->", re.DOTALL)
_MARKS = re.compile(r"^( *# (BEGIN|END) SOLUTION|<!-- (BEGIN|END) SOLUTION -->)\n", re.MULTILINE)
_CELL = re.compile(r"^```python\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def exercise(source: str) -> str:
    """The Markdown of a notebook without its solutions."""
    text = _CODE.sub(r'\1raise NotImplementedError("your code here")' + "\n", source)
    return _TEXT.sub("*Your answer:*", text)


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
    from nbclient import NotebookClient
    from nbclient.exceptions import CellExecutionError

    os.environ.pop("MPLBACKEND", None)  # pictures go into the notebook
    folder, failed = directory / "check", []
    _prepare(folder)
    for source in SOURCES:
        if names and source.stem not in names:
            continue
        notebook = _notebook(solution(source.read_text(encoding="utf-8")))
        began, fault = perf_counter(), ""
        client = NotebookClient(
            notebook,
            timeout=CELL_TIMEOUT,
            startup_timeout=CELL_TIMEOUT,
            extra_arguments=["--log-level=ERROR"],
            resources={"metadata": {"path": str(folder)}},
        )
        try:
            client.execute()
        except (CellExecutionError, TimeoutError) as error:
            failed.append(source.stem)
            fault = f"FAILED: {str(error).strip().splitlines()[-1]}"
        _save(notebook, folder / f"{source.stem}.ipynb")
        print(f"{source.stem:20} {perf_counter() - began:6.1f} s  {fault}", flush=True)
    return not failed


def _prepare(folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    shutil.copy(COURSE / "lab.py", folder)


def _notebook(markdown: str) -> Any:
    import jupytext
    import nbformat

    notebook = jupytext.reads(markdown, fmt="md")
    kernel = {"display_name": "Python 3", "language": "python", "name": "python3"}
    notebook.metadata = nbformat.from_dict({"kernelspec": kernel})
    return notebook


def _save(notebook: Any, path: Path) -> None:
    import nbformat

    nbformat.write(notebook, path)


def main() -> None:
    """Entry point."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("do", choices=["write", "check"])
    parser.add_argument("directory", type=Path)
    parser.add_argument("names", nargs="*", help="check only these, such as 1_model")
    options = parser.parse_args()
    if options.do == "write":
        write(options.directory)
    elif not check(options.directory, options.names):
        sys.exit(1)


if __name__ == "__main__":
    main()
