"""The folder of the shipped data: vessels, maps, scenarios and weights."""

from pathlib import Path

from mjforage.base.errors import UserError

_PACKAGE = Path(__file__).resolve().parents[1]
_PLACES = (_PACKAGE / "models", _PACKAGE.parent / "models")  # an installed wheel, a checkout


def models_folder() -> Path:
    """Folder of the shipped data, in an installed package as well as in a checkout.

    Raises
    ------
    UserError
        If it is in neither place, naming both.
    """
    for place in _PLACES:
        if (place / "maps").is_dir():  # `models` alone could be anyone's
            return place
    tried = " or ".join(str(place) for place in _PLACES)
    raise UserError(f"shipped data not found as {tried}; install mjforage again")
