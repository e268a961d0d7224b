"""A place: where on the globe the cells of a map lie, and its file `place.toml`.

The frame of a place is that of MuJoCo: x to the right along a row, y up along a column, the centre
of the south-west cell is the origin [m]. Cells (row, column) count from 0 at the upper left.
"""

import json
from dataclasses import asdict, dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
import tomli_w
from numpy.typing import ArrayLike, NDArray

from mjforage.base.atomic_files import atomic_write
from mjforage.base.errors import UserError
from mjforage.base.extras import require
from mjforage.base.fields import Above, Within
from mjforage.base.toml_files import read_toml
from mjforage.scenario.bearings import Bearing, direction
from mjforage.scenario.schema import check

PLACE_FILE, GRID_FILE, DEPTHS_FILE, QUAYS_FILE, PICTURE_FILE = (
    *("place.toml", "harbour.csv", "depths.csv"),
    *("quays.geojson", "harbour.png"),
)
Ring = tuple[tuple[float, float], ...]


@dataclass(frozen=True)
class Place:
    """Content of `place.toml`."""

    latitude_deg: Annotated[float, Within(-89, 89, "deg")]
    """Latitude of the middle of the grid (WGS 84), the origin of the projection."""
    longitude_deg: Annotated[float, Within(-180, 180, "deg")]
    """Its longitude."""
    pitch_m: Annotated[float, Within(1e-3, 1e6, "m")]
    """Distance between the centres of neighbouring nodes."""
    rows: Annotated[int, Within(1, 1_000_000)]
    """Rows of the grid."""
    columns: Annotated[int, Within(1, 1_000_000)]
    """Columns of the grid."""
    rotation_deg: Bearing = 0.0
    """Bearing to which columns point up, clockwise from true north in the middle of the grid."""
    projection: Literal["azimuthal equidistant"] = "azimuthal equidistant"
    """Projection about the middle of the grid."""
    share: Annotated[float, Above(0, 1)] = 0.6
    """Share of its cell that is water, at least, in a node."""
    source: str = ""
    """Name of the file that it was made from."""
    sha256: str = ""
    """Hash of that file."""
    licence: str = "not stated"
    """Licence of that file, to be shown with what is made from it."""
    remarks: tuple[str, ...] = ()
    """Choices and losses when it was made: widths, closed channels, what was left out."""
    quays: tuple[Ring, ...] = ()
    """Outlines of the land in the frame of the place [m], closed; in `quays.geojson` beside it."""

    def latlon(self, cells: ArrayLike) -> NDArray[np.float64]:
        """Latitude and longitude [deg] of (..., 2) rows and columns, which need not be whole."""
        rc = np.asarray(cells, np.float64)
        x, y = rc[..., 1] - 0.5 * (self.columns - 1), 0.5 * (self.rows - 1) - rc[..., 0]
        east, north = self.pitch_m * (self._turn @ np.stack((x, y)).reshape(2, -1))
        lon, lat = projection(self.latitude_deg, self.longitude_deg).transform(
            east, north, direction="INVERSE"
        )
        return np.stack((lat, lon), axis=-1).reshape(rc.shape)

    def cells(self, latlon: ArrayLike) -> NDArray[np.float64]:
        """Row and column, not rounded, of (..., 2) latitudes and longitudes [deg]."""
        given = np.asarray(latlon, np.float64)
        x, y = self.frame(given[..., 1].ravel(), given[..., 0].ravel()).T / self.pitch_m
        return np.stack((self.rows - 1 - y, x), axis=-1).reshape(given.shape)

    def frame(self, lon: ArrayLike, lat: ArrayLike) -> NDArray[np.float64]:
        """(point, 2) of (point,) longitudes and latitudes [deg], in the frame of the place [m]."""
        east, north = projection(self.latitude_deg, self.longitude_deg).transform(lon, lat)
        half = 0.5 * self.pitch_m * np.array([self.columns - 1, self.rows - 1])
        turned: NDArray[np.float64] = (self._turn.T @ np.stack((east, north))).T + half
        return turned

    @property
    def _turn(self) -> NDArray[np.float64]:
        """East and north of the frame's x and y."""
        angle = direction(self.rotation_deg)
        return np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])


