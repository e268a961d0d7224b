"""Records in NetCDF by the names of the CF conventions, and ERA5's where it has none."""

import re
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.base.extras import require
from mjforage.forcing.record_content import MEANS_OVER_GUSTS, Content, intensity

FloatArray = NDArray[np.float64]
_MPS = {
    **dict.fromkeys(("m s-1", "m/s", "m s**-1", "m.s-1", "meter second-1", "m s^-1"), 1.0),
    **dict.fromkeys(("knot", "knots", "kt", "kn", "kts"), 1852.0 / 3600.0),
    **dict.fromkeys(("km h-1", "km/h", "km hr-1", "km h**-1"), 1.0 / 3.6),
    **dict.fromkeys(("cm s-1", "cm/s"), 0.01),
}
_COMPONENTS = {
    "wind": ("eastward_wind", "northward_wind"),
    "current": ("eastward_sea_water_velocity", "northward_sea_water_velocity"),
}
_POLAR = {
    "wind": ("wind_speed", ("wind_from_direction", "wind_to_direction")),
    "current": ("sea_water_speed", ("sea_water_to_direction", "sea_water_from_direction")),
}
_GUST = "wind_speed_of_gust"
_ERA5 = {"u10": "eastward_wind", "v10": "northward_wind", "i10fg": _GUST}
_SHORT = {"lat": "latitude", "lon": "longitude"}
_METRES = "m", "metre", "meter", "metres", "meters"
_ALONG_GRID = "x_wind", "y_wind", "sea_water_x_velocity", "sea_water_y_velocity"
_ZONE = re.compile(r"[0-9 ](?!UTC|GMT|Z$|T[0-9])[A-Z]{2,5}$")  # a zone by its name
_LOWEST_M, _HIGHEST_M = 0.5, 200.0  # of a recorded wind


def _check_root(path: Path) -> None:
    """Raise as h5py does if a file's root is damaged, of which h5netcdf leaves a traceback."""
    import h5py

    with h5py.File(path) as file:
        file.attrs.get("_nc3_strict")


