"""Episodes in the formats of other programs, by name."""

from collections.abc import Callable, Mapping
from pathlib import Path

from mjforage.base.atomic_files import write_bytes, write_errors
from mjforage.base.errors import UserError
from mjforage.base.references import nearest
from mjforage.mission.setup import Setup
from mjforage.runs.episode_recording import Recording
from mjforage.runs.exporting.cf import netcdf_files
from mjforage.runs.exporting.charts import csv_files, geojson_files, gpx_files, qgc_files
from mjforage.runs.exporting.mjcf import mjcf_files
from mjforage.runs.exporting.ros import mcap_files

FORMATS: Mapping[str, Callable[[Setup, Recording], dict[str, bytes]]] = {
    "mjcf": mjcf_files,
    "csv": csv_files,
    "geojson": geojson_files,
    "gpx": gpx_files,
    "mcap": mcap_files,
    "netcdf": netcdf_files,
    "qgc": qgc_files,
}
"""Name -> files, by their names, of an episode; of a scenario the episode has its start alone."""


def write_export(setup: Setup, shown: Callable[[], Recording], folder: Path, to: str) -> Path:
    """Write an episode into a folder that is empty or not there yet; before it is played, check.

    Raises `UserError` if there is no such format, the folder holds something, the scenario does not
    fit the format, or a file cannot be written.
    """
    if to not in FORMATS:
        raise UserError(f"format {to}: unknown; {nearest(to, FORMATS)}")
    with write_errors(folder):
        if folder.exists() and any(folder.iterdir()):
            raise UserError(f"folder {folder}: is not empty; name another")
    for name, content in FORMATS[to](setup, shown()).items():
        write_bytes(folder / name, content)
    return folder
