"""A batch in parts, each on a thread of its own: kernels and MuJoCo release Python's lock."""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from numpy.typing import NDArray

from mjforage.base.randomness import UInt64Array
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.mission.dynamics import Dynamics, Transition
from mjforage.mission.initial_state import InitialState
from mjforage.mission.moves import Moves

Part = tuple[Dynamics, slice]


class ThreadedDynamics:
    """Dynamics of the same world for neighbouring episodes each; bits do not depend on how many.

    Attributes
    ----------
    pickup : mean delays of collecting for vessels
    """

    def __init__(self, each: Sequence[Dynamics]) -> None:
        """Take the dynamics, one for each thread; of fewer episodes the first ones play."""
        self._each, self.pickup, self._compiled = tuple(each), each[0].pickup, False

    def reset(self, initial: InitialState, keys: UInt64Array, names: Sequence[str]) -> Transition:
        """Start a batch of episodes and return their state at step 0."""
        edges = np.linspace(0, keys.size, min(len(self._each), keys.size) + 1).astype(int)
        owns = map(slice, edges[:-1], edges[1:])
        self._parts: list[Part] = list(zip(self._each, owns, strict=False))
        every = np.arange(keys.size)
        return self._joined(
            [
                part.reset(initial.of_rows(every[own]), keys[own], names[own])
                for part, own in self._parts
            ]
        )

    def restart(
        self,
        rows: NDArray[np.int64],
        initial: InitialState,
        keys: UInt64Array,
        names: Sequence[str],
    ) -> Transition:
        """Start other episodes in some rows (row,) of the batch; returns the state of all."""
        states = []
        for part, own in self._parts:  # all of them: they stay equally wide
            of = np.flatnonzero((own.start <= rows) & (rows < own.stop))
            about = initial.of_rows(of), keys[of], [names[int(i)] for i in of]
            states.append(part.restart(rows[of] - own.start, *about))
        return self._joined(states)

    def drift_rc(self, rc: NDArray[np.float64], items: bool = False) -> NDArray[np.float64]:
        """(episode, place, 2) drift of items [node/step], as `Dynamics` has it."""
        return np.concatenate([part.drift_rc(rc[own], items) for part, own in self._parts])

    def advance(self, active: NDArray[np.bool_], step: Int32Array, moves: Moves) -> Transition:
        """Carry out one decision. Inactive episodes do not change.

        The first one compiles what is left to compile, on one thread.
        """

        def one(part: Part) -> Transition:
            own = part[1]
            return part[0].advance(active[own], step[own], Moves._make(each[own] for each in moves))

        states = self._on_threads(one) if self._compiled else [one(part) for part in self._parts]
        self._compiled = True
        for mine, *theirs in zip(self._state, *states, strict=True):
            np.concatenate(theirs, out=mine)
        return self._state

    def _on_threads(self, one: Callable[[Part], Transition]) -> list[Transition]:
        """Results for all parts, the first of them on this thread; the first error of them."""
        first, *others = self._parts
        with ThreadPoolExecutor(max(1, len(others))) as pool:
            futures = [pool.submit(one, part) for part in others]
            return [one(first), *(future.result() for future in futures)]

    def _joined(self, states: Sequence[Transition]) -> Transition:
        self._state = Transition._make(map(np.concatenate, zip(*states, strict=True)))
        return self._state
