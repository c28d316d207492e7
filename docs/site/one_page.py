"""Builds the page in one file: ``python docs/site/one_page.py output/furuta.html``."""

import sys
from pathlib import Path

from page.build import build

if __name__ == "__main__":
    size = build(Path(sys.argv[1]))
    print(f"{sys.argv[1]}: {size / 1000:.0f} kB")
