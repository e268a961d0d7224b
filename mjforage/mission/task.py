"""The task and the observation: a policy's input before an episode and at every step."""

from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.views import read_only
from mjforage.graph_planner.graph.geodesics import Float32Array, Int32Array
from mjforage.graph_planner.graph.navigation import NavigationGraph
from mjforage.graph_planner.graph.visibility import NodeLists
from mjforage.mission.moves import MoveRules, all_targets
from mjforage.scenario.prior import Prior
from mjforage.scenario.roles import Fleet

NEVER = np.int16(-32768)
"""Value of `last_seen` for a node that no agent has seen yet."""


class TaskArrays(NamedTuple):
    """A task as kernels read it: moves, capabilities of each agent, and the ageing of maps."""

    neighbours: Int32Array  # (node, 8), -1 where there is no edge
    distances: Float32Array  # (node, node) geodesic [node], or (0, 0) on a large map
    rows: Int32Array  # (node,)
    cols: Int32Array  # (node,)
    moves: NDArray[np.int64]  # (agent,) nodes per decision
    stride_number: NDArray[np.int64]  # (agent,) which of `targets` has its nodes per decision
    targets: Int32Array  # (stride, node, 9) where moves end with nobody in the way, -1: illegal
    collects: NDArray[np.bool_]  # (agent,)
    radius_number: NDArray[np.int64]  # (agent,) which list of `NodeLists`
    stay: bool
    shorten: bool
    jump: bool
    forgetting: float  # growth of idleness per step
    radius: NDArray[np.float64]  # (agent,) [node]
    energy: NDArray[np.float64]  # (agent,) full store [node], inf without a limit
    horizon: int  # decisions


IDLE, TAKEN, MISSED, UNREACHABLE = 0, 1, 2, 3
PICKUPS = ("", "taken", "missed", "unreachable")
"""Results of a period of collecting, by agent: no item was sought, at least one item was collected,
an item was sought in vain, an item was given up after two attempts."""


class Pickup(NamedTuple):
    """Mean delays of collecting, in decisions beyond the one in which a vessel arrives."""

    first: NDArray[np.float64]  # (agent, quays, quarter) by quays beside the item, 0 to 2, and by
    # its bearing off the bow as the hull sets out from the next node, in quarters of half a circle
    more: NDArray[np.float64]  # (agent,) for every other item of the node: 1, if not taken at once


@dataclass(frozen=True, eq=False)
class Task:
    """The part of a scenario that decisions depend on. All that share it can only read its arrays.

    Attributes
    ----------
    graph, fleet, rules : map, agents and what they may do
    horizon : decisions in an episode
    prior : assumptions of planners before anything has been seen
    walls : boundary condition of items that drift onto land, of `graph_planner.graph.walls.WALLS`
    pickup : mean delays of collecting for vessels, which may miss items, collect those in passing,
        and do so while all drift; None where a forager collects all in its node before the drift
    reach_node : largest distance at which agents reach each other in open water; 0: none
    latency : decisions until a scan that was sent is received
    across_land : True if agents see across land
    """

    graph: NavigationGraph
    fleet: Fleet
    rules: MoveRules
    horizon: int
    prior: Prior = field(default_factory=Prior)
    walls: str = "clip"
    pickup: Pickup | None = None
    reach_node: float = np.inf
    latency: int = 0
    across_land: bool = False

    @property
    def forgetting(self) -> float:
        """Growth of idleness per step: 1 / (0.9 T) (definitions, section 1)."""
        return 1.0 / (0.9 * self.horizon)

    def exhausted(self, energy_left: NDArray[np.float64]) -> NDArray[np.bool_]:
        """(episode, agent) whether an agent can never move again by its energy left [node].

        It has less than its shortest move takes: a node where `shorten` is on, since others in the
        way of a longer move make it as short as that; else all nodes of a move.
        """
        return energy_left < (1 if self.rules.shorten else self.fleet.moves)

    @cached_property
    def view_radii(self) -> tuple[float, ...]:
        """Distinct sensing radii of the fleet, ascending [node]."""
        return tuple(sorted(set(self.fleet.radius.tolist())))

    @cached_property
    def radius_number(self) -> NDArray[np.int64]:
        """(agent,) index of each agent's radius in `view_radii`."""
        number = np.searchsorted(np.asarray(self.view_radii), self.fleet.radius)
        return read_only(number.astype(np.int64))

    @cached_property
    def views(self) -> NodeLists:
        """Nodes seen from every node, for each of `view_radii`."""
        lists = self.graph.discs if self.across_land else self.graph.views
        return lists(self.view_radii)

    @cached_property
    def arrays(self) -> TaskArrays:
        """The task as kernels read it."""
        stride_number, targets = all_targets(self.graph, self.fleet.moves, self.rules)
        return read_only(
            TaskArrays(
                neighbours=self.graph.neighbours,
                distances=self.graph.distances,
                rows=self.graph.rows,
                cols=self.graph.cols,
                moves=self.fleet.moves,
                stride_number=stride_number,
                targets=targets,
                collects=self.fleet.collects,
                radius_number=self.radius_number,
                stay=self.rules.stay,
                shorten=self.rules.shorten,
                jump=self.rules.jump,
                forgetting=self.forgetting,
                radius=self.fleet.radius,
                energy=self.fleet.energy,
                horizon=self.horizon,
            )
        )


