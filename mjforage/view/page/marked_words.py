"""Marks in the words of tables, captions and notes."""

import re

SUBSCRIPT = re.compile(r"(?<![\w.:])([A-Z][A-Za-z]*)_([A-Za-z0-9]+)\b")
"""A label of a metric with its subscript, as in `PTA_D`."""

CODE = re.compile(r"`([^`]+)`")
"""Code between backticks."""
