"""From an episode log to the metrics of scenario section 2, per episode and per step."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

import metrics
from graph_planner.fleet import Fleet
from mjforage.core.episode_log import EpisodeLog

Series = dict[str, NDArray[np.float64]]


@dataclass(frozen=True)
class Scores:
    """Metrics of a batch, by the keys of `summary.json`; undefined values are NaN.

    Attributes
    ----------
    scalars : key -> (episode,)
    series : key -> (episode, T + 1), padded with the last value; `irr` ends in NaN
    """

    scalars: Series
    series: Series


def event_table(log: EpisodeLog) -> metrics.EventTable:
    """The items' events of a batch: (episode, item)."""

    def times(values: NDArray[np.int16]) -> NDArray[np.float64]:
        return np.where(values < 0, metrics.NEVER, values.astype(np.float64))

    exists = np.arange(log.t_discovered.shape[1])[None, :] < log.n_items[:, None]
    return metrics.EventTable(
        times(log.t_discovered),
        log.discovered_by.astype(np.int64),
        times(log.t_collected),
        log.collected_by.astype(np.int64),
        exists,
    )


def _series(log: EpisodeLog, events: metrics.EventTable, fleet: Fleet, horizon: int) -> Series:
    exists, scouts, foragers = events.exists, fleet.discoverers, fleet.collectors
    irr = np.full(log.series["mi"].shape, np.nan)
    irr[:, :-1] = metrics.irr(log.series["mi"])
    found, taken = events.discovered_at, events.collected_at
    return log.series | {
        "pta_d": metrics.pta_series(found, exists, horizon),
        "pta_c": metrics.pta_series(taken, exists, horizon),
        "irr": irr,
        "csr": metrics.csr_series(events, scouts, horizon),
        "gini_scouts": metrics.team_gini_series(found, events.discovered_by, scouts, horizon),
        "gini_foragers": metrics.team_gini_series(taken, events.collected_by, foragers, horizon),
    }


def score(log: EpisodeLog, fleet: Fleet, horizon: int) -> Scores:
    """All metrics of a finished batch.

    Parameters
    ----------
    log : the batch, at its end
    fleet : whose indices the log's agents are
    horizon : T [step]
    """
    events = event_table(log)
    series = _series(log, events, fleet, horizon)
    scouts, foragers = fleet.discoverers, fleet.collectors
    final = {key: values[:, -1] for key, values in series.items() if key not in ("mi", "irr")}
    scalars = final | {
        "nt50": metrics.nt(series["pta_c"], 50.0),
        "nt90": metrics.nt(series["pta_c"], 90.0),
        "throughput": metrics.throughput(events.collected_at, foragers.size, horizon),
        "throughput_scouts": metrics.throughput(events.discovered_at, scouts.size, horizon),
        "mi_final": series["mi"][:, -1],
        "mi_mean": series["mi"].mean(axis=1),
        "irr_mean": series["irr"][:, :-1].mean(axis=1),
        "dsl": metrics.mean_dsl(events, scouts, horizon),
        "itl": metrics.itl(series["pta_d"], series["pta_c"]),
        "itl_level": metrics.itl_level(series["pta_d"], series["pta_c"]),
        "co_scouts": series["co_scouts"].mean(axis=1),
        "co_foragers": series["co_foragers"].mean(axis=1),
        "length": log.length.astype(np.float64),
        "cleared": (series["pta_c"][:, -1] >= 100.0).astype(np.float64),
    }
    return Scores(scalars, series)
