"""Ranges of policies' options: checks that refuse numbers out of range."""

from math import isfinite

from mjforage.base.errors import UserError


def check_at_least(policy: str, least: float, **options: float) -> None:
    """Refuse options that are less, or not finite.

    Raises `UserError`, naming policy, option and value.
    """
    _check(policy, f"{least:g} or more", {n: (v, v >= least) for n, v in options.items()})


def check_positive(policy: str, **options: float) -> None:
    """Refuse options that are 0 or less, or not finite; raises as `check_at_least`."""
    _check(policy, "more than 0", {n: (v, v > 0) for n, v in options.items()})


def _check(policy: str, wanted: str, options: dict[str, tuple[float, bool]]) -> None:
    for name, (value, fits) in options.items():
        if not (fits and isfinite(value)):
            fault = "too small" if isfinite(value) else "not finite"
            raise UserError(f"{policy}: {name} {value} is {fault}; give {wanted}")
