"""Known metrics: ours, those of installed packages, any by `package.module:Name`.

A run uses ours and those that it names. Other installed or registered metrics, and ours that are
`on_request`, are known by name, but are no part of a run that does not name them.
"""

import math
import re
from collections.abc import Iterable, Sequence
from typing import TypeVar

from mjforage.base.errors import UserError
from mjforage.base.registry import ImportSpec, Registry, is_ours
from mjforage.mission.scoring.metric import Description, Metric, description

_M = TypeVar("_M", bound=type[Metric])

METRICS: Registry[type[Metric]] = Registry("metric", "mjforage.metrics")

_FIRST = (
    *("pta_d", "pta_c", "rmse", "rmse_columns", "nt50", "nt90", "throughput", "throughput_scouts"),
    *("mi_final", "mi_mean", "irr_mean", "dsl", "itl", "itl_level", "csr", "gini_foragers"),
    *("gini_scouts", "co_scouts", "co_foragers", "length", "cleared"),
)
"""Order of the columns that run folders have had from the first; all others come after, by key."""

_KEY = re.compile(r"[a-z][a-z0-9_]*")
_TAKEN = frozenset({"world", "policy", "episode", "items", "step"})  # columns of the same tables


def metric(made: _M) -> _M:
    """Decorator that makes a metric known to every command, by its key.

    Raises `ValueError` if its key is taken.
    """
    METRICS.register(made.key)(made)
    return made


def chosen_metrics(references: Iterable[str | ImportSpec] = ()) -> tuple[type[Metric], ...]:
    """Our metrics and those referred to, in a fixed order.

    Raises `UserError` if one cannot be imported, is no metric, or two have one key.

    `references`: keys, names of entry points, `package.module:Name`, or places of another process.
    """
    found: dict[str, type[Metric]] = {}
    ours = [name for name in METRICS.ours() if not METRICS.find(name).on_request]
    for name in (*ours, *references):
        made = METRICS.resolve(name) if isinstance(name, ImportSpec) else METRICS.find(name)
        one = checked(made, name if isinstance(name, str) else name.reference)
        if found.setdefault(one.key, one) is not one:
            raise UserError(
                f"metric {name}: key {one.key!r} is that of {found[one.key].__qualname__}, too; "
                "give it another"
            )
    places = {key: place for place, key in enumerate(_FIRST)}
    return tuple(
        sorted(found.values(), key=lambda one: (places.get(one.key, len(places)), one.key))
    )


def import_specs_of(metrics: Iterable[type[Metric]]) -> tuple[str | ImportSpec, ...]:
    """Keys or import paths, by which other processes take the same metrics.

    Raises `UserError` if one is of the script itself, which another process cannot import.
    """
    return tuple(
        one.key if is_ours(one) else METRICS.import_spec(one.key, one)
        for one in metrics
        if one.on_request or not is_ours(one)
    )


def checked(made: object, name: str) -> type[Metric]:
    """The class, if it is a metric with all that one must define; `UserError` if not.

    Raises `UserError` if it is none, or an attribute is missing or not what it should be.
    """
    if not isinstance(made, type) or not issubclass(made, Metric):
        raise UserError(f"metric {name}: is no class derived from Metric; derive it")
    for attribute in ("key", "label"):
        if not isinstance(getattr(made, attribute, None), str):
            raise UserError(f"metric {name}: {attribute} is missing; give it as text")
    if not _KEY.fullmatch(made.key) or made.key in _TAKEN:
        raise UserError(
            f"metric {name}: key = {made.key!r}: give small letters, digits and underscores, and "
            f"none of {', '.join(sorted(_TAKEN))}"
        )
    if made.better not in (-1, 0, 1):
        raise UserError(f"metric {name}: better = {made.better!r}: give 1, -1 or 0")
    if type(made.digits) is not int or not 0 <= made.digits <= 12:
        raise UserError(f"metric {name}: digits = {made.digits!r}: give 0 to 12")
    for attribute, words in (("least", "a number"), ("most", 'a number or "horizon"')):
        end = getattr(made, attribute)
        fits = end is None or (attribute, end) == ("most", "horizon")
        if not fits and (type(end) not in (int, float) or not math.isfinite(end)):
            raise UserError(f"metric {name}: {attribute} = {end!r}: give {words}, or leave it out")
    for method in ("value", "series", "at"):
        if not callable(getattr(made, method)):
            raise UserError(f"metric {name}: {method} is no method; define it, or leave it out")
    if not made.has_series() and made.value is Metric.value:
        raise UserError(f"metric {name}: has no formula; define value, series or at")
    return made


def series_metrics(metrics: Sequence[type[Metric]]) -> dict[str, type[Metric]]:
    """series_key -> metric, of those that have a time series.

    Raises `UserError` if two have one series_key.
    """
    found: dict[str, type[Metric]] = {}
    for one in metrics:
        if one.has_series() and found.setdefault(one.series_name(), one) is not one:
            raise UserError(
                f"metric {one.key}: series_key {one.series_name()!r} is that of "
                f"{found[one.series_name()].key}, too; give it another"
            )
    return found


def describe(key: str) -> Description:
    """Description of the metric of a key; an unknown metric is shown under its key."""
    return description(METRICS.find(key)) if METRICS.has(key) else Description(key, key)
