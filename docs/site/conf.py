"""Settings of Sphinx for the documentation site. Its source folder is the repository."""

import base64
import mimetypes
import os
import re
import sys
from pathlib import Path
from typing import Any, get_type_hints

ROOT = Path(__file__).resolve().parents[2]
# What the environment of the site lacks, such as numpy, comes from that of the product.
sys.path += map(str, Path(os.environ["VIRTUAL_ENV"]).glob("lib/python*/site-packages"))
sys.path.append(str(Path(__file__).parent))

from declared_tables import examples, keys_of_rig_files, library_row, parameters_of_nodes, table  # noqa: E402

import furuta  # noqa: E402
from furuta_bringup import main  # noqa: E402
from furuta_model.parameters import About, group_fields  # noqa: E402

project = "furuta_ws"
author = "The furuta_ws developers"
project_copyright = author

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinx_click"]
root_doc = "docs/README"
include_patterns = [
    "*.md",
    "course/README.md",
    "examples/sticking/README.md",
    "docs/*.md",
    "docs/reference/*.md",
]
exclude_patterns = [".*", "output", "furuta_ws"]
# Links to headings work as on GitHub; a link without a target is a warning, and so an error.
myst_heading_anchors = 4
autodoc_typehints_format = "short"
python_use_unqualified_type_names = True

html_theme = "furo"
html_title = "Furuta pendulum"
html_show_sourcelink = False
html_copy_source = False
html_extra_path = ["index.html", "../../output/furuta.html", "../../output/slides.html"]
# Blocks without a language are shell commands, equations and tables of text.
highlight_language = "none"
smartquotes = False  # it would turn the -- of an option into a dash

# What the site shows in place of a comment of a page.
IN_PLACE = {
    "<!-- furuta.html -->": '<iframe src="../furuta.html" title="The running pendulum" '
    'width="100%" height="820"></iframe>\n',
    "```mermaid": "```text",  # drawing it would need a program from elsewhere
    "<!-- parameters of the nodes -->": parameters_of_nodes(),
    "<!-- keys of rig files -->": keys_of_rig_files(),
    "<!-- verbs -->": table(
        ("", ""), ((f'<a href="#furuta-{v}">{v}</a>', text) for v, text in main.VERBS.items())
    ),
    "<!-- examples -->": examples(),
    "<!-- names of the library -->": table(("", ""), map(library_row, furuta.__all__)),
}
# A link to the page in one file, which the site has; it opens in a window of its own.
PAGE_LINK = re.compile(r"\[(!\[.*?\]\(.*?\)|[^]]*)\]\((?:docs/)?view\.md#without-ros\)")

SLIDES = '<a href="../slides.html">slides.html</a>'


class Group:
    """Stands in a signature for the default of a group of parameters, which is long."""

    def __repr__(self) -> str:
        return "..."


def simplify(group: Any) -> None:
    """Leave the declarations and long defaults out of the signature of a named tuple."""
    new = group.__new__
    new.__annotations__ = get_type_hints(group)
    new.__defaults__ = tuple(
        Group() if hasattr(default, "_fields") else default for default in new.__defaults__ or ()
    )


def describe(app: Any, what: str, name: str, thing: Any, options: Any, lines: list[str]) -> None:
    """Add the meaning of the fields of a group of parameters to its docstring."""
    if what == "class" and hasattr(thing, "_fields"):
        for field, _, notes in group_fields(thing):
            if notes and isinstance(notes[0], About):
                lines += ["", f":param {field}: {notes[0].meaning} [{notes[0].unit or 1}]"]


def is_field(app: Any, what: str, name: str, thing: Any, skip: bool, options: Any) -> bool:
    """Leave out the fields of a named tuple, which its signature has."""
    return skip or type(thing).__name__ == "_tuplegetter"


def navigation(text: str) -> str:
    """The lists of the first page as the navigation of the site."""
    parts = re.split(r"^## (.+)$", text, flags=re.MULTILINE)[1:]
    trees = []
    for title, items in zip(parts[::2], parts[1::2], strict=True):
        links = re.findall(r"^- \[(.*?)\]\((.*?)\)", items, re.MULTILINE)
        pages = "\n".join(f"{name} <{link}>" for name, link in links)
        trees.append(f"\n```{{toctree}}\n:hidden:\n:caption: {title}\n\n{pages}\n```\n")
    return "".join(trees)


def complete(app: Any, page: str, source: list[str]) -> None:
    """Add to a page what only the site has."""
    for comment, text in IN_PLACE.items():
        source[0] = source[0].replace(comment, text)
    up = "../" * page.count("/")
    source[0] = PAGE_LINK.sub(rf'<a href="{up}furuta.html" target="_blank">\1</a>', source[0])
    source[0] = source[0].replace("[slides.html](slides.html)", SLIDES)
    source[0] = unlinked(source[0], Path(ROOT, page).parent, app.env.found_docs)
    if page == root_doc:
        source[0] += navigation(source[0])


def unlinked(text: str, folder: Path, pages: set[str]) -> str:
    """Links to folders and to Markdown that is no page become text: the site has neither."""

    def replaced(link: re.Match[str]) -> str:
        place = Path(os.path.normpath(folder / link[2]))
        page = place.relative_to(ROOT).with_suffix("").as_posix()
        other = place.is_dir() or (place.suffix == ".md" and place.exists() and page not in pages)
        return link[1] if other else link[0]

    return re.sub(r"\[([^]]*)\]\(([^)#:]+)\)", replaced, text)


def slides() -> str:
    """The slides of the course in one file, with their pictures in it."""

    def embedded(picture: re.Match[str]) -> str:
        file = ROOT / "course" / picture[1]
        data = base64.b64encode(file.read_bytes()).decode()
        return f'src="data:{mimetypes.guess_type(file.name)[0]};base64,{data}"'

    text = (ROOT / "course" / "slides.html").read_text(encoding="utf-8")
    return re.sub(r'src="(.*?)"', embedded, text)


def setup(app: Any) -> None:
    """Write the slides, and connect the functions above."""
    (ROOT / "output" / "slides.html").write_text(slides(), encoding="utf-8")
    for name in furuta.__all__:
        if hasattr(getattr(furuta, name), "_fields"):
            simplify(getattr(furuta, name))
    group: Any = main.furuta
    for verb in main.VERBS:  # sphinx-click takes the name of the command, which the group ignores
        group.get_command(None, verb).name = verb
    app.connect("source-read", complete)
    app.connect("autodoc-skip-member", is_field)
    app.connect("autodoc-process-docstring", describe)
