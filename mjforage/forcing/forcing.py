"""Wind and current at points, for a batch of episodes."""

import math
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mjforage.base.compiled import BoundKernel, kernel
from mjforage.base.device import Bind, Call, Launch
from mjforage.base.errors import UserError
from mjforage.base.randomness import Stream, UInt64Array, stream_key
from mjforage.base.wholes import floor
from mjforage.forcing.flow import OPEN_SEA, Flow, flow_in
from mjforage.forcing.gauss_markov import gauss_markov_pair
from mjforage.forcing.item_noise import item_noise
from mjforage.forcing.record import (
    NO_RECORD,
    Record,
    on_map,
    recorded_velocity,
    rise_of,
    starts_of,
)
from mjforage.forcing.record_files import read_record
from mjforage.forcing.shelter import NO_SHELTER, Shelter, shelter_of, wind_share
from mjforage.forcing.steady import LEEWAY, steady_current, steady_wind, to_rc
from mjforage.forcing.stream_element import stream_velocity
from mjforage.graph_planner.graph.navigation import NavigationGraph
from mjforage.scenario.place import Place, north_deg
from mjforage.scenario.scenario import Scenario, Weather

FloatArray = NDArray[np.float64]

CROSSWIND_RATIO = 0.8  # gusts across the wind over those along it (IEC 61400-1, annex B)
WANDER_TAU_S = 600.0  # correlation time of the wandering current; an estimate
_DIGITS = 6  # of a leeway over the paper's, which the areas of a class give no better
_EARLY = 1e-6  # periods; a time this little before a period's start counts as in it


@kernel
def _stream_keys(keys: UInt64Array, stream: int) -> UInt64Array:
    """(episode,) key of one stream of each episode."""
    result = np.empty_like(keys)
    for e in range(keys.size):
        result[e] = stream_key(keys[e], stream)
    return result


@kernel
def _wind(
    mean: FloatArray,
    gust_keys: UInt64Array,
    intensity: float,
    tau_s: float,
    shelter: Shelter,
    record: Record,
    t_s: FloatArray,
    xy: FloatArray,
    out: FloatArray,
) -> None:
    """Write mean wind and gusts along and across it, weaker in the lee: (episode, point, 2) [m/s].

    An intensity that is NaN is the record's own.
    """
    recorded, own = record.times_s.size > 0, math.isnan(intensity)
    for e in range(xy.shape[0]):
        u, v = mean[e, 0], mean[e, 1]
        ahead = beside = 0.0
        if own or (intensity > 0.0 and (recorded or u * u + v * v > 0.0)):
            ahead, beside = gauss_markov_pair(gust_keys[e], t_s[e] / tau_s)
        along, aside = 1.0 + intensity * ahead, intensity * CROSSWIND_RATIO * beside
        wind_u, wind_v = along * u - aside * v, along * v + aside * u
        for p in range(xy.shape[1]):
            share = 1.0
            if recorded:
                u, v, gusts = recorded_velocity(record, e, t_s[e], xy[e, p, 0], xy[e, p, 1])
                if own:
                    along, aside = 1.0 + gusts * ahead, gusts * CROSSWIND_RATIO * beside
                wind_u, wind_v = along * u - aside * v, along * v + aside * u
            if shelter.length_m > 0.0:
                share = wind_share(shelter, xy[e, p, 0], xy[e, p, 1], u, v)
            out[e, p, 0], out[e, p, 1] = share * wind_u, share * wind_v


@kernel
def _sheltered(xy: FloatArray, mean: FloatArray, shelter: Shelter) -> FloatArray:
    """Share of the mean wind that is left, (episode, point)."""
    out = np.ones(xy.shape[:2])
    if shelter.length_m > 0.0:
        for e in range(xy.shape[0]):
            for p in range(xy.shape[1]):
                out[e, p] = wind_share(shelter, xy[e, p, 0], xy[e, p, 1], mean[e, 0], mean[e, 1])
    return out


