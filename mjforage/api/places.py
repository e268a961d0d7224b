"""Places as a user of Python makes them: a harbour of a chart, an outline or an image."""

from collections.abc import Sequence
from typing import Any

from mjforage.api import checks
from mjforage.api.checks import Named
from mjforage.api.maps import Map
from mjforage.base.errors import UserError
from mjforage.scenario.place import PICTURE_FILE


def place(
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
) -> Map:
    """Make a place of a file, and write it: `harbour.csv`, `place.toml`, `quays.geojson`,
    `harbour.png`.

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
    min_depth_m : least depth of a chart's water; None: 0
    points : two control points of an image, as ``"12,340=38.97,-76.48"`` (row, column = latitude,
        longitude)
    licence : of the file, to be shown with what is made from it; by default what its format says

    Raises
    ------
    UserError
        If the file cannot be read or has no water there, an argument is out of range, a library is
        missing, or the folder cannot be written.
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
    Map.of(grid, pitch_m, ()).to_file(target)
    save_map_picture([grid], target / PICTURE_FILE)
    return Map(target)


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
