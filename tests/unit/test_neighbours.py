"""The angle of a row by its neighbours: exact on lines, and free of the row's own noise."""

import numpy as np

from cyclosweep.diagnosis.prepare.neighbours import angle_by_neighbours


def test_a_straight_piece_is_told_exactly() -> None:
    angle = np.r_[2.0 * np.arange(10.0), 50.0 - 3.0 * np.arange(8.0)]
    piece = np.repeat(np.arange(2), (10, 8))
    np.testing.assert_allclose(angle_by_neighbours(angle, piece), angle, atol=1e-12)


def test_the_own_reading_does_not_count() -> None:
    angle, piece = np.zeros(9), np.zeros(9, dtype=np.int64)
    for row in range(9):
        moved = angle.copy()
        moved[row] = 1.0
        assert angle_by_neighbours(moved, piece)[row] == 0.0


def test_other_pieces_do_not_count() -> None:
    angle = np.r_[np.zeros(6), np.full(6, 100.0)]
    piece = np.repeat(np.arange(2), 6)
    np.testing.assert_array_equal(angle_by_neighbours(angle, piece), angle)


def test_a_short_piece_keeps_its_readings() -> None:
    angle = np.array([1.0, 5.0, 7.0])
    np.testing.assert_array_equal(angle_by_neighbours(angle, np.array([0, 0, 1])), angle)
