"""Counter-based randomness: value = f(seed, episode, stream, index, step).

`uniforms` is for Python; all others but `episode_keys` are for kernels: Python's whole numbers are
signed, so a key that a kernel has given to Python is no key any more.

No generator carries state, so no number depends on batch size, order, worker or policy. The mixing
function is the 64-bit finaliser of SplitMix64 (Steele, Lea and Flood, "Fast splittable pseudorandom
number generators", OOPSLA 2014) with Stafford's "Mix13" constants, applied once more per
coordinate.
"""

import math
from enum import IntEnum

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mjforage.base.compiled import kernel

UInt64Array = NDArray[np.uint64]
Int64Array = NDArray[np.int64]
FloatArray = NDArray[np.float64]

_GOLDEN = np.uint64(0x9E3779B97F4A7C15)
_MIX_1 = np.uint64(0xBF58476D1CE4E5B9)
_MIX_2 = np.uint64(0x94D049BB133111EB)
_INDEX_STRIDE = np.uint64(0xD1342543DE82EF95)  # odd, so that index -> key is one-to-one
_S27, _S30, _S31, _S11 = np.uint64(27), np.uint64(30), np.uint64(31), np.uint64(11)
_TO_UNIT = 1.0 / (1 << 53)


class Stream(IntEnum):
    """Independent named streams of one episode (scenario: one seed, many streams)."""

    ITEMS = 1
    """Number of items, hotspot and initial positions."""
    WEATHER = 2
    """The constant drift vector of the episode."""
    NOISE = 3
    """Per-item drift noise, keyed by item and step."""
    STARTS = 4
    """Assignment of agents to start nodes."""
    POLICY = 5
    """Whatever a policy draws."""
    CORRUPTION = 6
    """Actions that are replaced, and their replacements."""
    GUSTS = 7
    """Gusts of the wind, keyed by the level and index of an interval of time."""
    CURRENT = 8
    """Direction and slow wander of the current, the latter keyed like gusts."""
    DETECTION = 9
    """Detection of an item in view, keyed by item and step."""
    SENSORS = 10
    """Noise of measured positions and headings, keyed by vessel and control tick."""
    CAMERA = 11
    """Errors of items' places in a camera's frame, keyed by vessel, item and control tick."""
    CAPTURE = 12
    """Collection of an item, where that is a matter of chance, keyed by item, agent and step."""
    SHADOWING = 13
    """Shadowing of a link, the same both ways, keyed by pair of agents and step."""
    LOSS = 14
    """Loss of all that a directed link carries, keyed by sender, receiver and step."""
    PACKETS = 15
    """Loss of a scan to noise, keyed by sender, receiver and scan, and by the step sent."""
    PERSISTENCE = 16
    """Difficulty of detecting each item, the same in all steps, keyed by item."""
    FALSE_POSITIVES = 17
    """Items that are seen and are none, keyed by node and epoch."""
    MERGING = 18
    """Missed detection of an item beside another, keyed by item and step."""
    POSITION = 19
    """Slow error of fixes, keyed by vessel, level and index of an interval of time."""
    OUTAGES = 20
    """Begin of outages of fixes, keyed by vessel and stretch of time."""
    LOG = 21
    """Noise of measured velocities, keyed by vessel, axis and control tick."""
    COMPASS = 22
    """Constant error of the compass, keyed by vessel."""
    FAULTS = 24
    """Times at which thrusters fail, keyed by thruster."""
    VESSELS = 25
    """Factors on mass, drag and thrust, keyed by vessel."""
    WAYPOINTS = 26
    """Waypoints and first heading of a vessel that is to be steered to them."""
    VARIANT = 32
    """Variant of its scenario that an episode of training has."""
    HARBOUR = 33
    """Size and shape of a generated map."""


@kernel
def mix(value: np.uint64) -> np.uint64:
    """One-to-one scrambling of 64 bits."""
    value = np.uint64(value)
    value = (value ^ (value >> _S30)) * _MIX_1
    value = (value ^ (value >> _S27)) * _MIX_2
    return value ^ (value >> _S31)


@kernel
def stream_key(episode_key: np.uint64, stream: int) -> np.uint64:
    """Key of one named stream of an episode."""
    return mix(np.uint64(episode_key) + np.uint64(stream) * _GOLDEN)


