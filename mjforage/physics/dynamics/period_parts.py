"""All that the ticks of a decision need of a batch of missions, on the host or on a device."""

from dataclasses import dataclass
from typing import Generic, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from mjforage.base.randomness import UInt64Array
from mjforage.controllers import Pilot
from mjforage.forcing import Forcing
from mjforage.mission.dynamics import Transition
from mjforage.physics.dynamics.camera import Camera
from mjforage.physics.dynamics.collecting import Attempts, Mouths, Reach
from mjforage.physics.dynamics.device_ticks import Berths
from mjforage.physics.dynamics.faults import Failures
from mjforage.physics.dynamics.period_monitor import MonitorSetup, Motion, PeriodRecord
from mjforage.physics.dynamics.settling import Ground
from mjforage.physics.dynamics.tracks import ItemTracks, LandGrid
from mjforage.physics.positioning import Positioning
from mjforage.physics.simulation.simulated_fleet import SimulatedFleet


class Begun(NamedTuple):
    """Episodes of a batch that began anew while the others stay on a device."""

    rows: NDArray[np.int64]
    ran: bool  # see `DevicePeriod`


Simulation = TypeVar("Simulation", bound=SimulatedFleet)


@dataclass(frozen=True)
class Parts(Generic[Simulation]):
    """Arrays and rules that ticks read and write; what does not take part is None."""

    simulation: Simulation
    pilot: Pilot
    positioning: Positioning
    forcing: Forcing
    failures: Failures | None
    reach: Reach | None  # with intake
    camera: Camera | None
    grid: LandGrid
    bodies: bool
    contacts: bool
    monitor: MonitorSetup
    keys: UInt64Array
    tick: NDArray[np.int64]
    motion: Motion
    state: Transition
    record: PeriodRecord
    room_left: NDArray[np.int64]
    attempts: Attempts
    mouths: Mouths
    tracks: ItemTracks
    collects: NDArray[np.bool_]
    ground: Ground
    berths: Berths
    ticks: int  # of a period
    substeps: int  # of a tick
