"""Fields of nodes between two steps."""

import numpy as np

from mjforage.view.render.node_fields import Fields


def test_a_quarter_of_a_step_on_every_field_is_a_quarter_of_the_way() -> None:
    shape, levels = (2, 3), ((0.5, 1.0), (-1.0, 3.0), (2.0, -2.0))
    now, later = (Fields(*(np.full(shape, pair[n], np.float32) for pair in levels)) for n in (0, 1))
    mixed = now.mixed(later, 0.25)
    assert [float(field[0, 0]) for field in mixed] == [0.625, 0.0, 1.0]