@kernel
def bits(key: np.uint64, index: int, step: int) -> np.uint64:
    """64 random bits of (stream key, index, step).

    The step is mixed in first, so that a loop over indices pays for one mixing each.
    """
    return mix(mix(np.uint64(key) + np.uint64(step) * _GOLDEN) + np.uint64(index) * _INDEX_STRIDE)


@kernel
def fill_bits(key: np.uint64, step: int, count: int, out: UInt64Array) -> None:
    """`bits` of the first `count` indices (index,) of a step, with all lanes of the processor."""
    for index in range(count):
        out[index] = bits(key, index, step)


@kernel
def to_uniform(random_bits: np.uint64) -> float:
    """A float64 in [0, 1) from 64 random bits: the upper 53."""
    return np.float64(random_bits >> _S11) * _TO_UNIT


@kernel
def uniform(key: np.uint64, index: int, step: int) -> float:
    """A float64 in [0, 1) of (stream key, index, step)."""
    return to_uniform(bits(key, index, step))


@kernel
def normal(key: np.uint64, index: int, step: int) -> float:
    """A standard normal of (stream key, index, step): Box-Muller on two of its uniforms."""
    radius = math.sqrt(-2.0 * math.log(1.0 - uniform(key, 2 * index, step)))
    return float(radius * math.cos(2.0 * math.pi * uniform(key, 2 * index + 1, step)))


@kernel
def _uniforms(
    keys: UInt64Array, stream: int, index: Int64Array, step: Int64Array, out: FloatArray
) -> None:
    for i in range(out.size):
        out[i] = uniform(stream_key(keys[i], stream), index[i], step[i])


def uniforms(
    keys: ArrayLike, index: ArrayLike, step: ArrayLike, stream: Stream = Stream.POLICY
) -> FloatArray:
    """Random numbers in [0, 1), evenly distributed, of (episode key, stream, index, step).

    What a policy in Python draws: `uniforms(seen.keys[:, None], np.arange(agents), seen.step[:,
    None])` is one for each row and agent (row, agent), the same whenever it is asked for.

    Parameters
    ----------
    keys : uint64, episode keys
    index : whole numbers that tell apart what is drawn in one step
    step : whole numbers; all three are broadcast together

    Raises
    ------
    ValueError
        If the keys are not uint64, or index or step no whole numbers.
    """
    key, which, at = np.asarray(keys), np.asarray(index), np.asarray(step)
    if key.dtype != np.uint64:
        raise ValueError(f"keys are {key.dtype}; give those of `reset` or `Observation.keys`")
    for name, array in (("index", which), ("step", at)):
        if array.dtype.kind not in "iu":
            raise ValueError(f"{name} is {array.dtype}; give whole numbers")
    shape = np.broadcast_shapes(key.shape, which.shape, at.shape)
    key, which, at = (np.broadcast_to(one, shape).flatten() for one in (key, which, at))
    out = np.empty(key.size)
    _uniforms(key, int(stream), which.astype(np.int64), at.astype(np.int64), out)
    return out.reshape(shape)


@kernel
def episode_key(seed: np.uint64, episode: int) -> np.uint64:
    """Key of an episode of a seed."""
    return mix(mix(np.uint64(seed) + _GOLDEN) + np.uint64(episode) * _INDEX_STRIDE)


@kernel
def _episode_keys(seed: np.uint64, episodes: NDArray[np.int64]) -> UInt64Array:
    """Key of each episode (episode,) of a seed."""
    keys = np.empty(episodes.size, np.uint64)
    for i in range(episodes.size):
        keys[i] = episode_key(seed, episodes[i])
    return keys


def episode_keys(seed: int, episodes: NDArray[np.int64]) -> UInt64Array:
    """Keys that stand for (seed, episode) everywhere.

    Parameters
    ----------
    seed : the run's seed, any integer of 0 <= seed < 2**64
    episodes : (episode,) indices of the episodes in the run

    Returns
    -------
    (episode,) uint64 keys

    Raises
    ------
    ValueError
        If the seed does not fit.
    """
    if not 0 <= seed < 1 << 64:
        raise ValueError(f"seed {seed}: must be at least 0 and below 2**64")
    return _episode_keys(np.uint64(seed), np.ascontiguousarray(episodes, np.int64))
