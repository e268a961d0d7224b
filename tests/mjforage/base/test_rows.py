import numpy as np

from mjforage.base.rows import put_rows, scatter_rows


def test_rows_are_replaced_in_a_copy() -> None:
    into = np.arange(6).reshape(3, 2)
    result = scatter_rows(into, np.array([1]), np.array([[9, 8]]))
    assert result.tolist() == [[0, 1], [9, 8], [4, 5]]
    assert into[1].tolist() == [2, 3]


def test_rows_are_put_in_place_where_there_is_room() -> None:
    into, rows = np.arange(6).reshape(3, 2), np.array([1])
    assert put_rows(into, rows, np.array([[9]]), -1) is into
    assert into.tolist() == [[0, 1], [9, -1], [4, 5]]
    wider = put_rows(into, rows, np.array([[7, 7, 7]]), -1)
    assert wider.tolist() == [[0, 1, -1], [7, 7, 7], [4, 5, -1]] and into[1].tolist() == [9, -1]
    into.flags.writeable = False
    assert put_rows(into, rows, np.array([[3, 3]])).tolist() == [[0, 1], [3, 3], [4, 5]]
    assert into[1].tolist() == [9, -1]


def test_the_narrower_side_is_padded() -> None:
    into = np.ones((2, 2), np.int16)
    assert scatter_rows(into, np.array([0]), np.full((1, 3), 5, np.int16), -1).tolist() == [
        [5, 5, 5],
        [1, 1, -1],
    ]
    assert scatter_rows(into, np.array([1]), np.full((1, 1), 5, np.int16), -1).tolist() == [
        [1, 1],
        [5, -1],
    ]
    deep = scatter_rows(np.ones((2, 1, 2)), np.array([0]), np.full((1, 2, 1), 5.0), np.nan)
    np.testing.assert_array_equal(
        deep, [[[5, np.nan], [5, np.nan]], [[1, 1], [np.nan, np.nan]]], strict=False
    )
