"""Options of `Waypoint-v0`, of one vessel and of batches."""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any, TypedDict

from mjforage.base.cached import warn_once
from mjforage.learning.environments.checks import check_mode
from mjforage.learning.environments.choices import check_known
from mjforage.learning.environments.rewards import checked_names
from mjforage.learning.environments.waypoint_track import TICK_S
from mjforage.physics.run_warnings import vessel_warnings
from mjforage.physics.vessels import Vessel, load_vessel
from mjforage.scenario.scenario import Spread, Weather
from mjforage.scenario.schema import check_fields

REWARD = {"progress": 1.0, "reached": 5.0, "time": -0.1, "effort": -0.05}
"""Term -> weight: metres nearer to the waypoint, waypoints reached, steps, mean square action.

Full astern is an action of -1, as costly as full ahead, for any controller.
"""

STEP_REMEDY = "its motion will not be that of the hull; such drag needs steps of at most"


class WaypointArguments(TypedDict, total=False):
    """Keyword arguments, see `WaypointOptions`."""

    vessel: str | Path
    wind_mps: float
    gust_intensity: float
    current_mps: float
    wind_spread: float
    current_spread: float
    mass_spread: float
    drag_spread: float
    thrust_spread: float
    reward: Mapping[str, float] | None
    render_mode: str | None


@dataclass(frozen=True)
class WaypointOptions:
    """The arguments, checked.

    Raises `UserError` if one is not valid.

    Attributes
    ----------
    vessel : name or TOML file
    wind_mps, current_mps : speeds; directions are drawn per episode
    gust_intensity : standard deviation of the gusts over the wind's speed
    wind_spread, current_spread : an episode's speed is uniform in the mean times 1 +- this
    mass_spread, drag_spread, thrust_spread : so are the vessel's own, see `scenario.Spread`
    reward : term -> weight; absent: `REWARD`
    """

    vessel: str | Path = "scout"
    wind_mps: float = 3.0
    gust_intensity: float = 0.15
    current_mps: float = 0.15
    wind_spread: float = 0.0
    current_spread: float = 0.0
    mass_spread: float = 0.0
    drag_spread: float = 0.0
    thrust_spread: float = 0.0
    reward: Mapping[str, float] | None = None
    render_mode: str | None = None
    weather: Weather = field(init=False)
    spread: Spread = field(init=False)
    hull: Vessel = field(init=False)
    weights: dict[str, float] = field(init=False)

    def __post_init__(self) -> None:
        weather = Weather(
            wind_speed_mps=self.wind_mps,
            wind_spread=self.wind_spread,
            gust_intensity=self.gust_intensity,
            current_speed_mps=self.current_mps,
            current_spread=self.current_spread,
        )
        check_fields(weather, "weather")
        spread = Spread(self.mass_spread, self.drag_spread, self.thrust_spread)
        check_fields(spread, "spread")
        check_mode(self.render_mode)
        weights = checked_names(REWARD if self.reward is None else self.reward, REWARD)
        hull = load_vessel(str(self.vessel))
        for line in vessel_warnings(
            hull, self.wind_mps * (1.0 + self.wind_spread), TICK_S, STEP_REMEDY
        ):
            warn_once(f"vessel {hull.name}: {line}")
        made = {"weather": weather, "spread": spread, "hull": hull, "weights": weights}
        for name, value in made.items():
            object.__setattr__(self, name, value)

    @classmethod
    def of(cls, arguments: Mapping[str, Any]) -> "WaypointOptions":
        """Options from keyword arguments; raises as the class, and for unknown arguments."""
        check_known(arguments, [each.name for each in fields(cls) if each.init])
        return cls(**arguments)
