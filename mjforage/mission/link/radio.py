"""Exchange over a link: every agent has the knowledge that it has seen or received itself."""

from collections.abc import Set
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import BoundKernel, kernel
from mjforage.base.randomness import UInt64Array
from mjforage.base.rows import scatter_all, scatter_rows
from mjforage.base.views import CachedViews, read_only
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.graph_planner.graph.visibility import NodeLists
from mjforage.mission.exchange import Exchange, Ideal, LinkLog
from mjforage.mission.knowledge import Knowledge, Scans
from mjforage.mission.link.contacts import Air, Contacts, connect
from mjforage.mission.link.gossip import Inbox, Terms, Traffic, arrivals, inbox, pass_on, traffic
from mjforage.mission.scan_log import ScanLog, log_scans, take_in
from mjforage.mission.sensors.map_filter import MapFilter, add_scan, correct, round_off
from mjforage.mission.sensors.sensing import map_filter
from mjforage.mission.task import DelayedScans, Task
from mjforage.scenario.scenario import Scenario


class Net(NamedTuple):
    """A batch of exchanges."""

    air: Air
    terms: Terms
    keys: UInt64Array  # (episode,)
    views: NodeLists
    radius_number: NDArray[np.int64]  # (agent,)
    log: ScanLog
    contacts: Contacts
    inbox: Inbox
    traffic: Traffic
    delayed: Int32Array  # (row, scan) step x agents + agent of those received late in this step
    n_delayed: NDArray[np.int64]  # (row,)
    filtered: MapFilter


@kernel
def _weigh(net: Net, e: int, h: int, now: int, knowledge: Knowledge) -> None:
    """Bring an owner's filtered map up to date; from the first scan on if some were delayed."""
    row, agents = e * net.radius_number.size + h, net.radius_number.size
    filtered, log, received_at = net.filtered, net.log, net.inbox.received_at
    first = now
    if net.n_delayed[row]:
        filtered.density[row] = filtered.prior
        first = 0
    for s in range(first, now + 1):
        for a in range(agents):
            if 0 <= received_at[e, h, a, s] <= now:
                add_scan(filtered, a, log.node[e, s, a], log.shown[e, s, a])
        correct(filtered, row)
    round_off(filtered, row, knowledge)


@kernel
def _take_in(net: Net, active: NDArray[np.bool_], step: Int32Array, knowledge: Knowledge) -> None:
    """Let every owner receive what arrives now, and list what is delayed of it."""
    received, delayed, n_delayed = net.inbox.received, net.delayed, net.n_delayed
    agents = net.radius_number.size
    n_delayed[:] = 0
    for e in range(active.size):
        if not active[e]:
            continue
        number = arrivals(e, step[e], net.inbox)
        take_in(net.log, received[:number], net.views, net.radius_number, knowledge)
        for k in range(number):
            row, s = received[k, 0], received[k, 2]
            if s < step[e]:
                delayed[row, n_delayed[row]] = s * agents + received[k, 3]
                n_delayed[row] += 1
        for h in range(agents if net.filtered.density.shape[0] else 0):
            _weigh(net, e, h, step[e], knowledge)


@kernel
def _list_delayed(net: Net, scans: Int32Array, shown: NDArray[np.int16]) -> None:
    """Fill what `DelayedScans` holds of the scans received late in this step."""
    agents, log = net.radius_number.size, net.log
    for row in range(net.n_delayed.size):
        e = row // agents
        for i in range(net.n_delayed[row]):
            s, a = net.delayed[row, i] // agents, net.delayed[row, i] % agents
            scans[row, i, 0], scans[row, i, 1], scans[row, i, 2] = s, a, log.node[e, s, a]
            for k in range(shown.shape[2]):
                shown[row, i, k] = log.shown[e, s, a, k]


@kernel
def _update(net: Net, knowledge: Knowledge, scans: Scans) -> None:
    """Take in the scans of a step: log, connect, pass on, receive."""
    active, step = scans.active, scans.step
    log_scans(scans, net.views, net.radius_number, net.log)
    connect(net.air, net.keys, active, step, scans.agent_node, net.contacts)
    pass_on(net.terms, net.keys, active, step, net.log, net.contacts, net.inbox, net.traffic)
    _take_in(net, active, step, knowledge)