def netcdf_parts(path: Path, classic: bool, name: str) -> Content:
    """Content of a file: velocities (time, row, column, 2) by part, and what is known of them.

    Raises `UserError` if the file cannot be read or its grid, units or names are not such as these.
    """
    require(name, "xarray", *(() if classic else ("h5netcdf", "h5py")))
    import xarray

    try:
        if not classic:
            _check_root(path)
        with xarray.open_dataset(path, engine="scipy" if classic else "h5netcdf") as opened:
            data = opened.load()
    except (OSError, ValueError, LookupError, TypeError, AttributeError, RuntimeError) as error:
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise UserError(f"{name}: is no NetCDF file that can be read ({reason})") from error
    fields: dict[str, Any] = {}
    for key, one in data.data_vars.items():
        if (known := _standard(str(key), one)) in fields:
            raise UserError(
                f"{name}: has {known} twice, {fields[known].name} and {key}; keep one of them, for "
                "example with ncks"
            )
        fields[known] = one
    if askew := sorted(set(fields) & set(_ALONG_GRID)):
        raise UserError(
            f"{name}: has velocities along the axes of its grid ({', '.join(askew)}); "
            "rotate them to east and north, for example with cdo rotuvb"
        )
    found: dict[str, tuple[Any, ...]] = {}
    for part, names in _COMPONENTS.items():
        if all(key in fields for key in names):
            east, north = (fields[key] for key in names)
            if east.dims != north.dims:
                raise UserError(
                    f"{name}: {names[0]} and {names[1]} are on different points (a staggered "
                    "grid); bring them to one, for example with xgcm"
                )
            found[part] = (
                _speed(_regular(east, name), name),
                _speed(_regular(north, name), name),
            )
        elif (speed := _POLAR[part][0]) in fields:
            for number, bearing in enumerate(_POLAR[part][1]):
                if bearing in fields:
                    fast = _speed(_regular(fields[speed], name), name)
                    if (fast < 0.0).any():
                        raise UserError(f"{name}: {speed} below 0; check its missing values")
                    angle = np.radians(_degrees(_regular(fields[bearing], name), name))
                    sign = -1.0 if (part == "wind") == (number == 0) else 1.0
                    found[part] = sign * fast * np.sin(angle), sign * fast * np.cos(angle)
    if not found:
        known = ", ".join(sorted(fields))[:80]
        raise UserError(f"{name}: has neither wind nor current by a CF standard name, but {known}")
    grid = next(iter(found.values()))[0]
    if "wind" in found and _GUST in fields:
        found["gusts"] = (_speed(_regular(fields[_GUST], name), name),)
    for part, each in found.items():
        own = each[0]
        alike = own.dims == grid.dims and own.shape == grid.shape
        if not alike or any((own[axis].values != grid[axis].values).any() for axis in grid.dims):
            raise UserError(f"{name}: wind and {part} are on different grids; give one of them")
    since = str(grid[grid.dims[0]].encoding.get("units", ""))
    if _ZONE.search(since):
        raise UserError(f"{name}: its time is in {since!r}; give times in UTC")
    times = grid[grid.dims[0]].values
    if not np.issubdtype(times.dtype, np.datetime64):
        raise UserError(f"{name}: its time has no units such as hours since 1900-01-01")
    latitude, longitude = (
        np.asarray(grid[axis].values, np.float64) if axis in grid.dims else _alone(data, axis)
        for axis in ("latitude", "longitude")
    )
    order, longitude = _unrolled(longitude)
    if "longitude" in grid.dims:
        found = {part: tuple(one.isel(longitude=order) for one in found[part]) for part in found}
    for axis, degrees in (("latitude", latitude), ("longitude", longitude)):
        step = np.diff(degrees)
        if degrees.size > 1 and not np.allclose(step, step[0], rtol=1e-3):
            raise UserError(
                f"{name}: its {axis} is not evenly spaced; regrid it, as with cdo remapbil"
            )
    seconds = times.astype("datetime64[ms]").astype(np.float64) / 1000.0
    parts = {part: _stacked(each) for part, each in found.items()}
    if "gusts" in parts:
        gust = parts["gusts"][..., 0]
        parts["gusts"] = intensity(gust, parts["wind"], MEANS_OVER_GUSTS[0])
    height_m = _height_m(fields, name) if "wind" in parts else None
    return Content(seconds, parts, latitude, longitude, height_m)


def _alone(data: Any, axis: str) -> FloatArray:
    """(1,) latitude or longitude of a file of one of them; NaN if it is not told."""
    for key, one in data.variables.items():
        if one.size == 1 and axis in (one.attrs.get("standard_name"), key, _SHORT.get(str(key))):
            return np.asarray(one.values, np.float64).reshape(1)
    return np.full(1, np.nan)


def _unrolled(longitude: FloatArray) -> tuple[NDArray[np.intp], FloatArray]:
    """Order in which longitudes ascend without a jump, wherever they are cut, and they themselves.

    A whole circle goes on at both ends, so that all places are within it.
    """
    if longitude.size == 1:
        return np.zeros(1, np.intp), longitude
    circle, order = np.unique(longitude % 360.0, return_index=True)
    gaps = np.diff(circle, append=circle[0] + 360.0)
    first = 0 if _whole(gaps) else (int(gaps.argmax()) + 1) % circle.size
    place = np.arange(first - _whole(gaps), first + circle.size + 2 * _whole(gaps))
    turns, place = np.divmod(place, circle.size)
    return order[place], circle[place] + 360.0 * turns


def _whole(gaps: FloatArray) -> bool:
    return bool(gaps.max() < 1.5 * gaps.min())


