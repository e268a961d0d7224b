"""Records in NetCDF by the names of the CF conventions, and ERA5's where it has none."""

import re
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.base.extras import require

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
_ERA5 = {"u10": "eastward_wind", "v10": "northward_wind"}
_ALONG_GRID = "x_wind", "y_wind", "sea_water_x_velocity", "sea_water_y_velocity"
_ZONE = re.compile(r"[0-9 ](?!UTC|GMT|Z$|T[0-9])[A-Z]{2,5}$")  # a zone by its name
Parts = tuple[FloatArray, dict[str, FloatArray], FloatArray, FloatArray]


def netcdf_parts(path: Path, classic: bool, name: str) -> Parts:
    """Times since 1970 [s], velocities (time, row, column, 2) by part, latitudes and longitudes.

    Raises
    ------
    UserError
        If the file cannot be read or its grid, units or names are not such as these.
    """
    require(name, "xarray", *(() if classic else ("h5netcdf",)))
    import xarray

    try:
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
    found: dict[str, tuple[Any, Any]] = {}
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
    for parts in found.values():
        own = parts[0]
        alike = own.dims == grid.dims and own.shape == grid.shape
        if not alike or any((own[axis].values != grid[axis].values).any() for axis in grid.dims):
            raise UserError(f"{name}: wind and current are on different grids; give one of them")
    since = str(grid[grid.dims[0]].encoding.get("units", ""))
    if _ZONE.search(since):
        raise UserError(f"{name}: its time is in {since!r}; give times in UTC")
    times = grid[grid.dims[0]].values
    if not np.issubdtype(times.dtype, np.datetime64):
        raise UserError(f"{name}: its time has no units such as hours since 1900-01-01")
    latitude, longitude = (
        np.asarray(grid[axis].values, np.float64) if axis in grid.dims else np.zeros(1)
        for axis in ("latitude", "longitude")
    )
    for axis, degrees in (("latitude", latitude), ("longitude", longitude)):
        step = np.diff(degrees)
        if degrees.size > 1 and not np.allclose(step, step[0], rtol=1e-3):
            raise UserError(
                f"{name}: its {axis} is not evenly spaced; regrid it, as with cdo remapbil"
            )
    seconds = times.astype("datetime64[ms]").astype(np.float64) / 1000.0
    return seconds, {part: _stacked(pair) for part, pair in found.items()}, latitude, longitude


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


def _stacked(pair: tuple[Any, Any]) -> FloatArray:
    """(time, row, column, 2); what is missing at all times, land, has the nearest value."""
    east, north = (np.asarray(one.values, np.float64) for one in pair)
    values = np.stack((east, north), axis=-1)
    for axis, kind in ((1, "latitude"), (2, "longitude")):
        if kind not in pair[0].dims:
            values = np.expand_dims(values, axis)
    land = np.isnan(values).any(axis=-1).all(axis=0)
    if land.any() and not land.all():
        from scipy import ndimage

        find: Any = ndimage.distance_transform_edt
        row, column = find(land, return_distances=False, return_indices=True)
        values = values[:, row, column]
    return values
