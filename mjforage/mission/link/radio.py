"""The exchange over a link: every agent holds what it has seen and heard itself."""

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
from mjforage.mission.knowledge import Knowledge, Looks
from mjforage.mission.link.contacts import Air, Contacts, connect
from mjforage.mission.link.gossip import Mail, Terms, Traffic, arrivals, mail, pass_on, traffic
from mjforage.mission.look_log import LookLog, log_looks, take_in
from mjforage.mission.map_filter import MapFilter, correct, glimpse, round_off
from mjforage.mission.sensing import map_filter
from mjforage.mission.task import Late, Task
from mjforage.scenario.scenario import Scenario


class Net(NamedTuple):
    """A batch of exchanges."""

    air: Air
    terms: Terms
    keys: UInt64Array  # (episode,)
    views: NodeLists
    radius_number: NDArray[np.int64]  # (agent,)
    log: LookLog
    contacts: Contacts
    mail: Mail
    traffic: Traffic
    late: NDArray[np.int32]  # (row, look) step x agents + agent of those heard late in this step
    n_late: NDArray[np.int64]  # (row,)
    filtered: MapFilter


@kernel
def _weigh(net: Net, e: int, h: int, now: int, knowledge: Knowledge) -> None:
    """Bring a holder's filtered map up to date; from the first look on if some were late."""
    row, agents = e * net.radius_number.size + h, net.radius_number.size
    filtered, log, heard_at = net.filtered, net.log, net.mail.heard_at
    first = now
    if net.n_late[row]:
        filtered.density[row] = filtered.prior
        first = 0
    for s in range(first, now + 1):
        for a in range(agents):
            if 0 <= heard_at[e, h, a, s] <= now:
                glimpse(filtered, a, log.node[e, s, a], log.shown[e, s, a])
        correct(filtered, row)
    round_off(filtered, row, knowledge)


@kernel
def _take_in(net: Net, active: NDArray[np.bool_], step: Int32Array, knowledge: Knowledge) -> None:
    """Let every holder hear what arrives now, and list what is late of it."""
    heard, late, n_late, agents = net.mail.heard, net.late, net.n_late, net.radius_number.size
    n_late[:] = 0
    for e in range(active.size):
        if not active[e]:
            continue
        number = arrivals(e, step[e], net.mail)
        take_in(net.log, heard[:number], net.views, net.radius_number, knowledge)
        for k in range(number):
            row, s = heard[k, 0], heard[k, 2]
            if s < step[e]:
                late[row, n_late[row]] = s * agents + heard[k, 3]
                n_late[row] += 1
        for h in range(agents if net.filtered.density.shape[0] else 0):
            _weigh(net, e, h, step[e], knowledge)


@kernel
def _list_late(net: Net, looks: Int32Array, shown: NDArray[np.int16]) -> None:
    """Fill what `Late` holds of the looks heard late in this step."""
    agents, log = net.radius_number.size, net.log
    for row in range(net.n_late.size):
        e = row // agents
        for i in range(net.n_late[row]):
            s, a = net.late[row, i] // agents, net.late[row, i] % agents
            looks[row, i, 0], looks[row, i, 1], looks[row, i, 2] = s, a, log.node[e, s, a]
            for k in range(shown.shape[2]):
                shown[row, i, k] = log.shown[e, s, a, k]


@kernel
def _tell(net: Net, knowledge: Knowledge, looks: Looks) -> None:
    """Take in the looks of a step: log, connect, pass on, hear."""
    active, step = looks.active, looks.step
    log_looks(looks, net.views, net.radius_number, net.log)
    connect(net.air, net.keys, active, step, looks.agent_node, net.contacts)
    pass_on(net.terms, net.keys, active, step, net.log, net.contacts, net.mail, net.traffic)
    _take_in(net, active, step, knowledge)