def north_deg(place: Place | None) -> float:
    """Bearing of a map's y axis, clockwise from true north: 0 where it is no place."""
    return place.rotation_deg if place else 0.0


@lru_cache(maxsize=8)
def projection(latitude_deg: float, longitude_deg: float) -> Any:
    """Transformer from longitude and latitude to metres east and north of a point."""
    require("a place", "pyproj")
    from pyproj import Transformer

    local = (
        f"+proj=aeqd +lat_0={latitude_deg:.10f} +lon_0={longitude_deg:.10f} +datum=WGS84 +units=m"
    )
    return Transformer.from_crs("EPSG:4326", local, always_xy=True)


def is_place(reference: str) -> bool:
    """True if a path names a place: its folder, or a TOML file in it."""
    path = Path(reference)
    try:
        return path.suffix == ".toml" or (path / PLACE_FILE).is_file()
    except (OSError, ValueError):
        return False


def place_path(reference: str) -> Path:
    """File of a place, named by its folder or itself."""
    path = Path(reference)
    return path if path.suffix == ".toml" else path / PLACE_FILE


def write_place(place: Place, folder: Path) -> None:
    """Write `place.toml`, and `quays.geojson` beside it.

    Raises `UserError` if a file cannot be written.
    """
    tree = {key: value for key, value in asdict(place).items() if key != "quays"}
    quays = {
        "type": "Feature",
        "properties": {"frame": "x, y [m] of the place, from the centre of its south-west cell"},
        "geometry": {"type": "MultiLineString", "coordinates": place.quays},
    }
    words = json.dumps({"type": "FeatureCollection", "features": [quays]})
    for name, text in ((PLACE_FILE, tomli_w.dumps(tree)), (QUAYS_FILE, words + "\n")):
        with atomic_write(folder / name) as beside:
            beside.write_text(text, encoding="utf-8")


def read_place(path: Path) -> Place:
    """The place of a `place.toml`, with the quays beside it if there are any.

    Raises `UserError` if one of the files is missing or malformed.
    """
    place = check(Place, read_toml(path, f"place {path}"), f"place {path}")
    file = path.with_name(QUAYS_FILE)
    if not file.is_file():
        return place
    try:
        tree = json.loads(file.read_text(encoding="utf-8"))
        rings = tree["features"][0]["geometry"]["coordinates"]
        given = tuple(tuple((float(x), float(y)) for x, y in ring) for ring in rings)
    except (OSError, ValueError, LookupError, TypeError, RecursionError) as error:
        raise UserError(
            f"quays {file}: not lines of x, y in a GeoJSON file ({error}); make the place again, "
            "or delete the file for quays along the cells"
        ) from error
    if not np.isfinite([xy for ring in given for xy in ring]).all():
        raise UserError(f"quays {file}: a coordinate is not finite; make the place again")
    return replace(place, quays=given)


def write_depths(depth_m: NDArray[np.float64], path: Path) -> None:
    """Write depths (row, column) as a table [m], with nothing on land and `inf` where unknown."""
    words = (["" if one != one else f"{one:g}" for one in row] for row in depth_m.tolist())
    with atomic_write(path) as beside:
        beside.write_text("".join(f"{','.join(row)}\n" for row in words), encoding="utf-8")


def read_depths(path: Path, nodes: NDArray[np.bool_]) -> NDArray[np.float64] | None:
    """(row, column) depths [m] of the nodes of a place, infinite where the file has none, NaN on
    land; None if there is no file.

    Raises `UserError` if the file is malformed, or has not the place's rows and columns.
    """
    if not path.is_file():
        return None
    remedy = "make the place again, or delete the file"
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
        given = np.array([[float(one or "nan") for one in line.split(",")] for line in lines])
    except (OSError, ValueError) as error:
        raise UserError(f"depths {path}: not a table of metres ({error}); {remedy}") from error
    if given.shape != nodes.shape:
        raise UserError(f"depths {path}: has shape {given.shape}, expected {nodes.shape}; {remedy}")
    return np.where(nodes, np.nan_to_num(given, nan=np.inf, posinf=np.inf), np.nan)
