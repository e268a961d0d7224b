"""Surfaces of the harbour as small tileable pictures, always the same."""

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

Image = NDArray[np.uint8]  # (height, width, 3); the last row is v = 0
SIDE = 256  # of a picture [pixel]


def _noise(seed: int, sigma: tuple[float, float]) -> NDArray[np.float64]:
    """Tileable noise (SIDE, SIDE) of mean 0 and deviation 1."""
    random = np.random.Generator(np.random.PCG64(seed))
    field = ndimage.gaussian_filter(random.standard_normal((SIDE, SIDE)), sigma, mode="wrap")
    scaled: NDArray[np.float64] = (field - field.mean()) / field.std()
    return scaled


def _tinted(light: NDArray[np.float64], colour: tuple[float, float, float]) -> Image:
    picture: Image = np.clip(light[..., None] * np.array(colour), 0, 255).astype(np.uint8)
    return picture


def planks(count: int = 8) -> Image:
    """Weathered boards side by side, for piers."""
    random = np.random.Generator(np.random.PCG64(21))
    board = np.arange(SIDE) * count // SIDE
    tone = 1.0 + 0.10 * random.standard_normal(count)[board]
    gap = np.where(np.arange(SIDE) * count % SIDE < 2 * count, 0.62, 1.0)
    light = (tone * gap)[None, :] * (1.0 + 0.045 * _noise(1, (14.0, 0.8)))
    joint = np.zeros((SIDE, SIDE), np.bool_)
    for number in range(count):
        start = int(random.integers(SIDE))
        joint[start : start + 2, board == number] = True
    return _tinted(np.where(joint, 0.7 * light, light), (186.0, 158.0, 122.0))


def concrete(slabs: int = 2) -> Image:
    """Slabs with fine joints, for quays and yards."""
    light = 1.0 + 0.022 * _noise(2, (1.2, 1.2)) + 0.03 * _noise(3, (24.0, 24.0))
    place = np.arange(SIDE) * slabs % SIDE
    joint = (place < 2 * slabs)[:, None] | (place < 2 * slabs)[None, :]
    return _tinted(np.where(joint, 0.86 * light, light), (178.0, 172.0, 160.0))


def lawn() -> Image:
    """Mown grass, for the land behind the quays."""
    light = 1.0 + 0.05 * _noise(9, (0.9, 0.9)) + 0.05 * _noise(10, (18.0, 18.0))
    return _tinted(light, (126.0, 148.0, 98.0))


def coping() -> Image:
    """Pale kerb stones."""
    light = 1.0 + 0.02 * _noise(4, (1.0, 1.0))
    place = np.arange(SIDE)
    joint = (place < 4)[:, None] | (place < 4)[None, :]
    return _tinted(np.where(joint, 0.8 * light, light), (238.0, 231.0, 216.0))


def wall() -> Image:
    """Courses of stone with fenders; dark and green where the water reaches."""
    rows = np.arange(SIDE)
    course, shift = rows * 6 // SIDE, (rows * 6 // SIDE) % 2 * (SIDE // 8)
    joint_v = (rows * 6 % SIDE < 14)[:, None]
    joint_h = (np.arange(SIDE)[None, :] + shift[:, None]) % (SIDE // 4) < 3
    tone = 1.0 + 0.05 * np.sin(7.3 * course)[:, None]
    light = tone * (1.0 + 0.04 * _noise(6, (3.0, 5.0)))
    light = np.where(joint_v | joint_h, 0.8 * light, light)
    stone = _tinted(light, (168.0, 158.0, 142.0)).astype(np.float64)
    height = 1.0 - (rows + 0.5) / SIDE  # v
    wet = np.clip((0.70 - height + 0.02 * _noise(8, (2.0, 10.0)).T[0]) / 0.05, 0.0, 1.0)[
        :, None, None
    ]
    stone += (np.array([70.0, 84.0, 70.0]) * light[..., None] - stone) * 0.85 * wet
    fender = np.abs(np.arange(SIDE) - SIDE / 2) < SIDE * 0.035
    stone[np.ix_((height > 0.45) & (height < 0.95), fender)] = (66.0, 68.0, 74.0)
    kerb = height > 0.93
    stone[kerb] = (226.0, 219.0, 204.0)
    return np.clip(stone, 0, 255).astype(np.uint8)


SHED_WALLS = ((236, 232, 222), (205, 216, 220), (226, 208, 186), (214, 222, 208))
SHED_ROOFS = ((150, 82, 66), (112, 124, 134), (160, 96, 74), (126, 134, 128))


def shed_palette() -> Image:
    """Walls in the lower half (v < 0.5), roofs in the upper; one column per shed colour."""
    roofs, walls = np.array(SHED_ROOFS, np.uint8), np.array(SHED_WALLS, np.uint8)
    step = 64 // len(roofs)
    upper, lower = (np.repeat(row[None], 32, axis=0).repeat(step, axis=1) for row in (roofs, walls))
    return np.concatenate((upper, lower))


def plain(colour: tuple[int, int, int]) -> Image:
    """One colour."""
    return np.full((4, 4, 3), colour, np.uint8)