@kernel
def _current(
    mean: FloatArray,
    keys: UInt64Array,
    wander: float,
    peak: float,
    patches: FloatArray,
    spacing_m: float,
    corner_m: float,
    record: Record,
    t_s: FloatArray,
    xy: FloatArray,
    out: FloatArray,
) -> None:
    """Write streams and circulation at points, (episode, point, 2) [m/s].

    Where a recorded current differs from place to place, each has the stream of its own.
    """
    for e in range(xy.shape[0]):
        free_u, free_v = mean[e, 0], mean[e, 1]
        if wander > 0.0:
            wander_u, wander_v = gauss_markov_pair(keys[e], t_s[e] / WANDER_TAU_S)
            free_u, free_v = free_u + wander * wander_u, free_v + wander * wander_v
        for p in range(xy.shape[1]):
            u, v = free_u, free_v
            if record.times_s.size > 0:
                more_u, more_v, _ = recorded_velocity(record, e, t_s[e], xy[e, p, 0], xy[e, p, 1])
                u, v = free_u + more_u, free_v + more_v
            if patches.size:
                out[e, p, 0], out[e, p, 1] = stream_velocity(
                    patches, spacing_m, corner_m, xy[e, p, 0], xy[e, p, 1], u, v, peak
                )
            else:
                out[e, p, 0], out[e, p, 1] = u, v


@kernel
def _item_noise(
    keys: UInt64Array, reach: float, period_s: float, t_s: FloatArray, out: FloatArray
) -> None:
    """Write the paper's noise of the period that is on, as (x, y), (episode, item, 2) [m/s]."""
    for e in range(t_s.size):
        step = floor(t_s[e] / period_s + _EARLY) + 1  # the graph's steps count from 1
        for k in range(out.shape[1]):
            row, col = item_noise(keys[e], k, step)
            out[e, k, 0], out[e, k, 1] = reach * col, -reach * row


WIND = Launch(_wind, shared="shelter times_s record.velocity cell")
CURRENT = Launch(_current, shared="patches times_s record.velocity cell")
ITEM_NOISE = Launch(_item_noise)


class WindAndWater(NamedTuple):
    """Velocities over ground, (..., 2) in (x, y) [m/s]."""

    wind: FloatArray
    current: FloatArray


