"""`mjforage place`."""

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from mjforage.base.errors import UserError
from mjforage.cli.console import FOLDER, app, output
from mjforage.cli.flags import Words
from mjforage.cli.progress import working


@app.command
def place(
    file: Path,
    /,
    *,
    out: Annotated[Path, FOLDER],
    pitch: float = 4.0,
    crop: Annotated[str | None, Parameter(allow_leading_hyphen=True)] = None,
    rotate: Annotated[str, Parameter(allow_leading_hyphen=True)] = "0",
    water: Words = (),
    land: Words = (),
    share: float = 0.6,
    pier_width: float | None = None,
    min_depth: float | None = None,
    point: Words = (),
    licence: str = "",
) -> None:
    """Make a place, a map with latitude and longitude, of a chart, an outline or an image.

    It writes harbour.csv (the grid), place.toml (projection, pitch, source, remarks), quays.geojson
    (outlines of the land), harbour.png (a picture to check), and depths.csv (least depth of each
    node) where the water has depths.

    Parameters
    ----------
    file
        GeoJSON, GeoPackage, Shapefile, .osm.pbf, S-57 cell (.000), or an image.
    out
        Folder to write; --map and map.file take it.
    pitch
        Distance between the centres of neighbouring nodes [m].
    crop
        WEST,SOUTH,EAST,NORTH in degrees; default all of the file.
    rotate
        Bearing to which columns point up [deg], or auto: along most of the shore, of an image as it
        lies.
    water
        Features that are water, as natural=water, in the place of the usual ones; of an image
        light, dark, or a colour such as #aad3df; repeatable.
    land
        Features that are land, as man_made=pier, in the place of the usual ones; repeatable.
    share
        Share of its cell that is water, at least, in a node.
    pier_width
        Width of lines that are land [m]; default by their tags.
    min_depth
        Least depth of water that has one (DRVAL1 of S-57, or depth) [m]; default 0.
    point
        Control point of an image, ROW,COL=LAT,LON; give two.
    licence
        Licence of the file, to be shown with what is made from it; default what its format says.
    """
    from mjforage.api.maps import Map
    from mjforage.physics.berth_room import narrow_berths
    from mjforage.physics.vessels import load_vessel

    try:
        box = None if crop is None else [float(edge) for edge in crop.split(",")]
        turn = rotate if rotate == "auto" else float(rotate)
    except ValueError as error:
        raise UserError(
            f"--crop {crop}, --rotate {rotate}: give four numbers with commas, and a number or auto"
        ) from error
    with working("place"):
        made = Map.of_chart(
            file,
            out,
            pitch_m=pitch,
            crop=box,
            rotate=turn,
            water=water,
            land=land,
            share=share,
            pier_width_m=pier_width,
            min_depth_m=min_depth,
            points=point,
            licence=licence,
        )
    rows, columns = made.water.shape
    output.print(f"{made.name}: {rows} x {columns} at {made.pitch_m:g} m, {made.water.sum()} nodes")
    lines = made.place.remarks if made.place else ()
    for line in (*lines, *narrow_berths(made.grid, [load_vessel("forager")])):
        output.print(line, soft_wrap=True)
    output.print(f"place: {out}", soft_wrap=True)
