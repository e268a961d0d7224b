"""Interface and registry of positioning models."""

from collections.abc import Callable
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.base.randomness import UInt64Array
from mjforage.base.registry import Registry, built
from mjforage.controllers.navigation import SensorErrors
from mjforage.scenario.sensors import Sensors

FloatArray = NDArray[np.float64]


class Measured(NamedTuple):
    """Measurements of all vessels at a control tick, world axes."""

    pose: FloatArray  # (episode, vessel, 3) x, y [m], yaw [rad] of midships
    velocity: FloatArray  # (episode, vessel, 3) over ground [m/s], [rad/s]
    fix: NDArray[np.bool_]  # (episode, vessel) False: no new fix, x and y are those of the last


class Positioning(Protocol):
    """A model of the sensors of all vessels.

    Its class is called with the table `[sensors]`, the shape (episodes, vessels) of the batch and
    the time between two ticks [s], and with the options of a reference as keywords.

    Attributes
    ----------
    errors : what a filter may assume of it; None: none is needed, poses are good as they are
    """

    errors: SensorErrors | None

    def reset(self, rows: NDArray[np.int64]) -> None:
        """Forget what is remembered of some episodes (row,) of the batch."""
        ...

    def measure(
        self, keys: UInt64Array, tick: NDArray[np.int64], pose: FloatArray, velocity: FloatArray
    ) -> Measured:
        """Measurements at a tick, drawn from (key, vessel, tick) and nothing else.

        Parameters
        ----------
        keys, tick : (episode,) episode keys, control ticks since the start
        pose, velocity : (episode, vessel, 3) as they are; world axes [m], [rad], [m/s], [rad/s]
        """
        ...


POSITIONING: Registry[Callable[..., Positioning]] = Registry(
    "positioning", "mjforage.positioning", given=3, methods=("reset", "measure")
)


def positioning_class(sensors: Sensors) -> Callable[..., Positioning]:
    """Class of the positioning model of a scenario.

    Raises `UserError` if there is none of that name, or it is code that the user has not named.
    """
    POSITIONING.check_trusted(sensors.positioning.partition("(")[0], "scenario")
    return POSITIONING.bound(sensors.positioning)[1]


def create_positioning(sensors: Sensors, shape: tuple[int, int], tick_s: float) -> Positioning:
    """A fresh model; raises as `positioning_class`, and for options that do not fit.

    `shape`: episodes, vessels; `tick_s`: time between two measurements [s].
    """
    made, name = positioning_class(sensors), sensors.positioning
    options = POSITIONING.bound(name)[2]
    model = built(f"positioning {name}", made, sensors, shape, tick_s, **options)
    if not isinstance(getattr(model, "errors", ""), SensorErrors | None):
        raise UserError(f"positioning {name}: errors is no SensorErrors; give one, or None")
    return model
