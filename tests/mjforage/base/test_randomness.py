from typing import Any

import numpy as np
import pytest
from scipy import stats

from mjforage.base.randomness import (
    Stream,
    bits,
    episode_keys,
    fill_bits,
    normal,
    stream_key,
    to_uniform,
    uniform,
    uniforms,
)

GOLDEN = [0.10063856910330715, 0.04200778606163369, 0.2888124517485807]


def key_of(episode_key: np.uint64, stream: Stream) -> np.uint64:
    """Called from Python, a kernel gives a plain integer back."""
    return np.uint64(stream_key(episode_key, stream))


def test_an_episode_has_the_same_key_whatever_the_batch() -> None:
    whole = episode_keys(7, np.arange(100))
    assert episode_keys(7, np.array([42]))[0] == whole[42]
    assert episode_keys(7, np.array([99, 3])).tolist() == [whole[99], whole[3]]
    assert (
        np.unique(np.concatenate([episode_keys(s, np.arange(100)) for s in range(50)])).size == 5000
    )


@pytest.mark.parametrize("seed", [-1, 1 << 64])
def test_a_seed_that_does_not_fit_is_refused(seed: int) -> None:
    with pytest.raises(ValueError, match=f"seed {seed}"):
        episode_keys(seed, np.arange(2))


def test_numbers_stay_as_they_were_released() -> None:
    """Changing any of these changes every published result: bump the version and say so."""
    key = key_of(episode_keys(0, np.arange(1))[0], Stream.NOISE)
    assert [uniform(key, index, 3) for index in (0, 1, 5)] == GOLDEN


def test_uniforms_are_uniform_and_independent_across_index_step_stream_and_episode() -> None:
    keys = episode_keys(1, np.arange(40))
    draws = np.array(
        [
            [
                [[uniform(key_of(k, s), i, t) for t in range(20)] for i in range(10)]
                for s in (Stream.ITEMS, Stream.POLICY)
            ]
            for k in keys
        ]
    )
    assert stats.kstest(draws.ravel(), "uniform").pvalue > 0.01
    for axis in range(4):
        a, b = np.moveaxis(draws, axis, 0)[:-1], np.moveaxis(draws, axis, 0)[1:]
        assert abs(np.corrcoef(a.ravel(), b.ravel())[0, 1]) < 0.03


def test_normals_are_normal() -> None:
    key = key_of(episode_keys(2, np.arange(1))[0], Stream.ITEMS)
    draws = np.array([normal(key, i, 2) for i in range(5000)])
    assert stats.kstest(draws, "norm").pvalue > 0.01
    assert abs(np.corrcoef(draws[:-1], draws[1:])[0, 1]) < 0.04


def test_many_bits_are_those_of_each_index() -> None:
    key, out = np.uint64(stream_key(np.uint64(5), Stream.NOISE)), np.zeros(9, np.uint64)
    fill_bits(key, 3, 7, out)
    assert out.tolist() == [int(bits(key, i, 3)) for i in range(7)] + [0, 0]
    assert to_uniform(out[2]) == uniform(key, 2, 3)


def test_python_draws_for_many_keys_what_a_kernel_draws_for_each() -> None:
    keys, step = episode_keys(3, np.arange(500)), np.arange(500)
    drawn = uniforms(keys[:, None], np.arange(4), step[:, None])
    expected = [
        [uniform(key_of(key, Stream.POLICY), agent, at) for agent in range(4)]
        for at, key in enumerate(keys)
    ]
    assert drawn.tolist() == expected
    assert stats.kstest(drawn.ravel(), "uniform").pvalue > 0.01
    assert (keys >= 1 << 63).sum() > 200  # which Python's signed numbers do not hold
    assert uniforms(keys[7], 2, 9) == uniform(key_of(keys[7], Stream.POLICY), 2, 9)
    assert not np.array_equal(drawn, uniforms(keys[:, None], range(4), step[:, None], Stream.ITEMS))


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ((np.arange(3), 0, 1), "keys are int64; give those of `reset` or `Observation.keys`"),
        ((np.arange(3, dtype=np.uint64), 0.5, 1), "index is float64; give whole numbers"),
        ((np.arange(3, dtype=np.uint64), 0, 1.0), "step is float64; give whole numbers"),
    ],
)
def test_what_is_no_key_or_number_is_refused(given: tuple[object, ...], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        uniforms(*given)  # type: ignore[arg-type]


def test_a_small_key_that_went_through_python_is_still_one() -> None:
    keys = [key for key in episode_keys(0, np.arange(40)) if key < 1 << 63]
    for key in keys:
        plain: Any = int(key)
        assert stream_key(plain, Stream.POLICY) == stream_key(key, Stream.POLICY)
        assert uniform(plain, 3, 4) == uniform(key, 3, 4)
