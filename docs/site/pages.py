"""The pages of the site: which files they come from, and their text with the links of the site.

``docs/README.md`` lists the pages by section. On GitHub it is the table of contents of the folder,
here it is the first page, and its lists become the navigation.
"""

import os
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[2]
START = ROOT / "docs" / "README.md"
# Pages that reference_pages.py generates from the code: name in the site, and title.
REFERENCE = {
    "verbs": "Verbs",
    "parameters": "Parameters",
    "rig-files": "Rig files",
    "library-reference": "Library, name by name",
}
# A page that exists only where the lab course does.
COURSE = ROOT / "course" / "README.md"
COURSE_ITEM = "- [Lab course](../course/README.md): seven notebooks with exercises and solutions."
COURSE_SECTION = "Tutorial"

LINK = re.compile(r"(!?)\[([^\]]*)\]\(([^)\s]+)\)")
ITEM = re.compile(r"- \[([^\]]*)\]\(([^)\s]+)\)")
MERMAID_EDGE = re.compile(r"(\w+)(?:\[[^\]]*\])?\s*(?:--|-\.)\s*(.*?)\s*(?:-->|\.->)\s*(\w+)")
MERMAID_LINE = re.compile(r"(\w+)\s*---\s*(\w+)")


class BrokenLinkError(Exception):
    """A page links to a file that does not exist."""


class Section(NamedTuple):
    """A part of the site with its pages, in order, and their titles in the navigation."""

    title: str
    files: tuple[Path, ...]
    titles: tuple[str, ...]


def contents() -> str:
    """``docs/README.md``, with the lab course if there is one."""
    text = START.read_text()
    if not COURSE.exists() or "course/README.md" in text:
        return text
    head, title, rest = text.partition(f"## {COURSE_SECTION}\n")
    items, _, after = rest.partition("\n\n## ")
    return f"{head}{title}{items}\n{COURSE_ITEM}\n\n## {after}"


def sections() -> list[Section]:
    """The sections of ``docs/README.md`` with the files that their lists name."""
    parts = re.split(r"^## (.+)$", contents(), flags=re.MULTILINE)[1:]
    return [
        Section(
            title,
            tuple((START.parent / link).resolve() for _, link in ITEM.findall(text)),
            tuple(name for name, _ in ITEM.findall(text)),
        )
        for title, text in zip(parts[::2], parts[1::2], strict=True)
    ]


def page_names() -> dict[Path, str]:
    """Name in the site, without suffix, by file: ``overview`` for the README, and so on."""
    names = {START: "index"}
    for section in sections():
        for file in section.files:
            folder = file.parent.relative_to(ROOT)
            own = file.stem.lower()
            if file.name == "README.md":
                own = "overview" if file.parent == ROOT else folder.name
            names[file] = own
    return names


def site_text(file: Path, take: Callable[[Path], str], text: str = "") -> str:
    """The text of a page with the links of the site; ``text`` if the page is not a file.

    ``take`` receives each file that is linked and is no page; it returns its address in the site.

    Raises:
        BrokenLinkError: A link leads to no file.
    """
    names = page_names()
    text = text or (contents() if file == START else file.read_text())
    lines = [
        line if in_code else LINK.sub(lambda match: _site_link(match, file, names, take), line)
        for line, in_code in _lines(text)
    ]
    page = _without_mermaid("\n".join(lines)) + "\n"
    return page + _navigation(names) if file == START else page


def _lines(text: str) -> Iterator[tuple[str, bool]]:
    """Lines, each with whether it is code."""
    fenced = False
    for line in text.splitlines():
        fence = line.startswith("```")
        fenced ^= fence
        yield line, fenced or fence or line.startswith("    ")


def _site_link(
    match: re.Match[str], file: Path, names: dict[Path, str], take: Callable[[Path], str]
) -> str:
    picture, text, link = match.groups()
    address, _, anchor = link.partition("#")
    if "://" in link or not address:
        return match.group()
    target = Path(os.path.normpath(file.parent / address))
    is_source = target.suffix == ".md" and target not in names
    if target.is_dir() or (is_source and target.exists()):
        return f"{text} (`{target.relative_to(ROOT)}`)"
    if not target.exists():
        raise BrokenLinkError(f"{file.relative_to(ROOT)} links to {link}, which does not exist")
    place = f"{names[target]}.md" if target in names else take(target)
    return f"{picture}[{text}]({place}{'#' if anchor else ''}{anchor})"


def _navigation(names: dict[Path, str]) -> str:
    """The lists of the first page once more, as the navigation of the site."""
    parts = []
    for section in sections():
        entries = [
            (names[file], title) for file, title in zip(section.files, section.titles, strict=True)
        ]
        if section.title == "Reference":
            entries += REFERENCE.items()
        lines = "\n".join(f"{title} <{name}>" for name, title in entries)
        parts.append(f"\n```{{toctree}}\n:hidden:\n:caption: {section.title}\n\n{lines}\n```\n")
    return "".join(parts)


def _without_mermaid(text: str) -> str:
    """Diagrams as lists of their arrows: drawing them would need a program from elsewhere."""
    return re.sub(r"```mermaid\n(.*?)```", _arrows, text, flags=re.DOTALL)


def _arrows(match: re.Match[str]) -> str:
    rows = []
    for line in match.group(1).splitlines():
        if edge := MERMAID_EDGE.search(line):
            start, label, end = edge.groups()
            rows.append((start, f"{label.strip(chr(34))} →", end))
        elif joined := MERMAID_LINE.search(line):
            rows.append((joined[1], "—", joined[2]))
    widths = [max(len(row[k]) for row in rows) for k in range(2)]
    text = "\n".join(f"{a:{widths[0]}}  {b:>{widths[1]}}  {c}" for a, b, c in rows)
    return f"```text\n{text}\n```"