class Radio:
    """One holder per agent, who knows the looks that it made or heard, and nothing else.

    Where everybody starts is known to all.
    """

    uses: Set[str] = frozenset({"relays"})

    def __init__(self, scenario: Scenario, agents: int) -> None:
        """Prepare.

        Parameters
        ----------
        scenario : whose link is not ideal
        agents : in the fleet
        """
        self._scenario, self.holders = scenario, agents
        self.holder_of = read_only(np.arange(agents, dtype=np.int64))
        self._lent_knowledge, self._lent_net = CachedViews[Knowledge](), CachedViews[Net]()

    @property
    def knowledge(self) -> Knowledge:
        """What every agent knows."""
        return self._lent_knowledge.of(self._knowledge)

    @property
    def net(self) -> Net:
        """All that there is of the link, to be read."""
        return self._lent_net.of(self._net)

    def reset(self, task: Task, looks: Looks, pooled: Knowledge, keys: UInt64Array) -> None:
        """Start a batch of episodes with the looks of step 0."""
        link, fleet, episodes = self._scenario.link, task.fleet, looks.step.size
        agents, rows = self.holders, episodes * self.holders
        terms = Terms(link.latency, link.bytes, link.cells, fleet.relays | link.relay)
        self._knowledge = Knowledge.of_starts(looks, len(task.graph), agents)
        self._net = Net(
            Air.of(link, task.graph, fleet),
            terms,
            keys,
            task.views,
            task.radius_number,
            LookLog.of(task, episodes),
            Contacts.of(episodes, agents),
            mail(episodes, agents, task.horizon),
            traffic(episodes),
            np.zeros((rows, agents * (task.horizon + 1)), np.int32),
            np.zeros(rows, np.int64),
            map_filter(self._scenario, task, rows),
        )
        self._tell = BoundKernel(_tell, self._net, self._knowledge)
        self.tell(looks, pooled)

    def tell(self, looks: Looks, pooled: Knowledge) -> None:
        """Take in the looks of a step; what inactive episodes know does not change."""
        self._tell(looks.plain())

    @property
    def late(self) -> Late:
        """The looks that holders heard in this step and that are older, in order of their steps."""
        net = self._net
        rows, most = net.n_late.size, int(net.n_late.max(initial=0))
        looks = np.full((rows, most, 3), -1, np.int32)
        shown = np.zeros((rows, most, net.log.shown.shape[3]), np.int16)
        if most:
            _list_late(net, looks, shown)
        return read_only(Late(looks, shown))

    @property
    def link_log(self) -> LinkLog:
        """What went over the links so far."""
        net, traffic = self.net, self.net.traffic
        return LinkLog(
            contact=read_only(net.contacts.snr_db >= 0.0),
            delivered=read_only(traffic.sent - traffic.lost - net.mail.flying),
            lost=traffic.lost,
            lost_now=net.contacts.lost,
            dropped=traffic.dropped,
            bytes=traffic.bytes,
            heard_at=net.mail.heard_at,
            looks=net.log,
            views=net.views,
            radius_number=net.radius_number,
        )

    def adopt(self, rows: NDArray[np.int64], other: Self, pooled: Knowledge) -> None:
        """Replace episodes (row,) of the batch by those of another."""
        mine, theirs = self._net, other._net
        own = (rows[:, None] * self.holders + np.arange(self.holders)).reshape(-1)
        self._knowledge = self._knowledge.with_rows(own, other._knowledge)

        moved = {
            name: scatter_rows(getattr(mine.mail, name), rows, getattr(theirs.mail, name))
            for name in ("heard_at", "newest", "complete", "arrived", "flying", "landing")
        }
        self._net = mine._replace(
            keys=scatter_rows(mine.keys, rows, theirs.keys),
            log=scatter_all(mine.log, rows, theirs.log),
            contacts=scatter_all(mine.contacts, rows, theirs.contacts),
            mail=mine.mail._replace(**moved),
            traffic=scatter_all(mine.traffic, rows, theirs.traffic),
            late=scatter_rows(mine.late, own, theirs.late),
            n_late=scatter_rows(mine.n_late, own, theirs.n_late),
            filtered=mine.filtered.with_rows(own, theirs.filtered),
        )
        self._tell = BoundKernel(_tell, self._net, self._knowledge)


def exchange_of(scenario: Scenario, agents: int) -> Exchange:
    """The exchange over a scenario's link."""
    return Ideal() if scenario.link.model == "ideal" else Radio(scenario, agents)
