"""Tracks as NetCDF, by the conventions for Climate and Forecast data (CF 1.8, trajectories)."""

import numpy as np

from mjforage.base.extras import require
from mjforage.forcing.record_files import utc
from mjforage.mission.setup import Setup
from mjforage.runs.episode_recording import Recording
from mjforage.runs.exporting.tracks import Tracks


def netcdf_files(setup: Setup, recording: Recording) -> dict[str, bytes]:
    """`episode.nc`: a trajectory per vessel and item, an observation per frame (CF 1.8, H.4.1).

    What an item lacks while it is not on the water is a missing value.
    """
    require("format netcdf", "xarray")
    import xarray as xr

    tracks, both, each = Tracks(setup, recording), ("trajectory", "obs"), "trajectory"
    there, vessels, place = tracks.present.T, tracks.vessels, tracks.place
    heading, items = np.full(there.shape, np.nan), np.full((2, len(there)), np.nan)
    heading[:vessels] = tracks.heading_deg.T
    items[:, vessels:] = tracks.discovered_s, tracks.collected_s
    kind = (np.arange(len(there)) >= vessels).astype(np.int8)
    x, y = np.where(there, tracks.xy_m.T, np.nan)
    since = f"seconds since {utc(tracks.begins_s)[:-1].replace('T', ' ')}"
    coordinates = {
        "time": (both, np.where(there, tracks.t_s, np.nan), _TIME | {"units": since}),
        "x": (both, x, {"units": "m", "long_name": f"distance right along a row {_FROM}"}),
        "y": (both, y, {"units": "m", "long_name": f"distance up along a column {_FROM}"}),
    }
    if tracks.latlon is not None:
        lat, lon = np.where(there, tracks.latlon.T, np.nan)
        coordinates |= {"lat": (both, lat, _LATITUDE), "lon": (both, lon, _LONGITUDE)}
    name = np.array(tracks.names, "S")
    data = xr.Dataset(
        {
            "name": (each, name, {"cf_role": "trajectory_id", "long_name": "name of the body"}),
            "kind": (each, kind, _KIND),
            "heading": (both, heading, _HEADING if place else _TURN),
            "discovered": (each, items[0], _UNTIL | {"long_name": "time of an item's discovery"}),
            "collected": (each, items[1], _UNTIL | {"long_name": "time of an item's collection"}),
        },
        coordinates,
        {
            "Conventions": "CF-1.8",
            "featureType": "trajectory",
            "title": f"{setup.scenario.name}, episode {recording.episode} of seed {recording.seed}",
            "institution": "not stated",
            "source": f"mjforage: {recording.policy or 'no policy'} in world {recording.world}",
            "history": "written by mjforage export",
            "references": "https://cfconventions.org",
            "comment": f"licence of the map: {place.licence if place else 'not stated'}",
        },
    )
    return {"episode.nc": bytes(data.to_netcdf(format="NETCDF3_64BIT"))}


_FROM = "from the centre of the south-west cell"
_TIME = {
    "standard_name": "time",
    "long_name": "time",
    "axis": "T",
    "calendar": "standard",
}
_LATITUDE, _LONGITUDE = (
    {"standard_name": word, "long_name": f"{word} (WGS 84)", "units": f"degrees_{to}", "axis": axis}
    for word, to, axis in (("latitude", "north", "Y"), ("longitude", "east", "X"))
)
_TURN = {"units": "degree", "long_name": "direction of the bow, clockwise from y"}
_HEADING = {
    "units": "degree",
    "standard_name": "platform_orientation",
    "long_name": "bearing of the bow, clockwise from true north",
}
_KIND = {
    "long_name": "kind of the body",
    "flag_values": np.array([0, 1], np.int8),
    "flag_meanings": "vessel item",
}
_UNTIL = {"units": "s", "comment": "from the start of the episode; missing if never"}
