"""Words of the report that are data, in `words.toml`."""

import tomllib
from importlib import resources
from typing import Any

WORDS: dict[str, Any] = tomllib.loads(
    resources.files("mjforage.view.report").joinpath("words.toml").read_text(encoding="utf-8")
)
"""`notes` on definitions, and `figures` of several metrics."""
