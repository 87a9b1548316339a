"""How the site of the documentation is built: `make docs`, with every warning an error.

Furo has its own scripts, styles and system fonts, and the search is Sphinx' own index, so that the
site fetches nothing from elsewhere and can be read from a folder.
"""

import os
import re
from typing import Any

from sphinx.application import Sphinx
from sphinx.ext.napoleon import GoogleDocstring

# What the API reference imports shall start no more threads than it needs.
os.environ.setdefault("OMP_NUM_THREADS", "1")

project = "sheath-manip"
author = "the maintainers of sheath-manip"
copyright = author
html_title = "sheath-manip"
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx_copybutton"]

html_theme = "furo"
html_show_sphinx = False
html_copy_source = False
html_show_sourcelink = False

# A box is written as GitHub writes it (`> [!WARNING]`), so that the pages can be read there, too.
myst_enable_extensions = ["alert"]
myst_heading_anchors = 3

# In docstrings `name` in single backticks is code, as everywhere in this project.
default_role = "code"
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_preserve_defaults = True
autodoc_default_options = {"members": True}
# A constructor's own docstring says what its arguments are.
autoclass_content = "both"
python_use_unqualified_type_names = True
toc_object_entries_show_parents = "hide"


OTHER_MARKUP = re.compile(r"`[^`]*`|[*|]|(?<=\w)_(?!\w)")
"""what reStructuredText would take for more than a letter; backticks first, to pass over them"""


def escaped(found: re.Match[str]) -> str:
    """Return a letter as itself, and what stands in backticks as it is."""
    return found.group() if len(found.group()) > 1 else f"\\{found.group()}"


def read_sections(
    app: Sphinx, what: str, name: str, obj: Any, options: Any, lines: list[str]
) -> None:
    """Turn `Args:` and `Raises:` of a docstring into fields; backticks are its only markup.

    Napoleon as an extension would also take what stands before a colon in the docstring of an
    attribute for its type.
    """
    del app, name, obj, options
    lines[:] = [OTHER_MARKUP.sub(escaped, line) for line in lines]
    if what not in ("attribute", "data", "property"):
        lines[:] = GoogleDocstring(lines, what=what).lines()


def setup(app: Sphinx) -> None:
    """Connect what this file does."""
    app.connect("autodoc-process-docstring", read_sections)
