"""Settings of Sphinx for the documentation site; ``build.py`` collects the pages."""

project = "furuta_ws"
author = "The furuta_ws developers"
project_copyright = author

extensions = ["myst_parser"]
# Links to headings work as on GitHub; a link without a target is a warning, and so an error.
myst_heading_anchors = 4
exclude_patterns = ["files", ".doctrees"]

html_theme = "furo"
html_title = "Furuta pendulum"
html_show_sourcelink = False
html_copy_source = False
# Blocks without a language are shell commands, equations and tables of text.
highlight_language = "none"
