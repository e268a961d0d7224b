"""Files of vessels and of their capture models, and the vessel of every agent."""

import difflib
from pathlib import Path

from mjforage.base.errors import UserError
from mjforage.scenario.assets import models_folder
from mjforage.scenario.roles import Fleet
from mjforage.scenario.scenario import Physics

_CAPTURE = ".capture.toml"  # beside a vessel's file: how it picks up


def vessel_names() -> list[str]:
    """Names of the vessels that ship with the package."""
    files = (models_folder() / "vessels").glob("*.toml")
    return sorted(path.stem for path in files if not path.name.endswith(_CAPTURE))


def vessel_path(name_or_path: str | Path) -> Path:
    """File of a shipped vessel's name or of a path.

    Raises
    ------
    UserError
        If there is no such vessel or file.
    """
    names = vessel_names()
    if str(name_or_path) in names:
        return models_folder() / "vessels" / f"{name_or_path}.toml"
    path = Path(name_or_path)
    try:
        if path.suffix == ".toml" and path.is_file():
            return path
    except (OSError, ValueError) as error:
        raise UserError(f"vessel {name_or_path}: cannot be opened ({error})") from error
    if path.suffix == ".toml":
        where = "" if path.is_absolute() else f" from {Path.cwd()}"
        raise UserError(f"vessel {name_or_path}: no such file{where}; mend the path")
    close = difflib.get_close_matches(str(name_or_path), names, n=1)
    hint = f"did you mean {close[0]}?" if close else f"choose {', '.join(names)}"
    raise UserError(f"vessel {name_or_path}: neither a shipped vessel nor a TOML file; {hint}")


def capture_path(name_or_path: str | Path) -> Path:
    """Path of a vessel's capture model, beside its own file; it need not exist.

    Raises
    ------
    UserError
        If there is no such vessel.
    """
    path = vessel_path(name_or_path)
    return path.with_name(path.stem + _CAPTURE)


def hull_names(fleet: Fleet, choice: Physics) -> tuple[str, ...]:
    """(agent,) name or file of every agent's vessel."""
    return tuple(
        choice.vessels.get(fleet.team_names[team], "forager" if collects else "scout")
        for team, collects in zip(fleet.team, fleet.collects, strict=True)
    )
