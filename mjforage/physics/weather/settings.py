"""Settings of the weather: mean wind, gusts, currents, and the paper's drift."""

import math
from dataclasses import dataclass
from typing import Annotated

from mjforage.base.errors import UserError
from mjforage.base.fields import Within
from mjforage.mission.initial_state import toward_of
from mjforage.scenario.bearings import Bearing
from mjforage.scenario.scenario import Weather
from mjforage.scenario.schema import check_fields


@dataclass(frozen=True)
class WeatherSettings:
    """Weather of a batch of episodes; the default is a calm.

    Wind and current are sums of their parts. Directions are where air and water flow to, in
    degrees counter-clockwise from east.

    Raises
    ------
    UserError
        If a value has the wrong type, is not finite or is out of range.
    """

    wind_speed_mps: Annotated[float, Within(0, 60, "m/s")] = 0.0
    """Mean wind."""
    wind_toward_deg: Bearing | None = 0.0
    """None: drawn per episode, uniform over the circle."""
    drawn_drift_mps: Annotated[float, Within(0, 5, "m/s")] = 0.0
    """The paper's drift: per episode a constant vector, uniform in +- this on each axis, is drawn,
    and the wind that drives it, the vector over the leeway of those items, is added to the mean."""

    shelter_height_m: Annotated[float, Within(0, 30, "m")] = 0.0
    """Height of obstacles on all land, in whose wind shadow the wind is weaker; 0: no shadow."""
    gust_intensity: Annotated[float, Within(0, 0.5)] = 0.0
    """Standard deviation of the gusts along the mean wind, over its speed; 0.1-0.2 is usual."""
    gust_tau_s: Annotated[float, Within(1e-2, 1e4, "s")] = 2.0
    """Correlation time of both gust components, which are the same everywhere at once."""

    current_speed_mps: Annotated[float, Within(0, 5, "m/s")] = 0.0
    """Constant current of open water: the free stream, of which quays make a flow around them."""
    current_toward_deg: Bearing | None = 0.0
    """None: drawn per episode, uniform over the circle."""
    current_wander_mps: Annotated[float, Within(0, 5, "m/s")] = 0.0
    """Standard deviation per axis of a slow Gauss-Markov part of the free stream."""
    circulation_mps: Annotated[float, Within(-5, 5, "m/s")] = 0.0
    """Peak speed of a steady harbour circulation between the quays; positive counter-clockwise."""

    item_noise_mps: Annotated[float, Within(0, 5, "m/s")] = 0.0
    """Per item and period a water velocity of its own, uniform in +- this on each axis."""
    item_noise_period_s: Annotated[float, Within(1e-3, 1e6, "s")] = 10.0
    """Time for which that velocity stays constant: a decision period."""

    def __post_init__(self) -> None:
        check_fields(self, "weather")

    @classmethod
    def of_scenario(cls, weather: Weather, pitch_m: float, period_s: float) -> "WeatherSettings":
        """A scenario's weather in metres: the paper's constant vector by wind, its noise by water.

        A wind that the scenario gives takes the place of the vector.

        Parameters
        ----------
        weather : drift and noise [node/step], gusts and currents [SI]
        pitch_m : length of a node [m]
        period_s : one decision [s]

        Raises
        ------
        UserError
            If drift or noise come out faster than 5 m/s, or the drift has ranges of its own.
        """
        if weather.drift_ranges_node_per_step is not None:
            raise UserError(
                "weather.drift_ranges_node_per_step: hulls have no such wind; use the graph world, "
                "or give weather.drift_node_per_step alone"
            )
        mps, speed = pitch_m / period_s, weather.wind_speed_mps
        toward = math.degrees(toward_of(weather.wind_from_deg))
        return cls(
            wind_speed_mps=speed or 0.0,
            wind_toward_deg=None if math.isnan(toward) else toward,
            drawn_drift_mps=0.0 if speed is not None else weather.drift_node_per_step * mps,
            shelter_height_m=weather.shelter_height_m,
            item_noise_mps=weather.noise_node_per_step * mps,
            item_noise_period_s=period_s,
            gust_intensity=weather.gust_intensity,
            gust_tau_s=weather.gust_tau_s,
            current_speed_mps=weather.current_speed_mps,
            current_toward_deg=weather.current_toward_deg,
            current_wander_mps=weather.current_wander_mps,
            circulation_mps=weather.circulation_mps,
        )