@dataclass(frozen=True, eq=False)
class Forcing:
    """Wind and water of a batch of episodes; make one with `Forcing.create`.

    Every query takes `t_s`, the time since the start of the episode [s], one for all or
    (episode,), and gives the same bits whatever else is asked, before, after or beside it.

    Attributes
    ----------
    weather, graph : as requested; the map, None for the open sea
    node_mps : speed of a node per decision [m/s]
    period_s : of a decision
    drift_rc : (episode, 2) drift of an item of the paper's leeway by the mean wind [node/step]
    mean_wind_mps : (episode, 2) wind without gusts [m/s]
    mean_current_mps : (episode, 2) constant part of the free stream [m/s]
    """

    weather: Weather
    graph: NavigationGraph | None
    node_mps: float
    period_s: float
    drift_rc: FloatArray
    mean_wind_mps: FloatArray
    mean_current_mps: FloatArray
    _gust_keys: UInt64Array
    _current_keys: UInt64Array
    _noise_keys: UInt64Array
    _flow: Flow
    _shelter: Shelter
    _winds: Record
    _currents: Record
    _wind: BoundKernel[None] = field(init=False)
    _mean_wind: BoundKernel[None] = field(init=False)
    _free_wind: BoundKernel[None] = field(init=False)
    _free_mean: BoundKernel[None] = field(init=False)
    _stream: BoundKernel[None] = field(init=False)
    _current: BoundKernel[None] = field(init=False)
    _item_noise: BoundKernel[None] = field(init=False)

    @classmethod
    def create(
        cls,
        weather: Weather,
        keys: UInt64Array,
        graph: NavigationGraph | None = None,
        period_s: float = 1.0,
        place: Place | None = None,
        long_s: float = 0.0,
    ) -> "Forcing":
        """Draw wind and water of a batch of episodes.

        Raises `UserError` as `flow_in`, and for a record that cannot be read, is too short or
        elsewhere.

        Parameters
        ----------
        keys : (episode,) episode keys
        graph : the map; None: the open sea, where a node is 1 m
        period_s : of a decision, for drift and noise in nodes
        place : where on the globe the map is, if it is a place
        long_s : the longest episode, for which a record has to last
        """
        north, winds, currents = north_deg(place), NO_RECORD, NO_RECORD
        if weather.file is not None:
            recorded = read_record(weather.file)
            starts = starts_of(recorded, weather.start, keys, long_s)
            about = starts, graph, place
            winds = on_map(recorded, "wind", *about, rise_of(recorded, weather))
            currents = on_map(recorded, "current", *about)
            if winds is not NO_RECORD and weather.wind_speed_mps is not None:
                raise UserError(
                    f"weather.wind_speed_mps = {weather.wind_speed_mps:g}: {recorded.name} has the "
                    "wind; leave out one of them"
                )
        keys = np.ascontiguousarray(keys, np.uint64)
        node_mps = (1.0 if graph is None else graph.pitch_m) / period_s
        wind = steady_wind(keys, weather, node_mps, north)
        return cls(
            weather,
            graph,
            node_mps,
            period_s,
            wind.drift_rc,
            wind.wind_mps,
            steady_current(keys, weather, north),
            _stream_keys(keys, Stream.GUSTS),
            _stream_keys(keys, Stream.CURRENT),
            _stream_keys(keys, Stream.NOISE),
            flow_in(weather, graph, currents is not NO_RECORD),
            NO_SHELTER if graph is None else shelter_of(graph, weather.shelter_height_m),
            winds,
            currents,
        )

    @classmethod
    def of(
        cls,
        scenario: Scenario,
        keys: UInt64Array,
        graph: NavigationGraph,
        place: Place | None = None,
    ) -> "Forcing":
        """That of a scenario; parameters and errors as of `create`."""
        about = graph, scenario.period_s, place, scenario.period_s * scenario.horizon
        return cls.create(scenario.weather, keys, *about)

    def __post_init__(self) -> None:
        weather, flow = self.weather, self._flow
        own = math.nan if self._winds.velocity.shape[-1] > 2 else 0.0
        intensity = own if weather.gust_intensity is None else weather.gust_intensity
        gusts = self._gust_keys, intensity, weather.gust_tau_s
        none, mean = (self._gust_keys, 0.0, 1.0), self.mean_wind_mps
        wander = self.mean_current_mps, self._current_keys, weather.current_wander_mps
        streams = flow.patches, flow.spacing_m, flow.corner_m
        at_sea, turning = (OPEN_SEA.patches, 1.0, 0.0), weather.circulation_mps
        noise = self._noise_keys, weather.noise_node_per_step * self.node_mps, self.period_s
        bound = {
            "_wind": BoundKernel(_wind, mean, *gusts, self._shelter, self._winds),
            "_mean_wind": BoundKernel(_wind, mean, *none, self._shelter, self._winds),
            "_free_wind": BoundKernel(_wind, mean, *gusts, NO_SHELTER, self._winds),
            "_free_mean": BoundKernel(_wind, mean, *none, NO_SHELTER, self._winds),
            "_stream": BoundKernel(_current, *wander, 0.0, *at_sea, self._currents),
            "_current": BoundKernel(_current, *wander, turning, *streams, self._currents),
            "_item_noise": BoundKernel(_item_noise, *noise),
        }
        for name, query in bound.items():
            object.__setattr__(self, name, query)

    def __len__(self) -> int:
        return int(self.mean_wind_mps.shape[0])

    def carried_rc(self, t_s: ArrayLike, rc: FloatArray, leeway: FloatArray | float) -> FloatArray:
        """Steady velocity of items in the mean wind, weaker in the lee, and in the current.

        An item that has share L of the wind in still water has L of the wind and 1 - L of a
        current, whatever their directions: its drags balance there.

        Returns: (episode, place, 2) [node/step].

        Parameters
        ----------
        rc : (episode, place, 2) where, on a map [node]
        leeway : (episode, place) share of the wind, or one for all
        """
        assert self.graph is not None
        xy, leeway = self.graph.metres(rc), np.broadcast_to(np.float64(leeway), rc.shape[:2])
        current_rc = to_rc(self.current(t_s, xy)) * self.period_s / self.graph.pitch_m
        if self._winds is NO_RECORD:
            shares = np.round(leeway / LEEWAY, _DIGITS) * self.sheltered(xy)
            by_wind = shares[..., None] * self.drift_rc[:, None]
        else:
            wind = self._ask(self._mean_wind, t_s, xy)
            by_wind = leeway[..., None] * to_rc(wind) / self.node_mps
        result: FloatArray = by_wind + (1.0 - leeway)[..., None] * current_rc
        return result

    def _times(self, t_s: ArrayLike) -> FloatArray:
        return np.ascontiguousarray(np.broadcast_to(np.asarray(t_s, np.float64), (len(self),)))

    def _ask(self, query: BoundKernel[None], t_s: ArrayLike, xy: FloatArray) -> FloatArray:
        """The answer of a kernel at points (episode, point, 2) [m], of the same shape."""
        out = np.empty(xy.shape)
        query(self._times(t_s), np.ascontiguousarray(xy, np.float64), out)
        return out

    def at(self, t_s: ArrayLike, xy: FloatArray) -> WindAndWater:
        """Wind and current at points (episode, point, 2) [m]."""
        return WindAndWater(self.wind(t_s, xy), self.current(t_s, xy))

    def open_water(self, t_s: ArrayLike, gusts: bool = True) -> WindAndWater:
        """Free wind and free stream (episode, 2): without lee, quays and circulation, and in the
        middle of the map.
        """
        middle = np.zeros(2)
        if self.graph is not None:
            middle = self.graph.metres(0.5 * (np.array(self.graph.shape) - 1.0))
        there = np.tile(middle, (len(self), 1, 1))
        wind = self._ask(self._free_wind if gusts else self._free_mean, t_s, there)
        return WindAndWater(wind[:, 0], self._ask(self._stream, t_s, there)[:, 0])

    def wind(self, t_s: ArrayLike, xy: FloatArray) -> FloatArray:
        """Wind over ground at points (episode, point, 2) [m], of the same shape [m/s].

        Gusts are Ornstein-Uhlenbeck processes of `gust_tau_s` along and across the mean wind, the
        same at every point. In the lee of land mean wind and gusts are weaker by one factor.
        """
        return self._ask(self._wind, t_s, xy)

    def sheltered(self, xy: FloatArray) -> FloatArray:
        """Share (episode, point) of the mean wind that land leaves at points (episode, point, 2).

        It is 1 in the open.
        """
        return _sheltered(np.ascontiguousarray(xy, np.float64), self.mean_wind_mps, self._shelter)

    def current(self, t_s: ArrayLike, xy: FloatArray) -> FloatArray:
        """Velocity of the water over ground at points (episode, point, 2) [m], alike [m/s].

        Streams and circulation, which no quay lets through.
        """
        return self._ask(self._current, t_s, xy)

    def on_device(
        self, bind: Bind, t_s: FloatArray, xy: FloatArray, wind: FloatArray, current: FloatArray
    ) -> tuple[Call, ...]:
        """Kernels that write wind and current (episode, point, 2) [m/s], as `at`.

        Parameters
        ----------
        t_s : (episode,) [s]
        xy : (episode, point, 2 or more) [m]
        """
        return (
            bind(WIND, *self._wind.fixed, t_s, xy, wind),
            bind(CURRENT, *self._current.fixed, t_s, xy, current),
        )

    def noise_on_device(self, bind: Bind, t_s: FloatArray, noise: FloatArray) -> Call:
        """A kernel that writes `item_noise` (episode, item, 2) [m/s]."""
        return bind(ITEM_NOISE, *self._item_noise.fixed, t_s, noise)

    def item_noise(self, t_s: ArrayLike, items: int) -> FloatArray:
        """Velocity (episode, item, 2) [m/s] that an item's own water adds to the current.

        It is constant for a decision: decision n starts at n `period_s` and has the draws
        of the graph's step n + 1.
        """
        out = np.empty((len(self), items, 2))
        self._item_noise(self._times(t_s), out)
        return out
