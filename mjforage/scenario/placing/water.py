"""The water among outlines: which features are water and land, and widths of lines."""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.base.references import nearest
from mjforage.scenario.placing.coast import Shapes, coastlines, seaward
from mjforage.scenario.placing.outlines import Outlines

Rule = tuple[str, str]  # key and value of a tag; any value if empty
WATER: Mapping[str, Sequence[Rule]] = {
    "s57": [("layer", "DEPARE"), ("layer", "DRGARE")],
    "osm": [
        *(("natural", "water"), ("natural", "bay"), ("natural", "strait")),
        *(("waterway", "riverbank"), ("waterway", "dock"), ("landuse", "basin")),
        ("landuse", "reservoir"),
    ],
}
LAND: Mapping[str, Sequence[Rule]] = {
    "s57": [
        *(("layer", "LNDARE"), ("layer", "SLCONS"), ("layer", "PONTON"), ("layer", "FLODOC")),
        *(("layer", "DAMCON"), ("layer", "GATCON"), ("layer", "CAUSWY"), ("layer", "HULKES")),
    ],
    "osm": [
        *(("man_made", "pier"), ("man_made", "breakwater"), ("man_made", "groyne")),
        *(("man_made", "quay"), ("man_made", "pontoon"), ("man_made", "jetty")),
        *(("man_made", "mole"), ("bridge:support", ""), ("natural", "coastline")),
        *(("place", "island"), ("place", "islet"), ("waterway", "dam")),
        ("waterway", "lock_gate"),
    ],
}
_BAY = ("bay", "strait")  # natural=... of parts of the sea, whose outlines need not follow a coast
_ISLAND = ("island", "islet")  # place=... of ground on which there may be lakes and docks
WIDTH_M = {
    "breakwater": 6.0,
    "mole": 8.0,
    "promenade pier": 6.0,
} | dict.fromkeys(("groyne", "quay", "wharf", "training wall", "dam"), 3.0)
_SLIT_M = 0.05
PIER_M = 2.0  # of piers, pontoons, and all lines that have no width of their own
_CATSLC = dict(
    zip(
        "1234567",
        ("breakwater", "groyne", "mole", "pier", "promenade pier", "wharf", "training wall"),
        strict=True,
    )
)
"""Shoreline constructions of S-57."""
_AREA = ("Polygon", "MultiPolygon")
_LINE = ("LineString", "MultiLineString", "LinearRing")


@dataclass(frozen=True)
class Choice:
    """Choices of a caller among a file's features.

    Attributes
    ----------
    water, land : filters KEY=VALUE or KEY, in the place of the usual ones
    pier_width_m : width of all lines; None: that of their kind
    min_depth_m : depth below which water counts as land; None: 0
    """

    water: tuple[str, ...] = ()
    land: tuple[str, ...] = ()
    pier_width_m: float | None = None
    min_depth_m: float | None = None


Depths = tuple[Shapes, NDArray[np.float64]]
"""(area,) areas of water in the frame of the place, and the least depth of each [m]."""


