"""The documentation: the page of topics is up to date, links lead somewhere, commands exist."""

import os
import re
import shlex
from functools import cache
from pathlib import Path

import click
import commands
import links
import pytest
from sources import ROOT

from furuta_bringup.main import furuta
from furuta_recordings.series_columns import COLUMNS
from furuta_ros.topics import ACTIVE_MODE, ARMED, CLOCK, DIAGNOSTICS, INITIAL_STATE, TIMING, TOPICS

PACKAGES = [file.parent for file in (ROOT / "furuta_ws" / "src").glob("*/package.xml")]
CONTENTS = ROOT / "docs" / "README.md"
PAGES = [CONTENTS, *commands.page_files(), *(package / "README.md" for package in PACKAGES)]


@cache
def every_command() -> tuple[tuple[str, str], ...]:
    """Place and text of each command of each page."""
    return tuple(
        (f"{block.page}:{block.line}", commands.without_comment(command))
        for file in commands.page_files()
        for block in commands.blocks(file)
        for command in block.commands
    )


def test_page_of_topics_lists_every_topic_and_column() -> None:
    """As they are declared, in this order."""
    page = (ROOT / "docs" / "topics.md").read_text().partition("\n## Record")[0]
    columns = [f"| `{name}` | {about.meaning} [{about.unit}] |" for name, about in COLUMNS.items()]
    rows = re.findall(r"^\| `.*$", page, re.MULTILINE)
    topics, described = rows[: -len(columns)], rows[-len(columns) :]
    assert described == columns
    assert [row.split(" | ")[:2] for row in topics] == [
        [f"| `{topic.name}`", topic.type.replace("/msg/", "/")]
        for topic in (*TOPICS, ACTIVE_MODE, ARMED, INITIAL_STATE, CLOCK, TIMING, DIAGNOSTICS)
    ]


def test_every_page_is_listed() -> None:
    assert set(PAGES) >= set((ROOT / "docs").rglob("*.md"))


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_links_lead_somewhere(page: Path) -> None:
    """Each relative link names a file, and its anchor a heading there."""
    text = re.sub(r"^```.*?^```|^    .*?$", "", page.read_text(), flags=re.DOTALL | re.MULTILINE)
    for address, anchor in re.findall(r"\]\(([^)#]*)#?([^)]*)\)", text):
        target = page.parent / address if address else page
        beside = Path(os.path.normpath(target))
        assert beside == beside.resolve() or "://" in address, f"{address}: a symbolic link"
        assert "://" in address or target.exists(), address
        if anchor:
            headings = re.findall(r"^#+ (.+)$", target.read_text(), re.MULTILINE)
            assert anchor in {slug(each) for each in headings}, f"{address}#{anchor}"


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_tables_swallow_no_paragraph(page: Path) -> None:
    """A blank line follows each table; without it the next line becomes a row."""
    text = re.sub(r"^```.*?^```", "", page.read_text(), flags=re.DOTALL | re.MULTILINE)
    assert re.findall(r"^\|.*\n([^|\n].*)$", text, re.MULTILINE) == []


def test_broken_links_of_the_site_are_found(tmp_path: Path) -> None:
    """No file, no such place in it; what another host has is not asked for."""
    (tmp_path / "a.html").write_text(
        '<p id="here"><a href="#here"><a href="b.html#there"><img src="c.png">'
        '<a href="https://example.org/"><img src="data:,">'
    )
    (tmp_path / "b.html").write_text('<a href="a.html#here"><a href="a.html?x#no">')
    assert links.broken(tmp_path) == [
        "a.html: b.html#there",
        "a.html: c.png",
        "b.html: a.html?x#no",
    ]


def slug(heading: str) -> str:
    """The anchor that GitHub gives a heading."""
    kept = re.sub(r"[^\w\- ]", "", heading.lower().replace("`", ""))
    return kept.strip().replace(" ", "-")


def test_commands_exist(monkeypatch: pytest.MonkeyPatch, no_parts: None) -> None:
    """Verb, options and values of each command are understood; nothing is run."""
    monkeypatch.chdir(ROOT)  # where the parts of one's own are
    wrong = []
    for place, text in every_command():
        if commands.reason_not_to_run(text, ()) or place.startswith("docs/extending.md"):
            continue
        try:
            check_arguments(arguments_of(text))
        except click.UsageError as error:
            wrong.append(f"{place}: {text}: {error.format_message()}")
    assert not wrong, "\n".join(wrong)


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
