"""Runs verbs of the command line one after the other, with little memory, and reports on each.

A program of its own, ``python limited_verbs.py CALLS.json``: the limits hold for its process.
"""

import contextlib
import io
import json
import resource
import sys
import traceback
from pathlib import Path
from time import perf_counter
from typing import Any

from furuta_bringup.main import main as furuta

# Memory beyond what Python and the libraries take [bytes], and largest file that may be written.
MEMORY = 2**30
LARGEST_FILE = 2**31 - 1
_PAGE = resource.getpagesize()


def main() -> None:
    """Run the calls of a file; print a report for each."""
    calls = json.loads(Path(sys.argv[1]).read_text())
    opened: list[str] = []
    sys.addaudithook(lambda event, about: opened.append(str(about[0])) if event in _OPEN else None)
    reports = []
    for number, arguments in enumerate(calls):
        if number == 1:  # the first call loads the libraries
            _limit()
        opened.clear()
        reports.append(_run(arguments) | {"opened": list(opened)})
    print(json.dumps(reports))


_OPEN = ("open", "sqlite3.connect", "os.system", "os.rename", "os.mkdir")


def _limit() -> None:
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    resource.setrlimit(resource.RLIMIT_AS, (pages * _PAGE + MEMORY,) * 2)
    resource.setrlimit(resource.RLIMIT_FSIZE, (LARGEST_FILE,) * 2)


def _run(arguments: list[str]) -> dict[str, Any]:
    sys.argv = ["furuta", *arguments]
    out, err, status, began = io.StringIO(), io.StringIO(), 0, perf_counter()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            furuta()
        except SystemExit as ended:
            status = int(ended.code or 0)
        except BaseException:
            traceback.print_exc()
            status = -1
    return {"status": status, "err": err.getvalue(), "seconds": perf_counter() - began}


if __name__ == "__main__":
    main()