class Radio:
    """One owner per agent, which knows the scans that it made or received, and nothing else.

    The start nodes are known to all.
    """

    uses: Set[str] = frozenset({"relays"})

    def __init__(self, scenario: Scenario, agents: int) -> None:
        """Prepare; `scenario`: whose link is not ideal; `agents`: in the fleet."""
        self._scenario, self.owners = scenario, agents
        self.owner_of = read_only(np.arange(agents, dtype=np.int64))
        self._knowledge_views, self._net_views = CachedViews[Knowledge](), CachedViews[Net]()

    @property
    def knowledge(self) -> Knowledge:
        """Knowledge of every agent."""
        return self._knowledge_views.of(self._knowledge)

    @property
    def net(self) -> Net:
        """All arrays of the link, read-only."""
        return self._net_views.of(self._net)

    def reset(self, task: Task, scans: Scans, pooled: Knowledge, keys: UInt64Array) -> None:
        """Start a batch of episodes with the scans of step 0."""
        link, fleet, episodes = self._scenario.link, task.fleet, scans.step.size
        agents, rows = self.owners, episodes * self.owners
        terms = Terms(link.latency, link.bytes, link.cells, fleet.relays | link.relay)
        self._knowledge = Knowledge.of_starts(scans, len(task.graph), agents)
        self._net = Net(
            Air.of(link, task.graph, fleet),
            terms,
            keys,
            task.views,
            task.radius_number,
            ScanLog.of(task, episodes),
            Contacts.of(episodes, agents),
            inbox(episodes, agents, task.horizon),
            traffic(episodes),
            np.zeros((rows, agents * (task.horizon + 1)), np.int32),
            np.zeros(rows, np.int64),
            map_filter(self._scenario, task, rows),
        )
        self._update = BoundKernel(_update, self._net, self._knowledge)
        self.update(scans, pooled)

    def update(self, scans: Scans, pooled: Knowledge) -> None:
        """Process the scans of a step; knowledge of inactive episodes does not change."""
        self._update(scans.plain())

    @property
    def delayed(self) -> DelayedScans:
        """Older scans that owners received in this step, in order of their steps."""
        net = self._net
        rows, most = net.n_delayed.size, int(net.n_delayed.max(initial=0))
        scans = np.full((rows, most, 3), -1, np.int32)
        shown = np.zeros((rows, most, net.log.shown.shape[3]), np.int16)
        if most:
            _list_delayed(net, scans, shown)
        return read_only(DelayedScans(scans, shown))

    @property
    def link_log(self) -> LinkLog:
        """Traffic over the links so far."""
        net, traffic = self.net, self.net.traffic
        return LinkLog(
            contact=read_only(net.contacts.snr_db >= 0.0),
            delivered=read_only(traffic.sent - traffic.lost - net.inbox.in_flight),
            lost=traffic.lost,
            lost_now=net.contacts.lost,
            dropped=traffic.dropped,
            bytes=traffic.bytes,
            received_at=net.inbox.received_at,
            scans=net.log,
            views=net.views,
            radius_number=net.radius_number,
        )

    def replace_episodes(self, rows: NDArray[np.int64], other: Self, pooled: Knowledge) -> None:
        """Replace episodes (row,) of the batch by those of another."""
        mine, theirs = self._net, other._net
        own = (rows[:, None] * self.owners + np.arange(self.owners)).reshape(-1)
        self._knowledge = scatter_all(self._knowledge, own, other._knowledge)
        by_episode = "received_at", "newest", "complete", "arrived", "in_flight", "due"
        self._net = mine._replace(
            keys=scatter_rows(mine.keys, rows, theirs.keys),
            log=scatter_all(mine.log, rows, theirs.log),
            contacts=scatter_all(mine.contacts, rows, theirs.contacts),
            inbox=scatter_all(mine.inbox, rows, theirs.inbox, only=by_episode),
            traffic=scatter_all(mine.traffic, rows, theirs.traffic),
            delayed=scatter_rows(mine.delayed, own, theirs.delayed),
            n_delayed=scatter_rows(mine.n_delayed, own, theirs.n_delayed),
            filtered=mine.filtered.with_rows(own, theirs.filtered),
        )
        self._update = BoundKernel(_update, self._net, self._knowledge)


def exchange_of(scenario: Scenario, agents: int) -> Exchange:
    """The exchange over a scenario's link."""
    return Ideal() if scenario.link.model == "ideal" else Radio(scenario, agents)
