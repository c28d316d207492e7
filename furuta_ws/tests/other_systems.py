"""Runs verbs in this process as on Windows (win32) or macOS (darwin), as far as Linux can show it.

What the standard library has on Linux alone is taken away; typeshed says what that is. A text
file is opened only with its encoding. What other packages do there stays untried.
Usage: python other_systems.py PLATFORM ROS VERBS, where ROS says whether ROS is installed (with,
without) and VERBS is JSON, a list of lists of arguments.
"""

import ast
import ctypes
import importlib
import json
import multiprocessing
import sys
import tempfile
import warnings
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from sources import PACKAGES, imports, modules

ROS = ("rclpy", "rcl_interfaces", "sensor_msgs", "std_msgs", "std_srvs", "lifecycle_msgs")
# What uses names of Linux itself on Linux.
OTHERS = ("numba", "scipy.optimize", "matplotlib.pyplot", "rosbags.rosbag2", "mcap.writer", "rich")
OTHERS += ("control", "serial", "concurrent.futures.process", "multiprocessing.popen_spawn_posix")


def run(platform: str, ros: str, verbs: list[list[str]]) -> None:
    """Print for each verb a line of JSON: its exit status, and an unexpected exception."""
    for name in OTHERS:
        importlib.import_module(name)
    take_away(platform)
    for name in ROS if ros == "without" else ():
        sys.modules[name] = None  # type: ignore[assignment]
    warnings.filterwarnings("error", category=EncodingWarning, module="furuta")
    main = importlib.import_module("furuta_bringup.main")
    for arguments in verbs:
        sys.argv = ["furuta", *arguments]
        status: Any = None
        try:
            main.main()
        except SystemExit as ended:
            status = ended.code
        except BaseException as error:
            status = f"{type(error).__name__}: {error}"
        print(json.dumps([" ".join(arguments), status]), file=sys.stderr, flush=True)


def take_away(platform: str) -> None:
    """Leave what the standard library has on a platform, of the modules that our sources import."""
    imported = {name for each in PACKAGES for file in modules(each) for name in imports(file)}
    for name in imported & sys.stdlib_module_names:
        there, here = stub_names(name, platform), stub_names(name, "linux")
        if here and not there:
            sys.modules[name] = None  # type: ignore[assignment]
            continue
        module = importlib.import_module(name)
        for each in here - there:
            if hasattr(module, each):
                delattr(module, each)
    importlib.reload(tempfile)  # it looks at its import for what there is
    multiprocessing.set_start_method("spawn")
    if platform == "win32":
        whole = ctypes.CDLL.__init__
        ctypes.CDLL.__init__ = lambda self, name, *more: whole(self, name + "", *more)


def stub_names(module: str, platform: str) -> set[str]:
    """What typeshed declares in a module for a platform."""
    stubs = Path(importlib.import_module("mypy").__path__[0], "typeshed", "stdlib")
    path = stubs.joinpath(*module.split("."))
    file = path / "__init__.pyi" if path.is_dir() else path.with_suffix(".pyi")
    return set(_declared(ast.parse(file.read_text(encoding="utf-8")).body, platform))


def _declared(body: list[ast.stmt], platform: str) -> Iterator[str]:
    about = SimpleNamespace(platform=platform, version_info=sys.version_info)
    for node in body:
        if isinstance(node, ast.If):
            true = eval(compile(ast.Expression(node.test), "typeshed", "eval"), {"sys": about})
            yield from _declared(node.body if true else node.orelse, platform)
        elif isinstance(node, ast.ImportFrom) and node.module in ("_socket", "_ctypes"):
            yield from (each.asname or each.name for each in node.names)
        elif isinstance(node, (ast.FunctionDef, ast.ClassDef)):
            yield node.name
        elif isinstance(node, (ast.Assign, ast.AnnAssign)):
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            yield from (each.id for each in targets if isinstance(each, ast.Name))


if __name__ == "__main__":
    run(sys.argv[1], sys.argv[2], json.loads(sys.argv[3]))
