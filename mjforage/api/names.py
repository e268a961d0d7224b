"""Names of what ships or is installed."""

from collections.abc import Callable, Iterable
from importlib import import_module
from typing import Any, Literal, get_args

from mjforage.base.errors import UserError
from mjforage.base.references import nearest

Kind = Literal["policies", "scenarios", "maps", "vessels", "metrics", "worlds", "observations"]
_NAMES: dict[Kind, tuple[str, Callable[[Any], Iterable[str]]]] = {
    "policies": ("graph_planner.policies", lambda here: here.policy_names()),
    "scenarios": ("scenario.scenario_file", lambda here: here.preset_names()),
    "maps": ("scenario.map_files", lambda here: here.shipped_maps()),
    "vessels": ("scenario.vessel_files", lambda here: here.vessel_names()),
    "metrics": ("mission.scoring", lambda here: (one.key for one in here.chosen_metrics())),
    "worlds": ("physics.worlds", lambda here: here.WORLDS),
    "observations": ("graph_planner.encodings", lambda here: here.ENCODERS.names()),
}
"""Kind -> the module that knows its names, imported when it is asked, and what tells them."""


def names(kind: Kind) -> tuple[str, ...]:
    """Names of all policies, scenarios, maps, vessels, metrics, worlds or observations.

    Raises
    ------
    UserError
        If there is no such kind.

    Examples
    --------
    >>> import mjforage as mf
    >>> mf.names("worlds")
    ('graph', 'hulls', 'calibrated', 'debris', 'intake', 'physics')
    """
    if kind not in get_args(Kind):
        raise UserError(f"kind {kind!r}: unknown; {nearest(str(kind), get_args(Kind))}")
    place, told = _NAMES[kind]
    return tuple(told(import_module(f"mjforage.{place}")))