def water_of(
    outlines: Outlines, shapes: Shapes, choice: Choice, box: Any
) -> tuple[Any, Depths, list[str]]:
    """The water in a box, as one geometry, its depths, and remarks on how it was found.

    Raises `UserError` if a filter fits no feature, or none is water or land.

    Parameters
    ----------
    shapes : (feature,) of the outlines' tags, valid, in the frame of the place [m]
    box : polygon of the place
    """
    import shapely

    tags, kind, shapes = outlines.tags, outlines.kind, shapes.copy()
    kinds = "osm" if kind == "plain" else kind
    names = np.array([_type(shape) for shape in shapes])
    every = [*tags, *outlines.incomplete]
    is_water = _fit(every, choice.water, "--water", WATER[kinds])[: len(tags)]
    is_land = _fit(every, choice.land, "--land", LAND[kinds])[: len(tags)]
    for i in np.flatnonzero(is_water & (names == "line")).tolist():
        if shapely.is_closed(shapes[i]) and len(shapely.get_coordinates(shapes[i])) > 3:
            shapes[i], names[i] = shapely.make_valid(shapely.Polygon(shapes[i])), "area"
    natural = np.array([tag.get("natural", "") for tag in tags])
    coast = (natural == "coastline") & (names != "point")
    if choice.water:
        coast &= names == "line"
    elif coast.any():
        is_water &= ~np.isin(natural, _BAY)
    missing = _incomplete(outlines.incomplete, choice)
    remarks = list(missing)
    if not (is_water | is_land).any():
        if kind != "plain" or not (names == "area").any():
            raise UserError(
                f"place: none of {len(tags)} features is known as water or land; say which are by "
                f"--water KEY=VALUE or --land KEY=VALUE, with {'; '.join([_keys(tags), *missing])}"
            )
        is_water = names == "area"
        remarks.append(f"all {is_water.sum()} polygons taken for water; --water, --land filter")
    is_water &= names == "area"
    depth_m = _depths(tags, is_water, choice)
    shallow = depth_m < (choice.min_depth_m or 0.0)
    is_water &= ~shallow
    under = np.array([tag.get("WATLEV") == "3" for tag in tags]) & (kind == "s57")
    is_land &= (names != "point") & ~coast & ~under
    if shallow.any():
        remarks.append(f"{shallow.sum()} depth areas are shallower than --min-depth, and land")
    areas = is_land & (names == "area")
    ground = areas & np.array([tag.get("place") in _ISLAND for tag in tags])
    solid = [*shapes[areas & ~ground], *_wide(shapes, tags, is_land, choice, remarks)]
    sea = shapely.MultiPolygon()
    if coast.any() and not choice.water:
        lines = coastlines(shapes[coast], [tags[i] for i in np.flatnonzero(coast).tolist()])
        sea = seaward(lines, box, remarks)
    waters, known = shapes[is_water], is_water.any() or (coast.any() and not choice.water)
    if not known and (choice.water or kind == "s57" or not (solid or ground.any())):
        how = "; ".join(["give another crop, --water, --min-depth", *missing])
        raise UserError(f"place: no polygon is water there; {how}")
    if not known:
        remarks.append("no polygon of water and no coastline: all that is not land taken for water")
    water = _closed(shapely.union_all([*waters, sea])) if known else box
    islands = shapely.union_all(_without_lakes(shapes[ground], waters))
    water = shapely.difference(water, shapely.difference(islands, sea))  # coasts tell more of it
    water = shapely.intersection(shapely.difference(water, shapely.union_all(solid)), box)
    remarks += _dropped(tags, names, ~(is_water | is_land | coast | shallow))
    deep = is_water & np.isfinite(depth_m)
    return _areas(water), (shapes[deep], depth_m[deep]), remarks


def _without_lakes(islands: Shapes, waters: Shapes) -> list[Any]:
    """Islands without the waters that are smaller than they: those on them, not those around."""
    import shapely

    size = shapely.area(waters)
    return [
        shapely.difference(one, shapely.union_all(waters[size < shapely.area(one)]))
        for one in islands
    ]


def _closed(water: Any) -> Any:
    """Water without the slits that rounding leaves between neighbouring polygons."""
    import shapely

    wider = shapely.buffer(water, _SLIT_M, join_style="mitre")
    return shapely.buffer(wider, -_SLIT_M, join_style="mitre")


def _type(shape: Any) -> str:
    """Kind of a geometry: area, line or point; of a collection, the largest."""
    parts = {one.geom_type for one in getattr(shape, "geoms", [shape])} | {shape.geom_type}
    for name, some in (("area", _AREA), ("line", _LINE)):
        if parts & set(some):
            return name
    return "point"


def _areas(shape: Any) -> Any:
    """The polygons of a geometry, as one."""
    import shapely

    parts = [one for one in getattr(shape, "geoms", [shape]) if one.geom_type in _AREA]
    return shapely.union_all(parts) if len(parts) > 1 else shapely.MultiPolygon(parts)


def _fit(
    tags: Sequence[Mapping[str, str]], filters: Sequence[str], flag: str, usual: Sequence[Rule]
) -> NDArray[np.bool_]:
    """(feature,) whether it fits one of the filters, or of the usual rules if there are none."""
    found = np.zeros(len(tags), np.bool_)
    for key, value in [_rule(text, flag) for text in filters] or usual:
        fits = np.array([_fits(tag, (key, value)) for tag in tags])
        if filters and not fits.any():
            known = {one for tag in tags for one in tag}
            values = {tag[key] for tag in tags if key in tag}
            close = nearest(value, sorted(values)) if key in known else nearest(key, sorted(known))
            raise UserError(f"{flag} {key}{'=' * bool(value)}{value}: fits no feature; {close}")
        found |= fits
    return found


