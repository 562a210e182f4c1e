import numpy as np
import pytest

from isthmus.tests.core.checker import dilations

SQUARE = np.array([(0, 0), (3, 0), (3, 4), (0, 4)], dtype=float)
NONE = np.empty((0, 2), dtype=int)


def test_along_the_boundary():
    assert dilations(SQUARE, [[0, 1, 2, 3]], NONE, [(0, 2), (1, 3)]) == pytest.approx([1.4, 1.4])


def test_through_a_cut():
    xy = np.array([(0, 0), (4, 0), (4, 1), (4, 2), (0, 2), (0, 1)], dtype=float)
    ring = [[0, 1, 2, 3, 4, 5]]
    before, after = (dilations(xy, ring, s, [(5, 2)])[0] for s in (NONE, [(0, 2)]))
    assert before == 6 / 4
    assert after == (1 + 17**0.5) / 4


def test_selected_edge_is_its_own_witness():
    assert dilations(SQUARE, [[0, 1, 2, 3]], [(2, 0)], [(0, 2)]) == [1.0]


def test_apart():
    xy = np.concatenate((SQUARE, SQUARE / 4 + 1))
    rings = [[0, 1, 2, 3], [4, 5, 6, 7]]
    assert dilations(xy, rings, NONE, [(0, 4)]) == [np.inf]
    assert np.isfinite(dilations(xy, rings, [(1, 5)], [(0, 4)])).all()


def test_touching_rings_are_joined():
    xy = np.array([(0, 0), (4, 0), (4, 4), (0, 4), (2, 1), (2, 2)], dtype=float)
    assert np.isfinite(dilations(xy, [[0, 1, 2, 3], [0, 5, 4]], NONE, [(4, 1)])).all()


def test_another_length():
    steps = dilations(SQUARE, [[0, 1, 2, 3]], NONE, [(0, 2)], length=lambda u, v: 1.0)
    assert steps == [2.0]
