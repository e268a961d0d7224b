"""The shipped data (vessels, maps, scenarios and weights), and files named beside it."""

from collections.abc import Mapping
from pathlib import Path

from mjforage.base.errors import UserError
from mjforage.base.references import nearest

_PACKAGE = Path(__file__).resolve().parents[1]
_PLACES = (_PACKAGE / "models", _PACKAGE.parent / "models")  # an installed wheel, a checkout


def models_folder() -> Path:
    """Folder of the shipped data, in an installed package as well as in a checkout.

    Raises `UserError` if it is in neither place, naming both.
    """
    for place in _PLACES:
        if (place / "maps").is_dir():  # `models` alone could be anyone's
            return place
    tried = " or ".join(str(place) for place in _PLACES)
    raise UserError(f"shipped data not found as {tried}; install mjforage again")


def shipped_files(folder: str, suffix: str) -> dict[str, Path]:
    """Name -> file of what ships in a folder, by name; those with a second suffix are no names."""
    files = (models_folder() / folder).glob(f"*{suffix}")
    return {file.stem: file for file in sorted(files, key=lambda f: f.stem) if "." not in file.stem}


def named_file(
    kind: str, reference: str, shipped: Mapping[str, Path], what: str, suffix: str = ""
) -> Path:
    """File of a shipped name, in which dashes and underscores are alike, or of a path.

    Raises `UserError` if there is no such name or file, with the nearest name.

    Parameters
    ----------
    kind : for messages: map, scenario or vessel
    shipped : name -> file
    what : such a file, for messages
    suffix : end of the names of such files; empty: any
    """
    for name in (reference, reference.replace("_", "-"), reference.replace("-", "_")):
        if name in shipped:
            return shipped[name]
    path = Path(reference)
    try:
        if path.is_file() and (not suffix or path.suffix == suffix):
            return path
        meant = suffix and Path(f"{reference}{suffix}").is_file()
    except (OSError, ValueError) as error:
        raise UserError(f"{kind} {reference}: cannot be opened ({error})") from error
    hint = f"did you mean {reference}{suffix}?" if meant else nearest(path.stem.lower(), shipped)
    raise UserError(f"{kind} {reference}: neither a shipped {kind} nor {what}; {hint}")
