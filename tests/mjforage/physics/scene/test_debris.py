import pytest

from mjforage.scenario.debris import DebrisClass, load_debris

CLASSES = load_debris()


@pytest.mark.parametrize("kind", CLASSES, ids=lambda kind: kind.name)
def test_leeway_lies_in_the_published_range_of_its_class(kind: DebrisClass) -> None:
    assert kind.leeway_low <= kind.leeway <= kind.leeway_high


def test_leeway_follows_the_square_root_law() -> None:
    kind = DebrisClass("x", "", 1.0, 0.0, 0.02, 0.04, 1.2, 0.6, 0.0, 1.0)
    k = (1.224 * 1.2 * 0.02 / (1025.0 * 0.6 * 0.04)) ** 0.5
    assert kind.leeway == pytest.approx(k / (1.0 + k), rel=1e-12)


def test_the_papers_item_drifts_at_3_percent() -> None:
    paper = next(kind for kind in CLASSES if kind.name == "drifter")
    assert paper.leeway == pytest.approx(0.03, abs=1e-7)
