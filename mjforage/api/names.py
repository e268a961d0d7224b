"""Names of what ships or is installed."""

from typing import Literal, get_args

from mjforage.base.errors import UserError
from mjforage.base.references import nearest

Kind = Literal["policies", "scenarios", "maps", "vessels", "metrics", "worlds", "observations"]


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
    if kind == "policies":
        from mjforage.graph_planner.policies import policy_names

        return tuple(policy_names())
    if kind == "scenarios":
        from mjforage.scenario.scenario_file import preset_names

        return tuple(preset_names())
    if kind == "maps":
        from mjforage.scenario.map_files import shipped_maps

        return tuple(shipped_maps())
    if kind == "vessels":
        from mjforage.scenario.vessel_files import vessel_names

        return tuple(vessel_names())
    if kind == "metrics":
        from mjforage.mission.scoring import chosen_metrics, description

        return tuple(description(one).key for one in chosen_metrics())
    if kind == "worlds":
        from mjforage.physics.worlds import WORLDS

        return tuple(WORLDS)
    if kind == "observations":
        from mjforage.graph_planner.encodings.encoder import ENCODERS

        return tuple(ENCODERS.names())
    raise UserError(f"kind {kind!r}: unknown; {nearest(str(kind), get_args(Kind))}")
