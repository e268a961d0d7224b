"""Maps as a user of Python has them: arrays, names, files and objects."""

import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mjforage.api import checks
from mjforage.api.checks import Named
from mjforage.base.atomic_files import atomic_write, write_errors
from mjforage.base.errors import UserError
from mjforage.scenario.map_files import WaterIs, write_table
from mjforage.scenario.maps import (
    GridMap,
    Starts,
    check_starts,
    load_map,
    load_starts,
    pitch_of,
    water_of_array,
)
from mjforage.scenario.place import (
    DEPTHS_FILE,
    GRID_FILE,
    PICTURE_FILE,
    PLACE_FILE,
    Place,
    write_depths,
    write_place,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class Map:
    """A grid of water and land, north up, with its pitch and starts; immutable.

    Parameters
    ----------
    water : array (rows, columns), True where there is water; or the name of a shipped map, of a
        generated harbour such as ``harbour:combs:7``, or a file (CSV table, grid or image); or the
        folder of a place (`of_chart`)
    pitch_m : distance between the centres of neighbouring nodes [m]; a place has its own
    starts : (row, column) of the starts, assigned to agents at random; None: those beside a file,
        else a random cluster
    name : for tables and pages; by default that of the file
    water_is : pixels of a file that are water, "light" or "dark"

    Raises
    ------
    UserError
        If the map cannot be read, or has no water. Whether its water is one component, a scenario
        checks.

    Examples
    --------
    >>> import mjforage as mf, numpy as np
    >>> mf.Map(np.ones((20, 30), bool), pitch_m=2.0)
    Map(array, 20 x 30 at 2 m, 600 nodes)
    """

    __slots__ = ("_grid", "_pitch_m", "_starts")

    def __init__(
        self,
        water: Named | ArrayLike,
        *,
        pitch_m: float = 4.0,
        starts: Starts | None = None,
        name: str | None = None,
        water_is: WaterIs = "light",
    ) -> None:
        checks.one_of("water_is", water_is, get_args(WaterIs))
        if isinstance(water, str | os.PathLike):
            grid, beside = load_map(os.fspath(water), water=water_is), load_starts(os.fspath(water))
        elif water_is != "light":
            raise UserError(f"water_is {water_is!r}: is for files; mark an array's water with True")
        else:
            grid, beside = GridMap("array", water_of_array(water)), None
            if not grid.nodes:
                raise UserError("map: the array has no water; mark water with 1 or True")
        given = beside or () if starts is None else _cells(starts)
        called = grid.name if name is None else checks.label("name", name)
        self._grid = GridMap(called, grid.navigable, grid.place, grid.depth_m)
        self._starts: Starts = tuple((int(row), int(column)) for row, column in given)
        self._pitch_m = pitch_of(self._grid, checks.real("pitch_m", pitch_m, above=0.0))
        check_starts(self._starts, self.water, "this map", self.name)

    @classmethod
    def of(cls, grid: GridMap, pitch_m: float, starts: Starts) -> "Map":
        """The map of a grid that was checked."""
        made = cls(grid.navigable, pitch_m=pitch_m, starts=starts, name=grid.name)
        made._grid = grid
        return made

    @staticmethod
    def of_chart(
        file: Named,
        folder: Named,
        *,
        pitch_m: float = 4.0,
        crop: Sequence[float] | None = None,
        rotate: float | str = 0.0,
        water: str | Sequence[str] = (),
        land: str | Sequence[str] = (),
        share: float = 0.6,
        pier_width_m: float | None = None,
        min_depth_m: float | None = None,
        points: Sequence[str] = (),
        licence: str = "",
    ) -> "Map":
        """Make a place of a file, and write it: `harbour.csv`, `place.toml`, `quays.geojson`,
        `harbour.png`, and `depths.csv` of a chart that has some.

        Parameters
        ----------
        file : GeoJSON, GeoPackage, Shapefile, ``.osm.pbf``, S-57 cell (``.000``), or an image
        folder : to write, made if it is missing
        pitch_m : distance between the centres of neighbouring nodes [m]
        crop : west, south, east and north [deg]; None: all of the file
        rotate : bearing to which columns point up [deg], or "auto": along most of the shore, of an
            image as it lies
        water, land : features that are water and land, as ``natural=water`` or ``man_made``, in the
            place of the usual ones; of an image ``water`` is light, dark, or colours as ``#aad3df``
        share : share of its cell that is water, at least, in a node
        pier_width_m : width of lines that are land; None: by their tags
        min_depth_m : least depth of water that has one, its `DRVAL1` or `depth`; None: 0
        points : two control points of an image, as ``"12,340=38.97,-76.48"`` (row, column =
            latitude, longitude)
        licence : of the file, to be shown with what is made from it; by default as its format says

        Raises
        ------
        UserError
            If the file cannot be read or has no water there, an argument is out of range, a
            library is missing, or the folder cannot be written.
        """
        from mjforage.scenario.placing.making import Layout, make_place
        from mjforage.scenario.placing.pictures import control_point
        from mjforage.scenario.placing.water import Choice
        from mjforage.view.figures.map_pictures import save_map_picture

        layout = Layout(
            checks.real("pitch_m", pitch_m, above=0.0),
            _within("share", share, 0.0, 1.0),
            None if crop is None else _box(crop),
            None if rotate == "auto" else _within("rotate", rotate, -360.0, 360.0),
        )
        choice = Choice(
            checks.texts("water", water),
            checks.texts("land", land),
            None if pier_width_m is None else _within("pier_width_m", pier_width_m, 0.0, 1000.0),
            None if min_depth_m is None else checks.real("min_depth_m", min_depth_m),
        )
        known = [control_point(point) for point in checks.texts("points", points)]
        source, target = checks.path("file", file), checks.path("folder", folder)
        grid = make_place(source, layout, choice, known, checks.text("licence", licence))
        Map.of(grid, layout.pitch_m, ()).to_file(target)
        made = Map(target)
        save_map_picture([made._grid], target / PICTURE_FILE)
        return made

    @property
    def name(self) -> str:
        """Name for tables and pages."""
        return self._grid.name

    @property
    def water(self) -> NDArray[np.bool_]:
        """(row, column) True where there is water; read-only."""
        return self._grid.navigable

    @property
    def pitch_m(self) -> float:
        """Distance between the centres of neighbouring nodes [m]."""
        return self._pitch_m

    @property
    def starts(self) -> Starts:
        """(row, column) of the starts; empty: a random cluster."""
        return self._starts

    @property
    def grid(self) -> GridMap:
        """Water, name, place and depths, as a scenario has them."""
        return self._grid

    @property
    def place(self) -> Place | None:
        """Place on the globe: ``place.latlon(cells)`` has latitude and longitude of rows and
        columns, ``place.cells(latlon)`` the way back; None of maps that are no place.
        """
        return self._grid.place

    def plot(self) -> "Figure":
        """Figure of the map, north up, with its starts."""
        from mjforage.view.figures.map_pictures import map_figure

        return map_figure([self._grid], self.starts)

    def to_file(self, path: Named) -> Path:
        """Write the water as a CSV table, and the starts beside it; a place as a folder.

        Raises
        ------
        UserError
            If a file cannot be written.
        """
        target = table = checks.path("path", path)
        if self.place:
            with write_errors(target):
                target.mkdir(parents=True, exist_ok=True)
            write_place(self.place, target)
            if self._grid.depth_m is not None:
                write_depths(self._grid.depth_m, target / DEPTHS_FILE)
            table, target = target / GRID_FILE, target / PLACE_FILE
        write_table(self._grid.charted, table)
        if self.starts:
            with atomic_write(target.with_name(f"{target.stem}.starts.csv")) as beside:
                beside.write_text("".join(f"{row},{column}\n" for row, column in self.starts))
        return target.parent if self.place else target

    def __repr__(self) -> str:
        rows, columns = self.water.shape
        size = f"{rows} x {columns} at {self.pitch_m:g} m"
        return f"Map({self.name}, {size}, {self._grid.nodes} nodes)"


def _cells(starts: object) -> list[list[int]]:
    """(row, column) of each start; raises `TypeError` for anything else."""
    several = starts.tolist() if isinstance(starts, np.ndarray) else starts
    if not isinstance(several, Sequence) or not all(
        isinstance(one, Sequence) and not isinstance(one, str) and len(one) == 2 for one in several
    ):
        raise TypeError(f"starts {starts!r}: give (row, column) of each, as in [(2, 5), (3, 5)]")
    return [[checks.whole("start", part, 0) for part in one] for one in several]


def _within(name: str, value: Any, above: float, most: float) -> float:
    if isinstance(value, str):
        raise UserError(f"{name} {value!r}: give a number, or auto for rotate")
    if (found := checks.real(name, value, above=above)) > most:
        raise UserError(f"{name} = {found:g}: give at most {most:g}")
    return found


def _box(crop: Sequence[float]) -> tuple[float, float, float, float]:
    if isinstance(crop, str) or len(crop) != 4:
        raise UserError(f"crop {crop!r}: give west, south, east and north, as -76.5,38.9,-76.4,39")
    west, south, east, north = (checks.real("crop", edge) for edge in crop)
    if not (-180 <= west < east <= 180 and -89 <= south < north <= 89):
        raise UserError(
            f"crop {west:g},{south:g},{east:g},{north:g}: give west < east within 180 and south < "
            "north within 89 degrees"
        )
    return west, south, east, north
