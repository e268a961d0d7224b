"""A model of another library that has `predict`, such as Stable-Baselines3's, as a policy."""

import inspect
from typing import Any, ClassVar

import cloudpickle
import numpy as np
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.base.randomness import UInt64Array
from mjforage.graph_planner.encodings.encoder import ENCODERS, create_encoder
from mjforage.graph_planner.encodings.encoder import TOP as TOP_LEVEL
from mjforage.learning.environments.spaces import MASK, Arrays, arrays_space
from mjforage.learning.model_policy import ModelPolicy
from mjforage.mission.task import Task
from mjforage.runs.sources import source_hash


class LoadedModel(ModelPolicy):
    """Base of policies that ask a model in memory; a subclass has its model."""

    model: ClassVar[Any]
    source_hash: ClassVar[str]

    def reset(self, task: Task, keys: UInt64Array) -> None:
        """Get ready for a batch (episode,), with the observation that fits the model.

        Raises `UserError` if none of ours fits its spaces.
        """
        self.observation = _observation(type(self).model, task, type(self).__name__)
        spaces = type(self).model.observation_space.spaces
        self._levels = all(part.dtype == np.uint8 for name, part in spaces.items() if name != MASK)
        super().reset(task, keys)

    def decide(self, seen: Arrays, agents: NDArray[np.int64]) -> NDArray[Any]:
        """Moves (row,), or (row, agent), of the model's most likely actions."""
        model, space = type(self).model, type(self).model.observation_space
        given = {name: part for name, part in seen.items() if name in space.spaces}
        if self._levels:
            given = {
                name: part if name == MASK else np.rint(part * TOP_LEVEL).astype(np.uint8)
                for name, part in given.items()
            }
        masks = {}
        if "action_masks" in inspect.signature(model.predict).parameters:
            masks = {"action_masks": seen[MASK].reshape(len(agents), -1).astype(np.bool_)}
        moves: NDArray[Any] = np.asarray(model.predict(given, deterministic=True, **masks)[0])
        return moves.astype(np.int64)


def policy_of_model(model: Any, name: str) -> type[LoadedModel]:
    """Class of a policy that asks a loaded model; its action space tells how it decides.

    Raises `UserError` if its actions are not moves of an agent, or of a whole fleet.
    """
    space = getattr(model, "action_space", None)
    moves = getattr(space, "n", None) == 9 or set(np.ravel(getattr(space, "nvec", ()))) == {9}
    if not moves or not hasattr(getattr(model, "observation_space", None), "spaces"):
        raise UserError(
            f"policy {name}: a model of {getattr(model, 'observation_space', None)} and {space}; "
            "give one that was trained on mjforage/SharedPolicy-v0 or mjforage/Foraging-v0, or a "
            "class of mjforage.learning.model_policy.ModelPolicy"
        )
    kind = "SharedPolicy-v0" if hasattr(space, "n") else "Foraging-v0"
    asked = _asked(model)
    weights = asked.state_dict() if hasattr(asked, "state_dict") else vars(asked)
    state = {
        key: np.asarray(value.cpu()) if hasattr(value, "cpu") else value
        for key, value in weights.items()
    }
    return type(
        name,
        (LoadedModel,),
        {
            "__module__": type(model).__module__,
            "__doc__": f"Model of {type(model).__name__}.",
            "model": asked,
            "libraries": ("torch",) if hasattr(asked, "state_dict") else (),
            "trained_on": f"mjforage/{kind}",
            "source_hash": source_hash(LoadedModel, state),
        },
    )


def _asked(model: Any) -> Any:
    """The part that predicts, in a copy: without environments, buffers and logs where it can be.

    A model that has just learnt holds tensors with a gradient, which `copy.deepcopy` refuses.
    """
    policy = getattr(model, "policy", None)
    part = policy if callable(getattr(policy, "predict", None)) else model
    return cloudpickle.loads(cloudpickle.dumps(part))


def _observation(model: Any, task: Task, who: str) -> str:
    """Encoder whose arrays have the shapes of a model's observations."""
    several = hasattr(model.action_space, "nvec")
    wanted = {name: part.shape for name, part in model.observation_space.spaces.items()}
    wanted.pop(MASK, None)
    for name in ENCODERS.ours():
        shapes = create_encoder(name, task).shapes
        lead = (len(task.fleet),) if several else ()
        space = arrays_space(shapes, lead)
        if wanted.items() <= {key: part.shape for key, part in space.spaces.items()}.items():  # type: ignore[attr-defined]
            return name
    raise UserError(
        f"policy {who}: its model sees {wanted}, which no observation of this scenario is; train "
        "on a scenario of the same fleet and map size, or use ModelPolicy with `observation`"
    )
