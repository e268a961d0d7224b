"""Outlines of a vector file (GeoJSON, GeoPackage, Shapefile, OpenStreetMap, S-57), read by GDAL."""

import re
import warnings
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.scenario.placing.relations import incomplete_areas

Box = tuple[float, float, float, float]  # west, south, east, north [deg]
_HSTORE = re.compile(r'"((?:[^"\\]|\\.)*)"=>"((?:[^"\\]|\\.)*)"')  # OpenStreetMap's other_tags
_INDEX = "OSM_USE_CUSTOM_INDEXING"  # option of GDAL, which tells to take the other in its errors
_NO_MAP = ("DSID", "C_", "M_")  # layers of S-57 about the chart itself


@dataclass(frozen=True, eq=False)
class Outlines:
    """Features of a file, in longitude and latitude.

    Attributes
    ----------
    shapes : (feature,) geometries of shapely
    tags : of each feature, its attributes as texts, and ``layer``
    kind : "osm", "s57" or "plain"
    licence : what the format says of it, or nothing
    bounds : box that an extract of OpenStreetMap says it is of, which its ways may leave, if any
    incomplete : tags of areas that are no features, as the extract lacks ways of their outlines
    """

    shapes: NDArray[np.object_]
    tags: Sequence[dict[str, str]]
    kind: str
    licence: str
    bounds: Box | None
    incomplete: Sequence[dict[str, str]]


def read_outlines(path: Path, box: Box | None) -> Outlines:
    """All features with a geometry, in a box if one is given.

    Raises `UserError` if GDAL cannot read the file, or it has no features there or no coordinate
    system.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of features that are damaged: they have no geometry
            return _read(path, box)
    except (RuntimeError, OSError) as error:  # as all of pyogrio are
        words = " ".join(str(error).split())
        raise UserError(
            f"place {path}: cannot be read ({words}); give GeoJSON, GeoPackage, a Shapefile, "
            ".osm.pbf with each number once, an S-57 cell (.000) or an image"
        ) from error


def _read(path: Path, box: Box | None, index: bool = True) -> Outlines:
    """As `read_outlines`, with errors of pyogrio.

    `index`: numbers of nodes ascend and are above 0, as in extracts but not in files of editors.
    """
    from pyogrio import list_layers, read_info, set_gdal_config_options

    layers = {str(name): kind for name, kind in list_layers(path)}
    kind = _kind(path, layers)
    drawn = [name for name in layers if layers[name] and not _apart(name, kind)]
    bounds = read_info(path, layer=drawn[0])["total_bounds"] if kind == "osm" else None
    set_gdal_config_options({_INDEX: index})
    try:
        parts = [_layer(path, name, box or bounds) for name in drawn]
    except (RuntimeError, OSError) as error:
        if not index or _INDEX not in str(error):
            raise
        return _read(path, box, index=False)
    finally:
        set_gdal_config_options({_INDEX: None})
    shapes = np.concatenate([part[0] for part in parts]) if parts else np.empty(0, object)
    if not shapes.size:
        where = f" in the crop {box}" if box else ""
        raise UserError(f"place {path}: has no features{where}; give a file or crop with some")
    tags, licence = [tag for part in parts for tag in part[1]], _licence(path, kind, layers)
    incomplete = incomplete_areas(path) if kind == "osm" else []
    return Outlines(shapes, tags, kind, licence, bounds, incomplete)


def _kind(path: Path, layers: Collection[str]) -> str:
    if path.name.lower().endswith((".osm.pbf", ".pbf", ".osm")):
        return "osm"
    return "s57" if "DSID" in layers or "DEPARE" in layers or path.suffix == ".000" else "plain"


def _apart(layer: str, kind: str) -> bool:
    return kind == "s57" and layer.startswith(_NO_MAP)


def _licence(path: Path, kind: str, layers: Collection[str]) -> str:
    if kind == "osm":
        return "OpenStreetMap contributors, ODbL 1.0, https://www.openstreetmap.org/copyright"
    if "DSID" not in layers:
        return ""
    from pyogrio.raw import read

    about, _, _, values = read(path, layer="DSID", read_geometry=False)
    cell = {str(name): values[i][0] for i, name in enumerate(about["fields"])}
    return (
        f"S-57 cell {cell.get('DSID_DSNM', path.name)}, edition {cell.get('DSID_EDTN')}, update "
        f"{cell.get('DSID_UPDN')}, {cell.get('DSID_COMT') or 'its producer'}; not for navigation"
    )


def _layer(
    path: Path, layer: str, box: Box | None
) -> tuple[NDArray[np.object_], list[dict[str, str]]]:
    """Geometries in longitude and latitude, and their tags."""
    import shapely
    from pyogrio import read_info
    from pyogrio.raw import read
    from pyproj import CRS, Transformer
    from pyproj.exceptions import ProjError

    crs = read_info(path, layer=layer)["crs"]
    if not crs:
        raise UserError(
            f"place {path}: layer {layer} has no coordinate system; add its .prj or write it anew "
            "with one"
        )
    try:
        system = CRS.from_user_input(crs)
        onto = Transformer.from_crs(system, "EPSG:4326", always_xy=True)
        bounds = box and onto.transform_bounds(*box, direction="INVERSE")
    except ProjError as error:
        raise UserError(f"place {path}: layer {layer} in {crs}: {error}") from error
    about, _, wkb, columns = read(path, layer=layer, bbox=bounds)
    shapes = shapely.force_2d(shapely.from_wkb(wkb, on_invalid="ignore"))
    shapes = shapely.transform(shapes, lambda xy: np.stack(onto.transform(*xy.T), axis=-1))
    there = np.flatnonzero(~(shapely.is_missing(shapes) | shapely.is_empty(shapes)))
    edges = shapely.bounds(shapes[there])
    if not (np.isfinite(edges).all() and (np.abs(edges[:, 1::2]) < 90.0).all()):
        raise UserError(
            f"place {path}: layer {layer} has points that are on no globe in {crs}; give the "
            "coordinate system that its coordinates are in"
        )
    names = [str(name) for name in about["fields"]]
    found = [_tags(layer, names, [values[i] for values in columns]) for i in there]
    return np.asarray(shapes[there], dtype=object), found


def _tags(layer: str, names: Sequence[str], values: Sequence[Any]) -> dict[str, str]:
    """Attributes of a feature as texts; whole numbers without a point, absent ones left out."""
    tags: dict[str, str] = {}
    for name, value in zip(names, values, strict=True):
        if isinstance(value, np.ndarray | list):
            value = ",".join(map(str, value))
        if value is None or value != value:
            continue
        text = f"{value:g}" if isinstance(value, float | np.floating) else str(value)
        if name == "other_tags":
            tags |= dict(_HSTORE.findall(text))
        elif text:
            tags[name] = text
    return {"layer": layer} | tags | {"layer": layer}  # whatever a tag of that name says
