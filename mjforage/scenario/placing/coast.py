"""The sea beside coastlines, which OpenStreetMap draws with the land to their left."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Shapes = NDArray[np.object_]
_VOTE_M = 5.0  # of a coastline, that says on which side of it there is water
_TOUCH_M = 0.01  # between lines that meet
_BEYOND_M = 1.0  # by which lines are led beyond the border
_BACK = -0.8  # cosine of a turn with which a line would go back


def coastlines(shapes: Shapes, tags: Sequence[Mapping[str, str]]) -> Shapes:
    """(line,) the lines of coasts, each once, with the land to their left.

    Rings of ways stay as they are drawn, clockwise around water. Other areas are land.

    Parameters
    ----------
    shapes, tags : (coast,) lines and areas
    """
    import shapely

    found: list[Any] = []
    for shape, tag in zip(shapes, tags, strict=True):
        for part in shapely.get_parts(shape):
            if part.geom_type != "Polygon":
                found += [part] if part.geom_type in ("LineString", "LinearRing") else []
            elif tag.get("osm_way_id"):
                found.append(part.exterior)
            else:
                outer, *holes = shapely.get_rings(part)
                found.append(outer if outer.is_ccw else outer.reverse())
                found += [ring.reverse() if ring.is_ccw else ring for ring in holes]
    lines = np.array([shapely.LineString(one.coords) for one in found], dtype=object)
    return np.asarray(lines[np.unique(shapely.to_wkb(lines), return_index=True)[1]])


def seaward(lines: Shapes, box: Any, remarks: list[str]) -> Any:
    """Faces to the right of coastlines; lines that end in a box are led on.

    A box that no coastline touches is a part of the face that it lies in.
    """
    import shapely

    inside = shapely.intersects(lines, box).any()
    edges = [*_led_on(lines, box, remarks), shapely.boundary(box)] if inside else []
    net = shapely.union_all([*lines, *edges])
    faces = np.array(shapely.get_parts(shapely.polygonize([*shapely.get_parts(net)])))
    parts = shapely.get_parts(shapely.segmentize(lines, _VOTE_M))
    ends = [shapely.get_coordinates(part) for part in parts]
    start, end = (np.concatenate([xy[cut] for xy in ends]) for cut in (slice(-1), slice(1, None)))
    way = end - start
    length = np.hypot(*way.T)
    start, way, length = start[length > 0], way[length > 0], length[length > 0]
    off = np.stack((way[:, 1], -way[:, 0]), axis=-1) / length[:, None] * 0.01  # to the right [m]
    votes, tree = np.zeros((2, len(faces))), shapely.STRtree(faces)
    for side, sign in enumerate((1.0, -1.0)):
        points = shapely.points(start + 0.5 * way + sign * off)
        which, face = tree.query(points, predicate="within")
        np.add.at(votes[side], face, length[which])
    sea, land = votes
    if (torn := (np.minimum(sea, land) > 0.2 * np.maximum(sea, land))).any():
        remarks.append(
            f"{torn.sum()} faces have coastlines of both senses, perhaps for one that ends inside "
            "the crop; look at harbour.png, and give a crop that all coastlines leave"
        )
    return shapely.union_all(faces[sea > land])


def _led_on(lines: Shapes, box: Any, remarks: list[str]) -> list[Any]:
    """Straight lines from where coastlines end in a box, as extracts cut them: to the start of
    another, or to the border, the shortest first.
    """
    import shapely

    whole = shapely.get_parts(shapely.line_merge(shapely.MultiLineString(list(lines)), True))
    tree, wider = shapely.STRtree(whole), shapely.buffer(box, _BEYOND_M, join_style="mitre")

    def loose(place: int) -> list[_End]:
        points = shapely.get_point(whole, place)
        near, _ = tree.query(points, predicate="dwithin", distance=_TOUCH_M)
        ends = (np.bincount(near, minlength=len(points)) == 1) & ~shapely.is_closed(whole)
        ends &= shapely.covers(wider, points)
        inner = shapely.get_point(whole, place + (1 if place == 0 else -1))
        return [_End(*shapely.get_coordinates([points[i], inner[i]])) for i in np.flatnonzero(ends)]

    first, last = loose(0), loose(-1)
    ways = [(1.0, one, one, _border(one, wider.bounds)) for one in (*first, *last)]
    ways += [(0.5, one, other, other.at) for one in last for other in first]  # saves two ways
    found: list[Any] = []
    done: set[int] = set()
    for _, one, other, to in sorted(ways, key=lambda way: way[0] * np.hypot(*(way[3] - way[1].at))):
        if not done & {id(one), id(other)}:
            found.append(shapely.LineString([one.at, to]))
            done |= {id(one), id(other)}
    far = [one for one in found if shapely.length(one) > 2.0 * _BEYOND_M]
    if far:
        remarks.append(
            f"{len(far)} gaps in coastlines, or between one and the border, of up to "
            f"{max(shapely.length(far)):.0f} m were closed by straight lines; look at harbour.png"
        )
    return found


class _End(NamedTuple):
    """Loose end of a coastline, and the point before it."""

    at: NDArray[np.float64]
    before: NDArray[np.float64]


def _border(end: _End, bounds: Sequence[float]) -> NDArray[np.float64]:
    """The nearest point on the border that does not lie back along the line."""
    west, south, east, north = bounds
    x, y = end.at
    sides = np.array([(west, y), (east, y), (x, south), (x, north)])
    way, came = sides - end.at, end.at - end.before
    length = np.hypot(*way.T)
    ahead = way @ came / np.maximum(length * np.hypot(*came), 1e-9)
    return np.asarray(sides[np.where(ahead > _BACK, length, np.inf).argmin()])