def _fits(tag: Mapping[str, str], rule: Rule) -> bool:
    key, value = rule
    return key in tag and value in ("", tag[key])


def _rule(text: str, flag: str) -> Rule:
    key, _, value = (part.strip() for part in text.partition("="))
    if not key or ("=" in text and not value):
        raise UserError(f"{flag} {text!r}: give KEY=VALUE, for example natural=water, or KEY")
    return key, value


def _keys(tags: Sequence[Mapping[str, str]]) -> str:
    known = Counter(key for tag in tags for key in tag)
    return ", ".join(key for key, _ in known.most_common(8))


def _depths(
    tags: Sequence[Mapping[str, str]], is_water: NDArray[np.bool_], choice: Choice
) -> NDArray[np.float64]:
    """(feature,) least depth of water and depth areas [m], NaN of all others."""
    charted = np.array([tag["layer"] in ("DEPARE", "DRGARE") for tag in tags])
    given = np.array([_metres(tag.get("DRVAL1", tag.get("depth"))) for tag in tags])
    depth_m = np.where(is_water | charted, given, np.nan)
    if choice.min_depth_m is not None and not np.isfinite(depth_m).any():
        raise UserError(
            f"--min-depth {choice.min_depth_m:g}: no water has a depth (DRVAL1), as that of "
            "S-57 charts, or a tag depth; leave it out"
        )
    return depth_m


def _wide(
    shapes: Shapes,
    tags: Sequence[Mapping[str, str]],
    is_land: NDArray[np.bool_],
    choice: Choice,
    remarks: list[str],
) -> Iterable[Any]:
    """Land lines as areas of their widths; a closed line is the area in it."""
    import shapely

    told: Counter[tuple[str, float]] = Counter()
    for i in np.flatnonzero(is_land).tolist():
        shape, tag = shapes[i], tags[i]
        if shape.geom_type not in _LINE:
            continue
        if shapely.is_closed(shape) and shape.geom_type == "LineString" and len(shape.coords) > 3:
            yield shapely.make_valid(shapely.Polygon(shape))
            if "man_made" in tag and tag.get("area") != "no":
                continue  # an outline, of no width
        name = tag.get("man_made") or _CATSLC.get(tag.get("CATSLC", ""), "") or tag["layer"]
        width = choice.pier_width_m or _number(tag.get("width")) or WIDTH_M.get(name, PIER_M)
        told[name, width] += 1
        yield shapely.buffer(shape, 0.5 * width, cap_style="flat", join_style="mitre")
    for (name, width), count in sorted(told.items()):
        remarks.append(f"{count} lines of {name} taken as {width:g} m wide (--pier-width)")


def _number(text: str | None) -> float:
    """A width in metres, or 0 if there is none."""
    width = _metres(text)
    return width if 0.0 < width < 1000.0 else 0.0


def _metres(text: str | None) -> float:
    """Metres of a tag, NaN if it has none."""
    try:
        return float((text or "nan").removesuffix("m").strip())
    except ValueError:
        return float("nan")


def _incomplete(areas: Sequence[Mapping[str, str]], choice: Choice) -> list[str]:
    """A line on the areas of water or land that an extract has not all of."""
    rules = [_rule(text, "--water") for text in choice.water] or list(WATER["osm"])
    rules += [_rule(text, "--land") for text in choice.land] or list(LAND["osm"])
    keys = [[key for key, value in rules if _fits(area, (key, value))] for area in areas]
    found = [(area, key[0]) for area, key in zip(areas, keys, strict=True) if key]
    if not found:
        return []
    some = "; ".join(f"relation {area['osm_id']}, {key}={area[key]}" for area, key in found[:3])
    return [
        f"areas that may be missing: {len(found)} ({some}); the extract lacks ways of "
        "their outlines; cut it with osmium extract --strategy smart"
    ]


def _dropped(
    tags: Sequence[Mapping[str, str]], names: NDArray[Any], left: NDArray[np.bool_]
) -> list[str]:
    """A line on the features that are neither water nor land."""
    some = Counter(f"{tags[i]['layer']} ({names[i]})" for i in np.flatnonzero(left).tolist())
    if not some:
        return []
    return ["left out: " + ", ".join(f"{count} {name}" for name, count in sorted(some.items()))]
