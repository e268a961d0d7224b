"""Chunks of a run: those that its folder holds, and new ones between them."""

import contextlib
from bisect import bisect_right
from collections.abc import Iterable, Iterator, Sequence

import polars as pl

from mjforage.base.errors import UserError
from mjforage.runs.costs import Cost, load_costs
from mjforage.runs.parquet import read_parquet
from mjforage.runs.storage import Chunk, RunFolder
from mjforage.runs.tables import KEYS, TABLES

CHUNK = 50  # episodes per unit of work at graph level
PHYSICS_CHUNK = 10  # the same with hulls, which take a second each
DEVICE_CHUNK = 500  # the same on a device, which steps many as fast as one


def chunk_size(world: str, device: str = "cpu") -> int:
    """Most episodes of a chunk."""
    if world == "graph":
        return CHUNK
    return PHYSICS_CHUNK if device == "cpu" else DEVICE_CHUNK


def plan(
    policies: Sequence[str],
    worlds: Sequence[str],
    episodes: int,
    stored: Iterable[Chunk] = (),
    device: str = "cpu",
) -> list[Chunk]:
    """All chunks of a run, in the order of its tables.

    New ones end where a multiple of their size is, or one that is stored begins.

    Parameters
    ----------
    stored : chunks that are finished, of this run or of fewer episodes of it
    device : of the hulls
    """
    sizes = {world: chunk_size(world, device) for world in worlds}
    counts: dict[tuple[str, str], dict[int, int]] = {}
    for chunk in sorted(stored):  # of two that begin at the same episode the longer
        if chunk.first + chunk.count <= episodes:
            counts.setdefault((chunk.world, chunk.policy), {})[chunk.first] = chunk.count
    return [
        Chunk(world, policy, first, count)
        for world in worlds
        for policy in policies
        for first, count in _spans(episodes, sizes[world], counts.get((world, policy), {}))
    ]


def _spans(episodes: int, size: int, stored: dict[int, int]) -> Iterator[tuple[int, int]]:
    """First episode and number of every chunk of a world and policy."""
    starts, first = sorted(stored), 0
    while first < episodes:
        later = starts[bisect_right(starts, first) :][:1]
        count = stored.get(first) or min(size - first % size, episodes - first)
        if first not in stored and later:
            count = min(count, later[0] - first)
        yield first, count
        first += count


def take_apart(folder: RunFolder) -> None:
    """Make chunks of the merged tables again, so that a run can go on to more episodes.

    Tables that are not all there, or do not hold what `costs.json` says, are left to be computed.
    Raises `UserError` if a table cannot be read or a chunk not be written.
    """
    places = {table: folder.path / f"{table}.parquet" for table in TABLES}
    if not all(place.is_file() for place in places.values()):
        return
    for chunk, cost in _recorded(folder):
        rows = (
            (pl.col("world") == chunk.world)
            & (pl.col("policy") == chunk.policy)
            & pl.col("episode").is_between(chunk.first, chunk.first + chunk.count - 1)
        )
        frames = {table: read_parquet(place, rows=rows) for table, place in places.items()}
        found = [set(frame.select(*KEYS).unique().rows()) for frame in frames.values()]
        if all(keys == set(chunk.keys) for keys in found):
            folder.write(chunk, frames, cost)


def _recorded(folder: RunFolder) -> list[tuple[Chunk, Cost]]:
    """Chunks of the merged tables that are no longer there by themselves."""
    ends: dict[tuple[str, str], int] = {}
    found = []
    with contextlib.suppress(UserError):
        for cost in load_costs(folder.path / "costs.json"):
            first = ends.get((cost.world, cost.policy), 0)
            ends[cost.world, cost.policy] = first + cost.episodes
            found.append((Chunk(cost.world, cost.policy, first, cost.episodes), cost))
    return [(chunk, cost) for chunk, cost in found if not folder.has_folder(chunk)]
