"""The documentation: generated pages are up to date, links lead somewhere, commands exist."""

import re
import shlex
from functools import cache
from pathlib import Path

import click
import commands
import pages
import pytest
import reference_pages
from sources import ROOT

from furuta_bringup.main import furuta
from furuta_graph.settings.nodes import NODES

PACKAGES = [file.parent for file in (ROOT / "furuta_ws" / "src").glob("*/package.xml")]


@cache
def site_pages() -> dict[Path, str]:
    """The pages and those of the packages, as on the site; a broken link raises an error."""
    files = [*pages.page_names(), *(package / "README.md" for package in PACKAGES)]
    return {file: pages.site_text(file, lambda target: target.name) for file in files}


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


@pytest.mark.parametrize("package", PACKAGES, ids=lambda package: package.name)
def test_package_page_names_what_is_there(package: Path) -> None:
    """Files and folders of the package, its executables, and how to list its nodes' parameters."""
    page = (package / "README.md").read_text()
    for name in re.findall(r"`([\w/]+(?:\.py|\.yaml|/))`", page):
        assert any((folder / name).exists() for folder in (package, package / package.name)), name
    for executable in re.findall(r"^    (\w+) = furuta", (package / "setup.cfg").read_text(), re.M):
        assert f"`{executable}`" in page
        if executable in NODES:
            assert f"./furuta param defaults {executable}" in page


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
