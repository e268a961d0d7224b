"""The table `[faults]` of a scenario: thrusters that weaken or die."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Literal

from mjforage.base.errors import UserError
from mjforage.base.fields import Within

SIDES = {"port": (0,), "starboard": (1,), "both": (0, 1)}
"""Thrusters of each word: 0 port, 1 starboard."""


@dataclass(frozen=True)
class Faults:
    """Thrusters that weaken or die, in MuJoCo; none by default.

    Neither controllers nor policies are told of them.
    """

    team: str = ""
    """Team of a vessel that fails in every episode; empty for none."""
    vessel: Annotated[int, Within(0, 254)] = 0
    """Its number in its team, from 0."""
    side: Literal["port", "starboard", "both"] = "port"
    """Its thruster that fails."""
    from_s: Annotated[float, Within(0, 1e9, "s")] = 0.0
    """Time at which it does, from the start of the episode."""
    rate_per_h: Annotated[float, Within(0, 3600, "1/h")] = 0.0
    """Rate at which every other thruster fails, once at most, at times drawn per episode."""
    left: Annotated[float, Within(0, 1)] = 0.0
    """Share of its thrust that a thruster has left after a fault: 0 dead, 0.7 weak."""
    noticed: bool = True
    """False: controllers steer as if all thrusters had all of their thrust."""

    @property
    def any(self) -> bool:
        """True if a thruster can fail."""
        return self.rate_per_h > 0.0 or bool(self.team)


def check_faults(faults: Faults, counts: Mapping[str, int], where: str) -> None:
    """Check that the vessel that fails is there.

    Raises `UserError` if it is no vessel of the scenario, or if nothing fails and yet it is said
    how.

    `counts`: team -> vessels in it; `where`: start of error messages.
    """
    if not faults.any and faults != Faults(noticed=faults.noticed):
        raise UserError(
            f"{where}: faults: no thruster fails; give faults.team or faults.rate_per_h"
        )
    own = Faults(rate_per_h=faults.rate_per_h, left=faults.left, noticed=faults.noticed)
    if not faults.team:
        if faults != own:
            of_one = "faults.vessel, faults.side and faults.from_s are of one vessel"
            raise UserError(f"{where}: {of_one}; give faults.team")
        return
    if faults.team not in counts:
        teams = ", ".join(counts)
        raise UserError(f"{where}: faults.team = {faults.team!r}: no such team; known: {teams}")
    if faults.vessel >= (count := counts[faults.team]):
        raise UserError(
            f"{where}: faults.vessel = {faults.vessel}: {faults.team} has {count}; count from 0"
        )