class DelayedScans(NamedTuple):
    """Scans that an owner has received just now, and that are older: news that is delayed.

    Their content is in the observation too, where nothing newer is known; a policy that works
    with time takes them in at their own step. In order of their steps.
    """

    scans: Int32Array  # (row, scan, 3) step; agent whose it is; node where it was; padded with -1
    shown: NDArray[np.int16]  # (row, scan, place) items in the nodes in view, as `Task.views` lists
    # them, negative where it did not scan

    @property
    def step(self) -> Int32Array:
        """(row, scan) of the scan, -1 for padding."""
        return self.scans[..., 0]

    @property
    def agent(self) -> Int32Array:
        """(row, scan) agent that made it."""
        return self.scans[..., 1]

    @property
    def node(self) -> Int32Array:
        """(row, scan) where its agent was."""
        return self.scans[..., 2]


def no_delayed_scans(rows: int) -> DelayedScans:
    """No delayed scans, as over an ideal link."""
    return DelayedScans(np.zeros((rows, 0, 3), np.int32), np.zeros((rows, 0, 0), np.int16))


class Observation(NamedTuple):
    """Belief and time, in one row per belief owner, which decides for all agents.

    With ideal communication an episode is one row, and what it knows the fleet knows together;
    otherwise each owner has a row, and its answer counts for the agents that act by it.
    The arrays are live, read-only views: copy what shall last or be changed. Idleness is kept as
    the step at which a node was last seen: I = min(1, (step - last_seen) / (0.9 T)), 1 if never.
    """

    active: NDArray[np.bool_]  # (row,) False once an episode is over
    step: Int32Array  # (row,) the decision about to be taken, 1 for the first
    keys: NDArray[np.uint64]  # (row,) episode keys, for a policy's own randomness
    agent_node: Int32Array  # (row, agent) where each was at its last scan received
    energy_left: NDArray[np.float64]  # (row, agent) as of then [node]
    room_left: NDArray[np.int64]  # (row, agent) items it could take aboard, `UNLIMITED` if any
    belief: NDArray[np.int16]  # (row, node) believed items
    last_seen: NDArray[np.int16]  # (row, node) step, NEVER if not yet seen
    known: Int32Array  # (row, node) nodes with belief > 0, in no particular order
    n_known: Int32Array  # (row,) how many entries of `known` count
    agent_seen: Int32Array  # (row, agent) step of `agent_node`; now is `step` - 1
    taken: NDArray[np.int64]  # (row, agent) items it had taken aboard by then
    pickup: NDArray[np.int8]  # (row, agent) how its picking up ended then, see `PICKUPS`
    agent_yaw: NDArray[np.float64]  # (row, agent) heading then [rad], 0 east, counter-clockwise
    delayed_scans: Int32Array  # (row, scan, 3) see `DelayedScans`, of which these are the arrays
    delayed_shown: NDArray[np.int16]  # (row, scan, place)
    owner: Int32Array  # (row,) the agent that acts by this row, -1 if all do or several

    @property
    def delayed(self) -> DelayedScans:
        """Scans received just now that are older."""
        return DelayedScans(self.delayed_scans, self.delayed_shown)


class GroundTruth(NamedTuple):
    """Positions and drift of the items: for oracle bounds only, not for compared policies.

    Live, read-only views, like an observation.
    """

    item_rc: NDArray[np.float64]  # (episode, item, 2) [node]
    item_node: Int32Array  # (episode, item) node, -1 once removed or for padding
    drift_rc: NDArray[np.float64]  # (episode, 2) mean of those of the items left [node/step]
    item_drift_rc: NDArray[np.float64]  # (episode, item, 2) velocity at which wind and water carry
    # each item where it is, gusts and noise left out [node/step]
