"""The documentation: generated pages are up to date, links lead somewhere, commands exist."""

from __future__ import annotations

import re
import shlex
from functools import cache
from pathlib import Path
from typing import Any

import click
import commands
import pages
import pytest
import reference_pages
from sources import ROOT

from furuta_bringup.main import furuta


@cache
def site_pages() -> dict[Path, str]:
    """The pages with the links of the site; a broken link raises an error."""
    return {file: pages.site_text(file, lambda target: target.name) for file in pages.page_names()}


@cache
def every_command() -> tuple[tuple[str, str], ...]:
    """Place and text of each command of each page."""
    return tuple(
        (f"{block.page}:{block.line}", commands.without_comment(command))
        for file in commands.page_files()
        for block in commands.blocks(file)
        for command in block.commands
    )


def test_page_of_topics_is_up_to_date() -> None:
    """Write it with ``docs/site/reference_pages.py output/reference``."""
    assert (ROOT / "docs" / "topics.md").read_text() == reference_pages.topics_page()


@pytest.mark.parametrize("page", reference_pages.PAGES)
def test_reference_pages_are_made(page: str) -> None:
    """The links of the generated pages lead somewhere."""
    text = reference_pages.PAGES[page]()
    assert pages.site_text(ROOT / "docs" / page, lambda target: target.name, text)


def test_every_page_is_listed_and_links_lead_somewhere() -> None:
    """docs/README.md lists every page; every relative link names a file."""
    assert set(site_pages()) >= set((ROOT / "docs").glob("*.md"))


def test_links_to_headings() -> None:
    """A link with an anchor names a heading of its page."""
    names = {f"{name}.md": file for file, name in pages.page_names().items()}
    for file, text in site_pages().items():
        for target, anchor in re.findall(r"\]\(([\w-]*(?:\.md)?)#([^)]+)\)", text):
            page = names[target] if target else file
            headings = re.findall(r"^#+ (.+)$", site_pages()[page], re.MULTILINE)
            assert anchor in {slug(each) for each in headings}, f"{file.name}: {target}#{anchor}"


def slug(heading: str) -> str:
    """The anchor that GitHub gives a heading."""
    kept = re.sub(r"[^\w\- ]", "", heading.lower().replace("`", ""))
    return kept.strip().replace(" ", "-")


def test_a_broken_link_is_found(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """The check of links can fail."""
    page = tmp_path / "page.md"
    page.write_text("[there](missing.md)")
    monkeypatch.setattr(pages, "ROOT", tmp_path)
    monkeypatch.setattr(pages, "page_names", dict)
    with pytest.raises(pages.BrokenLinkError, match=r"page\.md links to missing\.md"):
        pages.site_text(page, str)


def test_there_are_commands() -> None:
    """The parser of pages finds them, with those that a backslash continues."""
    assert len(every_command()) > 150
    joined = [text for _, text in every_command() if "shaped=omega1" in text]
    assert len(joined) == 1
    assert "--rigs 100" in joined[0]


@pytest.mark.parametrize(
    ("place", "text"), [each for each in every_command() if "./furuta" in each[1]], ids=str
)
def test_commands_exist(place: str, text: str) -> None:
    """Verb, options and values of each command are understood; nothing is run."""
    if commands.reason_not_to_run(text, ()) or place.startswith("docs/extending.md"):
        pytest.skip("not run from the page")
    check_arguments(arguments_of(text))


def arguments_of(text: str) -> list[str]:
    """The arguments of ``./furuta`` in a command line."""
    words = shlex.split(text.rstrip("& ").partition(" | ")[0])
    return words[words.index("./furuta") + 1 :] if "./furuta" in words else ["--help"]


def check_arguments(arguments: list[str]) -> None:
    """Parse as click does before it calls a verb."""
    command: click.Command = furuta
    context = click.Context(command, info_name="furuta")
    while isinstance(command, click.Group) and arguments and not arguments[0].startswith("-"):
        name, found, arguments = command.resolve_command(context, list(arguments))
        assert found is not None
        context = click.Context(found, parent=context, info_name=name)
        command = found
    try:
        command.make_context(context.info_name, list(arguments), parent=context.parent)
    except click.exceptions.Exit:  # --help
        return


@pytest.mark.parametrize(
    "arguments", [["simulte"], ["simulate", "--secnds", "3"], ["simulate", "--seconds", "x"]]
)
def test_an_unknown_command_is_found(arguments: list[str]) -> None:
    """The check of commands can fail."""
    with pytest.raises(click.UsageError):
        check_arguments(arguments)


def run_page(folder: Path, text: str, **options: Any) -> list[commands.Result]:
    """The results of the commands of a page."""
    page = folder / "page.md"
    page.write_text(text)
    reader = commands.Reader(folder, **options)
    results = [result for block in commands.blocks(page) for result in reader.read(block)]
    reader.end_background()
    return results


def test_commands_of_a_page_are_run(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """In order, with their notes; a failure is reported with its last line."""
    monkeypatch.setattr(commands, "ROOT", tmp_path)
    text = """# Page
    one line that is no block

<!-- before: echo first > file -->

    echo second >> file     # a remark
    cd . && cat file | grep second && cat \\
        missing

<!-- not run: too hard -->

    echo third >> file
    ros2 topic list
"""
    results = run_page(tmp_path, text, limit=10.0)
    assert [result.state for result in results] == ["ran", "ran", "FAILED", "not run", "not run"]
    assert (tmp_path / "file").read_text() == "first\nsecond\n"
    assert "No such file" in results[2].detail
    assert results[3].detail == "too hard"


def test_a_long_command_is_cut_short(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """It passes if it ends in order, and not with a traceback."""
    monkeypatch.setattr(commands, "ROOT", tmp_path)
    good = "trap 'exit 130' INT; while true; do sleep 0.05; done"
    bad = "trap 'echo Traceback; exit 1' INT; while true; do sleep 0.05; done"
    results = run_page(tmp_path, f"    echo; {good}\n\n    echo; {bad}\n", limit=3.0)
    assert [result.state for result in results] == ["cut short", "FAILED"]
    assert "traceback" in results[1].detail
