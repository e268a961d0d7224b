"""Sub-environments whose decisions are on a device, from the preferences to what agents see.

After each decision the host is told rewards, moves, and what tells the end. All else stays there
until it is asked for; of episodes that start, their rows are written there.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from mjforage.base.device import Call
from mjforage.base.randomness import UInt64Array
from mjforage.base.registry import is_ours
from mjforage.graph_planner.encodings.encoder import DeviceEncoder
from mjforage.learning.environments.core import EnvironmentCore
from mjforage.learning.environments.rewards import Amounts, Before
from mjforage.mission.device_mission import DeviceMission
from mjforage.mission.resolver import refuse_nan


@dataclass(frozen=True)
class _Bound:
    """Sub-environments as they are on the device."""

    mission: DeviceMission
    decide: tuple[Call, ...]
    look: tuple[Call, ...]
    mask: tuple[Call, ...]
    terms: dict[str, Amounts]
    told: list[NDArray[Any]]  # what the host knows after each decision
    levels: dict[str, Any]  # tensors
    masks: Any  # tensor (env, agent, 9) int8


class DeviceCore(EnvironmentCore):
    """`EnvironmentCore` of hulls on a device; its observations and masks are tensors there.

    On a processor the bits are those of `EnvironmentCore`.
    """

    on_device = True
    _now: _Bound | None = None

    @property
    def lacking(self) -> str:
        """Parts of these sub-environments that have no kernels for a device; empty: none."""
        setup, encoder = self.setup.scenario, self._encoder
        lacks = {
            "a link": setup.link.model != "ideal",
            "items without bodies": setup.physics.items != "bodies",
            "drawn pictures": self.options.render_mode is not None,
            f"observation {self.options.observation}": not is_ours(type(encoder))
            or not hasattr(encoder, "fits_a_device"),
            "a map without a table of distances": not getattr(encoder, "fits_a_device", True),
            f"reward {', '.join(self._terms.on_host_only)}": bool(self._terms.on_host_only),
        }
        found = [name for name, so in lacks.items() if so]
        if not found and not self.mission.may_decide_on_device:
            found = ["this world"]
        return ", ".join(found)

    def start(self, envs: NDArray[np.int64], keys: UInt64Array) -> None:
        """Start episodes of the given keys in sub-environments (env,); the first time in all."""
        super().start(envs, keys)
        goes_on = self._now is not None and envs.size < self.num_envs
        self._now = None
        if goes_on:  # the device alone knows those that do
            self._now = self._moved()
            self._now.mission.world.hulls.synchronise()

    def _there(self) -> _Bound:
        """All on the device, moved there if it is not."""
        if self._now is None:
            self._now = self._moved()
        return self._now

    def _moved(self) -> _Bound:
        there = self.mission.on_device()
        bind = there.world.bind
        known, state = there.knowledge, there.state
        live = Before.of_state(state, known, there.step)
        copy, reward, terms = self._terms.on_device(bind, state, there.ledger, live)
        every = np.ones(self.num_envs, np.bool_)
        legal = np.zeros((self.num_envs, self.agents, 9), np.bool_)
        encoder = cast(DeviceEncoder, self._encoder)
        encode, levels = encoder.on_device(bind, every, there.seen)
        mask = self._legal_moves.on_device(bind, known.agent_node, known.energy_left, legal)
        arrays = there.world.hulls.arrays
        arrays.send(there.active)
        told = [there.active, there.step, *there.moves, *terms.values()]
        told += [known.energy_left, state.item_node]
        shapes = {name: (*legal.shape[:2], *shape) for name, shape in self.shapes.items()}
        tensors = {name: arrays.tensor(one).view(shapes[name]) for name, one in levels.items()}
        import torch

        masks = arrays.tensor(legal).view(torch.int8)
        decide = copy, *there.calls, *reward
        return _Bound(there, decide, (encode,), (mask,), terms, told, tensors, masks)

    def _advance(
        self, preferences: NDArray[np.float64], played: NDArray[np.bool_]
    ) -> dict[str, Amounts]:
        now = self._there()
        refuse_nan(preferences, "policy")
        arrays = now.mission.world.hulls.arrays
        now.mission.preferences[:] = preferences
        arrays.send(now.mission.preferences)
        now.mission.world.hulls.synchronise()  # with the stream of those that torch may have
        self._run(now, now.decide)
        now.mission.world.check()
        self._fetch(now, now.told)
        self.mission.came_back(now.mission)
        return {name: np.where(played[:, None], one, 0.0) for name, one in now.terms.items()}

    @staticmethod
    def _run(now: _Bound, calls: tuple[Call, ...]) -> None:
        with now.mission.world.hulls.beside_torch():
            now.mission.world.hulls.run(calls)

    @staticmethod
    def _fetch(now: _Bound, arrays: Iterable[NDArray[Any]]) -> None:
        for array in arrays:
            now.mission.world.hulls.arrays.fetch(array)

    def come_back(self, maps: bool = True) -> None:
        """Have `mission` know all, by default also what is known of each node."""
        if self._now is not None:
            there = self._now.mission
            there.world.come_back()
            self._fetch(self._now, (*there.state, *there.ledger))
            self._fetch(self._now, there.knowledge if maps else ())

    @property
    def memory_bytes(self) -> int:
        """Memory of a sub-environment on the device, with its share of what all have."""
        return int(self._there().mission.world.hulls.memory_bytes)

    def facts(self) -> dict[str, NDArray[Any]]:
        """Steps (env,) made, and shares (env,) of items discovered and removed so far [%]."""
        if self._now is not None:
            ledger = self._now.mission.ledger
            self._fetch(self._now, (ledger.t_discovered, ledger.t_collected))
        return super().facts()

    def see(self, envs: NDArray[np.int64]) -> dict[str, Any]:
        """Levels (env, agent, ...) uint8 of all observations, as live tensors."""
        now = self._there()
        self._run(now, now.look)
        return now.levels

    @property
    def masks(self) -> Any:
        """(env, agent, 9) int8 tensor, live."""
        now = self._there()
        self._run(now, now.mask)
        return now.masks
