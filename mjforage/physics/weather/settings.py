"""What the weather is like: mean wind, gusts, height, currents, and the paper's drift."""

from dataclasses import dataclass
from typing import Annotated, Literal, get_args

from graph_planner.fields import Within
from mjforage.core.errors import UserError
from mjforage.core.initial_state import LEEWAY
from mjforage.core.scenario import Weather
from mjforage.core.schema import check_fields

Profile = Literal["uniform", "log", "power"]
PROFILES: tuple[Profile, ...] = get_args(Profile)


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
    """Mean wind at the reference height."""
    wind_toward_deg: Annotated[float, Within(-360, 360, "deg")] | None = 0.0
    """None: drawn per episode, uniform over the circle."""
    drawn_drift_mps: Annotated[float, Within(0, 5, "m/s")] = 0.0
    """The paper's drift: per episode a constant vector, uniform in +- this on each axis, is drawn,
    and the wind that drives it, the vector over `drawn_drift_leeway`, is added to the mean."""
    drawn_drift_leeway: Annotated[float, Within(1e-3, 1)] = LEEWAY
    """Drift over wind of the items that follow the paper's rule."""

    wind_height_m: Annotated[float, Within(0.1, 100, "m")] = 10.0
    """Reference height of all the above (meteorology: 10 m)."""
    wind_profile: Profile = "uniform"
    """Over height z: ``uniform``, ``log`` ln(z/z0) / ln(ref/z0), or ``power`` (z/ref)^p."""
    roughness_m: Annotated[float, Within(1e-6, 1, "m")] = 2e-4
    """z0 of the logarithmic profile; 0.0002 m is open water (WMO-No. 8, class 1)."""
    power_exponent: Annotated[float, Within(0, 1)] = 0.11
    """p of the power profile; 0.11 is open sea (Hsu, Meindl and Gilhousen 1994)."""

    gust_intensity: Annotated[float, Within(0, 0.5)] = 0.0
    """Standard deviation of the gusts along the mean wind, over its speed; 0.1-0.2 is usual."""
    gust_crosswind_ratio: Annotated[float, Within(0, 1)] = 0.8
    """Standard deviation across the wind over that along it (IEC 61400-1, annex B: 0.8)."""
    gust_tau_s: Annotated[float, Within(1e-2, 1e4, "s")] = 2.0
    """Correlation time of both gust components at a fixed point."""
    gusts_travel: bool = False
    """Whether gusts run over the water with the mean wind (Taylor's frozen turbulence), instead of
    being the same everywhere at once; costs an evaluation per point instead of per episode."""

    current_speed_mps: Annotated[float, Within(0, 5, "m/s")] = 0.0
    """Constant current, the same everywhere, quays included."""
    current_toward_deg: Annotated[float, Within(-360, 360, "deg")] | None = 0.0
    """None: drawn per episode, uniform over the circle."""
    current_wander_mps: Annotated[float, Within(0, 5, "m/s")] = 0.0
    """Standard deviation per axis of a slow Gauss-Markov current, the same everywhere."""
    current_wander_tau_s: Annotated[float, Within(1, 1e6, "s")] = 600.0
    """Correlation time of that current."""
    circulation_mps: Annotated[float, Within(-5, 5, "m/s")] = 0.0
    """Peak speed of a steady harbour circulation between the quays; positive counter-clockwise."""

    item_noise_mps: Annotated[float, Within(0, 5, "m/s")] = 0.0
    """Per item and period a water velocity of its own, uniform in +- this on each axis."""
    item_noise_period_s: Annotated[float, Within(1e-3, 1e6, "s")] = 10.0
    """How long that velocity is held: a decision period."""

    def __post_init__(self) -> None:
        check_fields(self, "weather")
        if self.wind_profile == "log" and self.roughness_m >= self.wind_height_m:
            raise UserError(
                f"weather: roughness_m = {self.roughness_m:g} is not below "
                f"wind_height_m = {self.wind_height_m:g}; give a smaller roughness"
            )

    @classmethod
    def of_scenario(cls, weather: Weather, pitch_m: float, period_s: float) -> "WeatherSettings":
        """A scenario's weather in metres: the paper's constant vector by wind, its noise by water.

        Parameters
        ----------
        weather : drift and noise [node/step], gusts and currents [SI]
        pitch_m : length of a node [m]
        period_s : one decision [s]

        Raises
        ------
        UserError
            If drift or noise come out faster than 5 m/s.
        """
        mps = pitch_m / period_s
        return cls(
            drawn_drift_mps=weather.drift_node_per_step * mps,
            item_noise_mps=weather.noise_node_per_step * mps,
            item_noise_period_s=period_s,
            gust_intensity=weather.gust_intensity,
            gust_tau_s=weather.gust_tau_s,
            current_speed_mps=weather.current_speed_mps,
            current_toward_deg=weather.current_toward_deg,
            current_wander_mps=weather.current_wander_mps,
            circulation_mps=weather.circulation_mps,
        )
