"""Rewards by name: weights of terms."""

from collections.abc import Callable, Mapping

from mjforage.base.errors import UserError
from mjforage.base.references import bind, nearest, parse_reference
from mjforage.learning.environments.rewards.known import checked_weights, finite, labelled
from mjforage.learning.environments.rewards.potentials import GAMMA

PUBLISHED = {"belief": 2.12, "removed": 5.91, "idleness": 2.23, "distance": -1.7}
"""Weights of the published experiments (definitions, section 3)."""

DDQN = {
    "removed": 0.5,
    "team_removed": 2.0,
    "discovered": 0.5,
    "idleness": 0.01,
    "approach": 0.05,
    "time": -0.02,
}
"""Weights that our own algorithms train with, and the shipped weights were trained with."""


def mission(gamma: float = GAMMA) -> dict[str, float]:
    """The default: items that are removed, and when; what leads to that as potentials.

    An item counts 100 / n of n, and up to a tenth more by when; one that is only known, or near a
    collector too, at most .04 or .24 of that.

    `gamma`: discount of the learner per step of the environment.
    """
    return {
        "collected": 100.0,
        "early": 10.0,
        f"known(gamma={gamma})": 4.0,
        f"reach(gamma={gamma})": 20.0,
        f"fresh(gamma={gamma})": 2.0,
    }


PRESETS: dict[str, Callable[..., dict[str, float]]] = {
    "mission": mission,
    "published": lambda: PUBLISHED,
    "ddqn": lambda: DDQN,
}


def reward_weights(reward: str | Mapping[str, float]) -> dict[str, float]:
    """Weights of the terms of a reward.

    Raises `UserError` as `checked_weights`, and if a name is not known.

    Parameters
    ----------
    reward : name of `PRESETS`, with options in parentheses; or names of terms and presets, each
        with a weight: a preset's weights are multiplied by its own, presets add up, and terms
        replace those of presets, whatever the options of either
    """
    if isinstance(reward, str):
        if parse_reference(reward, "reward").name not in PRESETS:
            raise UserError(f"reward = {reward!r}: unknown; {nearest(reward, PRESETS)}")
        reward = {reward: 1.0}
    if not isinstance(reward, Mapping):
        return checked_weights(reward)
    presets = {text: _preset(text) for text in reward if isinstance(text, str)}
    own = labelled({text: weight for text, weight in reward.items() if not presets.get(text)})
    replaced = {_term(text) for text in own}
    found: dict[str, float] = {}
    for text, weights in presets.items():
        for term, weight in (weights or {}).items():
            if _term(term) not in replaced:
                found[term] = found.get(term, 0.0) + weight * finite(text, reward[text])
    return checked_weights(labelled(found) | own)


def _term(text: str) -> str:
    """Name of a term without its options."""
    return text.partition("(")[0].strip()


def _preset(text: str) -> dict[str, float] | None:
    """Weights of a preset, None for what is none."""
    reference = parse_reference(text, "reward")
    if reference.name not in PRESETS:
        return None
    made = PRESETS[reference.name]
    return made(**bind(made, reference, "reward")[1])
