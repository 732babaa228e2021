"""Sphinx configuration of the guide; the build needs no network, nor does the reader."""

import sys
import tomllib
from pathlib import Path

from docutils import nodes
from docutils.utils.math import MathError
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.application import Sphinx
from sphinx.util import logging
from sphinx.writers.html5 import HTML5Translator

sys.path.insert(0, str(Path(__file__).parent))
sys.path.insert(0, str(Path(__file__).parents[1]))
from profiletool.records.version import VERSION

_PROJECT = tomllib.loads((Path(__file__).parents[1] / "pyproject.toml").read_text())["project"]

project = _PROJECT["name"]
version = release = VERSION
project_copyright = "the authors of profiletool, MIT licence"

extensions = ["myst_parser", "sphinx.ext.autodoc", "numpydoc", "public_names", "generated"]
myst_enable_extensions = ["amsmath", "attrs_block", "attrs_inline", "colon_fence", "deflist",
                          "dollarmath"]  # fmt: skip
myst_heading_anchors = 3
exclude_patterns = ["_build"]
nitpicky = True

# Docstrings are numpy style; what stands in single backticks is a name, see public_names.py.
default_role = "py:obj"
autodoc_member_order = "bysource"
autodoc_preserve_defaults = True
maximum_signature_line_length = 80
toc_object_entries_show_parents = "hide"
numpydoc_show_class_members = False
numpydoc_attributes_as_param_list = True

html_theme = "furo"
html_title = f"{project} {version}"
html_static_path = ["static"]
html_css_files = ["guide.css"]
html_math_renderer = "mathml"
html_theme_options = {"navigation_with_keys": True}


def _mathml(node: nodes.math | nodes.math_block, *, block: bool) -> str:
    try:
        return tex2mathml(node.astext(), as_block=block)
    except MathError as error:
        logging.getLogger(__name__).warning("formula: %s", error, location=node)
        return ""


def _inline(translator: HTML5Translator, node: nodes.math) -> None:
    translator.body.append(_mathml(node, block=False))
    raise nodes.SkipNode


def _block(translator: HTML5Translator, node: nodes.math_block) -> None:
    number = node.get("number")
    label = "" if number is None else f'<span class="eqno">({number})</span>'
    identity = f' id="{node["ids"][0]}"' if node["ids"] else ""
    formula = _mathml(node, block=True)
    translator.body.append(f'<div class="equation"{identity}>{formula}{label}</div>\n')
    raise nodes.SkipNode


def setup(app: Sphinx) -> None:
    """Write formulas as MathML: MathJax would be fetched from the network by every reader."""
    app.add_html_math_renderer("mathml", (_inline, None), (_block, None))
