"""Map formats: tables and images as cells that are light, dark or unknown. Files are data from
anybody: sizes are checked before cells are read, and nothing in them is ever run.
"""

from mjforage.scenario.map_formats.images import IMAGE_SUFFIXES, read_image
from mjforage.scenario.map_formats.levels import DARK, LIGHT, Levels
from mjforage.scenario.map_formats.tables import read_table

__all__ = ["DARK", "IMAGE_SUFFIXES", "LIGHT", "Levels", "read_image", "read_table"]
