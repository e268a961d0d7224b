"""The site: `make docs` makes it from the pages of this folder; warnings are errors.

A page is Markdown that a plain viewer of the checkout shows as well. Links are paths of the
checkout: to another page (`../physics.md#limits`), or to any file of the repository
(`../models/scenarios/comb-port.toml`), which the site then holds a copy of. A page of this folder
joins the site by the toctree of its section, in `index.md`; one that is in none is an error.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent / "_site"))

from mjforage import __version__

project = "mjforage"
author = copyright = "The mjforage founders"
version = release = __version__

extensions = [
    "myst_nb",  # Markdown too
    "sphinx.ext.autodoc",
    "numpydoc",
    "math_ml",
    "docstrings",
    "repository_links",
    "pictures",
    "clean_notebooks",
]
exclude_patterns = ["_site"]
nitpicky = True
nitpick_ignore_regex = [("py:.*", ".*")]  # names in annotations, of libraries and of ours
suppress_warnings = ["ref.python"]  # a name of an annotation that several classes have

myst_enable_extensions = ["dollarmath", "deflist"]
myst_heading_anchors = 4
myst_fence_as_directive = ["math"]
myst_links_external_new_tab = False

nb_execution_mode = "force"  # notebooks are kept without outputs
nb_execution_raise_on_error = True
nb_execution_timeout = 900  # seconds of a cell, on a busy machine
nb_merge_streams = True

smartquotes = False  # it makes dashes of the two hyphens of an option
default_role = "code"  # our docstrings mark names with single backticks
autodoc_member_order = "bysource"
autodoc_typehints_format = "short"
python_use_unqualified_type_names = True
numpydoc_show_class_members = False
numpydoc_xref_param_type = False

html_theme = "pydata_sphinx_theme"
html_title = f"mjforage {__version__}"
html_math_renderer = "mathml"  # what browsers draw themselves: no script, no fonts
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_sourcelink = False
html_show_sphinx = False
html_show_search_summary = False  # scripts may not read pages that were opened as files
html_last_updated_fmt = None  # the same pages give the same bytes
html_sidebars = {"start": [], "gallery": [], "contributing": [], "changelog": []}
html_context = {"default_mode": "auto"}
html_theme_options = {
    "header_links_before_dropdown": 7,
    "navigation_with_keys": False,
    "show_toc_level": 2,
    "navigation_depth": 3,
    "collapse_navigation": True,
    "secondary_sidebar_items": ["page-toc"],
    "article_header_end": [],
    "footer_start": ["copyright"],
    "footer_end": [],
    "search_bar_text": "Search",
    "pygments_light_style": "a11y-high-contrast-light",
    "pygments_dark_style": "a11y-high-contrast-dark",
}
linkcheck_timeout = 20
