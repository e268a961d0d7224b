"""Map formats: tables, grids and images as cells that are light, dark or unknown. Files are data
from anybody: sizes are checked before cells are read, and nothing in them is ever run.
"""

from mjforage.scenario.map_formats.arrays import read_array
from mjforage.scenario.map_formats.images import IMAGE_SUFFIXES, read_image
from mjforage.scenario.map_formats.levels import DARK, LIGHT, UNKNOWN, Levels
from mjforage.scenario.map_formats.text import decoded, read_text

__all__ = [
    "DARK",
    "IMAGE_SUFFIXES",
    "LIGHT",
    "UNKNOWN",
    "Levels",
    "decoded",
    "read_array",
    "read_image",
    "read_text",
]
