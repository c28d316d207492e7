"""Builds the documentation site: ``python docs/site/build.py SITE REFERENCE PAGE.html``.

Collects the pages beside the output, runs Sphinx with every warning as an error, adds the page
with the running pendulum, and checks that the result loads nothing from another host. ``make docs``
calls it.
"""

import re
import shutil
import subprocess
import sys
from pathlib import Path

from pages import REFERENCE, ROOT, BrokenLinkError, page_names, site_text

# What a browser loads by itself: scripts, pictures, frames, style sheets.
LOADED = re.compile(r"<(?:script|img|iframe|link)\b[^>]*\b(?:src|href)=\"((?:https?:)?//[^\"]*)\"")
LOADED_BY_STYLE = re.compile(r"(?:url\(|@import\s+)[\"']?((?:https?:)?//[^\"')]+)")
# Where a page shows the running pendulum: a comment elsewhere, a frame on the site.
SHOWN_HERE = "<!-- furuta.html -->"
FRAME = '<iframe src="furuta.html" title="The running pendulum" width="100%" height="820"></iframe>'


def collect(folder: Path, reference: Path) -> int:
    """Write the pages and the files that they link to into ``folder``; return their number.

    ``reference`` holds the pages that reference_pages.py has generated.
    """
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)

    def take(file: Path) -> str:
        place = Path("files") / file.relative_to(ROOT)
        (folder / place).parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(file, folder / place)
        return place.as_posix()

    names = page_names()
    for file, name in names.items():
        text = site_text(file, take).replace(SHOWN_HERE, FRAME)
        (folder / f"{name}.md").write_text(text)
    for name in REFERENCE:
        page = (reference / f"{name}.md").read_text()
        (folder / f"{name}.md").write_text(site_text(ROOT / "docs" / f"{name}.md", take, page))
    listed = {file for file in names if file.parent == ROOT / "docs"}
    missing = sorted(page.name for page in set((ROOT / "docs").glob("*.md")) - listed)
    if missing:
        raise BrokenLinkError(f"docs/README.md does not list {', '.join(missing)}")
    return len(names) + len(REFERENCE)


def loaded_from_elsewhere(site: Path) -> list[str]:
    """Addresses on other hosts that a page or style sheet of the site would load."""
    addresses = []
    for pattern, suffix in ((LOADED, "html"), (LOADED_BY_STYLE, "css")):
        for file in site.rglob(f"*.{suffix}"):
            addresses += [
                f"{file.relative_to(site)}: {address}"
                for address in pattern.findall(file.read_text(errors="replace"))
            ]
    return addresses


def main(site: Path, reference: Path, page: Path) -> int:
    """Build the site; return the exit status."""
    source = site.with_name(site.name + "_source")
    try:
        pages = collect(source, reference)
    except BrokenLinkError as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    shutil.rmtree(site, ignore_errors=True)
    sphinx = [sys.executable, "-m", "sphinx", "-b", "html", "-q", "-W", "--keep-going"]
    folders = ["-c", str(Path(__file__).parent), "-d", str(source / ".doctrees")]
    done = subprocess.run([*sphinx, *folders, str(source), str(site)], check=False)
    if done.returncode:
        return done.returncode
    shutil.copyfile(page, site / "furuta.html")
    elsewhere = loaded_from_elsewhere(site)
    for address in elsewhere:
        print(f"error: loaded from another host: {address}", file=sys.stderr)
    print(f"{pages} pages: {site / 'index.html'}")
    return bool(elsewhere)


if __name__ == "__main__":
    sys.exit(main(*map(Path, sys.argv[1:])))