def _height_m(fields: dict[str, Any], name: str) -> float | None:
    """Height of the wind above the water, a coordinate of one value; None if it is not told."""
    wind = next(fields[key] for key in ("eastward_wind", "wind_speed") if key in fields)
    known = {
        str(key): one
        for key, one in wind.coords.items()
        if one.size == 1 and "height" in (key, one.attrs.get("standard_name"))
    }
    own = str(wind.encoding.get("coordinates", "")).split()  # xarray gives it those of others too
    for key in sorted(known, key=lambda key: (key not in own, key != "height")):
        units, height_m = (
            known[key].attrs.get("units", "m"),
            float(known[key].values.reshape(-1)[0]),
        )
        if units not in _METRES or not _LOWEST_M <= height_m <= _HIGHEST_M:
            raise UserError(
                f"{name}: its wind is at a height of {height_m:g} {units}; give {_LOWEST_M:g} to "
                f"{_HIGHEST_M:g} m"
            )
        return height_m
    return None


def _standard(key: str, field: Any) -> str:
    """Standard name of a field, its own where it has none."""
    known = str(field.attrs.get("standard_name", ""))
    return known if known not in ("", "unknown") else _ERA5.get(key, key)


def _regular(field: Any, name: str) -> Any:
    """A field over time, and latitude and longitude if it is a grid, all ascending."""
    for wanted, others in (
        ("time", ("valid_time",)),
        ("latitude", ("lat",)),
        ("longitude", ("lon",)),
    ):
        for other in others:
            if other in field.coords and wanted not in field.dims and other in field.dims:
                if wanted in field.coords:
                    field = field.drop_vars(wanted)
                field = field.rename({other: wanted})
    if "expver" in field.dims:  # final and preliminary values of ERA5, one where the other is not
        final, *later = (field.isel(expver=i, drop=True) for i in range(field.sizes["expver"]))
        for one in later:
            final = final.combine_first(one)
        field = final
    kept = ("time", "latitude", "longitude")
    field = field.squeeze(
        [d for d in field.dims if d not in kept and field.sizes[d] == 1], drop=True
    )
    if any(one.ndim == 2 for key, one in field.coords.items() if str(key)[:3] in ("lat", "lon")):
        raise UserError(
            f"{name}: its latitude has two dimensions (a rotated or curvilinear grid); bring it to "
            "a regular one, for example with cdo remapbil"
        )
    if left := [str(d) for d in field.dims if d not in kept]:
        raise UserError(
            f"{name}: has a dimension {left[0]} of {field.sizes[left[0]]}; choose one of them, for "
            "example with ncks"
        )
    if "time" not in field.dims:
        raise UserError(f"{name}: has no dimension time or valid_time")
    field = field.transpose(*[axis for axis in kept if axis in field.dims])
    return field.sortby([axis for axis in kept if axis in field.dims])


def _speed(field: Any, name: str) -> Any:
    """A speed in m/s, by its units."""
    units = str(field.attrs.get("units", "")).strip()
    if units not in _MPS:
        raise UserError(
            f"{name}: units {units!r} of a speed are not known; give m s-1, knots or km/h"
        )
    return field * _MPS[units]


def _degrees(field: Any, name: str) -> Any:
    units = str(field.attrs.get("units", "degree")).strip()
    if not units.startswith("deg"):
        raise UserError(f"{name}: units {units!r} of a direction; give degree")
    return field


def _stacked(fields: tuple[Any, ...]) -> FloatArray:
    """(time, row, column, field); what is missing at all times, land, has the nearest value."""
    values = np.stack([np.asarray(one.values, np.float64) for one in fields], axis=-1)
    for axis, kind in ((1, "latitude"), (2, "longitude")):
        if kind not in fields[0].dims:
            values = np.expand_dims(values, axis)
    land = np.isnan(values).any(axis=-1).all(axis=0)
    if land.any() and not land.all():
        from scipy import ndimage

        find: Any = ndimage.distance_transform_edt
        row, column = find(land, return_distances=False, return_indices=True)
        values = values[:, row, column]
    return values
