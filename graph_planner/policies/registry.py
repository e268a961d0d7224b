"""Registry of policies."""

import logging
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, TypeVar

from mjforage.base.errors import UserError
from mjforage.base.references import Reference, parse_reference
from mjforage.base.registry import ImportSpec, Registry, built, is_ours
from mjforage.mission.policy import Policy

WeightsPlayer = TypeVar("WeightsPlayer", bound=Callable[[Path], Policy])

POLICIES: Registry[Callable[..., Policy]] = Registry(
    "policy", "mjforage.policies", methods=("reset", "act")
)
_PLAYERS: list[Callable[[Path], Policy]] = []
_logger = logging.getLogger(__name__)


register = POLICIES.register
"""Class decorator that makes a policy known under a name, as `Registry.register`."""


def plays_weights(policy: WeightsPlayer) -> WeightsPlayer:
    """Class decorator: this one plays `NAME.safetensors` of the present folder."""
    _PLAYERS.append(policy)
    return policy


def weights_player() -> Callable[[Path], Policy]:
    """Class that plays a file of weights."""
    return _PLAYERS[-1]


def policy_names() -> list[str]:
    """All names that are registered or that installed packages bring, sorted."""
    return POLICIES.names()


def own_weights(name: str) -> Path | None:
    """`NAME.safetensors` of the present folder, if no policy has that name."""
    path = Path(f"{name}.safetensors")
    there = path.name == str(path) and ":" not in name and path.is_file()
    return path.resolve() if there and not POLICIES.has(name) else None


def _bound(text: str) -> tuple[Reference, Callable[..., Policy], dict[str, Any]]:
    """As `Registry.bound`, weights of the present folder included."""
    reference = parse_reference(text, "policy")
    weights = own_weights(reference.name)
    if weights is None:
        _refuse_suffix(reference.name)
        return POLICIES.bound(text)
    if reference.options:
        raise UserError(f"policy {text}: weights take no options; give {reference.name}")
    return reference, _PLAYERS[-1], {"path": weights}


def _refuse_suffix(name: str) -> None:
    """Refuse a name that is a file of weights, with a hint on naming them."""
    path = Path(name)
    if path.suffix != ".safetensors":
        return
    if path.name == name:
        raise UserError(f"policy {name}: give weights without the end of their name: {path.stem}")
    raise UserError(
        f"policy {name}: weights are played from the present folder; go to {path.parent}, or copy "
        f"them here, and give {path.stem}"
    )


def policy_label(text: str) -> str:
    """The one spelling of a reference to a policy, by which tables, files and run.json name it.

    Options stand in the order of their names; those at their default are left out. A class that
    ships has its name. Raises `UserError` as `create_policy`.
    """
    return str(_bound(text)[0])


def policy_class(text: str) -> Callable[..., Policy]:
    """Class or factory of a policy; raises as `create_policy`."""
    return _bound(text)[1]


def check_policies(texts: Sequence[str]) -> list[str]:
    """The labels of policies; refuse unknown and repeated ones, and those that cannot be made.

    Raises `UserError` as `create_policy`, and for a policy given twice or none at all.
    """
    if not texts:
        raise UserError("no policy given; give one, such as greedy")
    labels: list[str] = []
    for text in texts:
        create_policy(text)
        label = policy_label(text)
        if label in labels:
            raise UserError(f"policy {label}: given twice")
        labels.append(label)
    return labels


def create_policy(text: str) -> Policy:
    """A fresh policy.

    Raises `UserError` if there is none of that name (the message offers the nearest), it cannot be
    imported, or an option does not fit (the message has the `ValueError` of its `__init__`). Raises
    `WeightsError` if the present folder has a weight file of that name, but no weights of ours are
    in it.

    Parameters
    ----------
    text : NAME, `package.module:Class` or, for weights `NAME.safetensors` of the present folder,
        NAME; each with options in parentheses, such as `greedy(distance=2)`
    """
    _, made, options = _bound(text)
    policy = built(f"policy {text}", made, **options)
    for method in ("reset", "act"):
        if not callable(getattr(policy, method, None)):
            raise UserError(f"policy {text}: has no method {method}; define it")
    return policy


def outside_class(text: str) -> str:
    """`package.module:Class` of a policy that is not ours; "" for one of ours."""
    made = policy_class(text)
    put = policies_lent([text])
    return (
        "" if put or is_ours(made) else f"{made.__module__}:{getattr(made, '__qualname__', made)}"
    )


def has_policy(text: str) -> bool:
    """True if a policy's name, without its options, is registered or installed."""
    return POLICIES.has(parse_reference(text, "policy").name)


def check_policy_trusted(text: str, where: str, reference: str = "") -> None:
    """Refuse a policy that a file names, of code that is not known to be trusted.

    Raises `UserError` as `Registry.check_trusted`, and if it is no reference.

    Parameters
    ----------
    text, where, reference : as of `Registry.check_trusted`; the name may have options
    """
    POLICIES.check_trusted(parse_reference(text, "policy").name, where, reference)


def policy_import_spec(text: str) -> ImportSpec | None:
    """Place where another process finds a policy; None for one of ours.

    Raises `UserError` if another process cannot.
    """
    name = parse_reference(text, "policy").name
    return None if own_weights(name) else POLICIES.import_specs([name]).get(name)


def policies_lent(texts: Sequence[str]) -> dict[str, Callable[..., Policy]]:
    """Classes of those policies that are objects of this process, by name without options."""
    return POLICIES.lent_of(parse_reference(text, "policy").name for text in texts)


def add_policy(text: str, spec: ImportSpec) -> None:
    """Make a policy known here that another process found, by its import spec.

    Raises `UserError` if it cannot be imported here.
    """
    POLICIES.add(parse_reference(text, "policy").name, spec)


def policy_files(text: str) -> tuple[Path, ...]:
    """The files that a policy's moves depend on, its weights for example.

    A warning is logged if the present folder has weights of that name which it does not read.
    Raises `UserError` as `create_policy`, and if one of them is missing.
    """
    name, named = parse_reference(text, "policy").name, getattr(create_policy(text), "files", ())
    files = tuple(Path(file) for file in ((named,) if isinstance(named, str | Path) else named))
    for file in files:
        if not file.is_file():
            raise UserError(
                f"policy {text}: there is no file {file}, which it reads; mend its path"
            )
    there = Path(f"{name}.safetensors")
    if there.is_file() and not any(file.exists() and there.samefile(file) for file in files):
        _logger.warning(
            "policy %s is the one that ships; %s in the present folder is not read: rename it, and "
            "its policy has the new name",
            name,
            there,
        )
    return files


def policy_parts(text: str) -> tuple[Callable[..., Any], ...]:
    """The classes that a policy finds by their names, an observation encoder for example."""
    made = policy_class(text)
    return tuple(getattr(create_policy(text), "parts", ())) if hasattr(made, "parts") else ()


def policy_summary(name: str) -> str:
    """First line of a policy's docstring."""
    return ((POLICIES.find(name).__doc__ or "").strip().splitlines() or [""])[0]


def policy_told(text: str) -> str:
    """Facts of an episode's items that a policy is told before it, for tables; "" if none.

    Its attribute `told`; an upper bound is told the items. "" for an unknown one.
    """
    try:
        made = _bound(text)[1]
    except UserError:
        return ""
    return "the items" if hasattr(made, "set_ground_truth") else str(getattr(made, "told", ""))


def is_upper_bound(text: str) -> bool:
    """True for a policy that gets the ground truth; an unknown one does not."""
    try:
        return hasattr(_bound(text)[1], "set_ground_truth")
    except UserError:
        return False
