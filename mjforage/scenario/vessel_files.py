"""Files of vessels and of their capture models, and the vessel of every agent."""

from pathlib import Path

from mjforage.scenario.assets import named_file, shipped_files
from mjforage.scenario.roles import Fleet
from mjforage.scenario.scenario import Physics

_CAPTURE = ".capture.toml"  # beside a vessel's file: how it picks up


def vessel_names() -> list[str]:
    """Names of the vessels that ship with the package."""
    return list(shipped_files("vessels", ".toml"))


def vessel_path(name_or_path: str | Path) -> Path:
    """File of a shipped vessel's name or of a path.

    Raises `UserError` if there is no such vessel or file.
    """
    shipped = shipped_files("vessels", ".toml")
    return named_file("vessel", str(name_or_path), shipped, "a TOML file", ".toml")


def capture_path(name_or_path: str | Path) -> Path:
    """Path of a vessel's capture model, beside its own file; it need not exist.

    Raises `UserError` if there is no such vessel.
    """
    path = vessel_path(name_or_path)
    return path.with_name(path.stem + _CAPTURE)


def hull_name(choice: Physics, team: str, collects: bool) -> str:
    """Name or file of a team's vessel."""
    return choice.vessels.get(team, "forager" if collects else "scout")


def hull_names(fleet: Fleet, choice: Physics) -> tuple[str, ...]:
    """(agent,) name or file of every agent's vessel."""
    return tuple(
        hull_name(choice, fleet.team_names[team], collects)
        for team, collects in zip(fleet.team, fleet.collects, strict=True)
    )
