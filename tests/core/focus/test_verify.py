"""The checker of focus maps: it finds what is planted, and crossings as brute force does."""

import sys

import numpy as np
import pytest
import shapely

pytest.importorskip("scipy")

from isthmus.core.focus.enlarge import enlarge

from ..shapes import box
from . import verify as checker
from .verify import crossing_pairs, faults, verify, with_splits

FEATURES = [[[0]], [[1], [2]], [[3, 4]]]  # the lines of each polygon of each feature


@pytest.fixture(scope="module")
def made():
    """Two neighbours, an island, and a square with a hole: what was, what is, and the result."""
    rings = [box(0, 0, 4, 4), box(4, 0, 8, 4), box(1, 6, 2, 7), box(4, 5, 8, 9), box(5, 6, 7, 8)[::-1]]
    rings = [np.append(ring, ring[:1], axis=0) for ring in map(np.array, rings)]
    starts = np.append(0, np.cumsum([len(ring) for ring in rings]))
    polygons = [lines for feature in FEATURES for lines in feature]
    result = enlarge(
        np.concatenate(rings), starts, polygons, shapely.box(4.5, 5.5, 7.5, 8.5), 1.5, growth=0.5
    )
    return result, *with_splits(np.concatenate(rings), starts, result)


def test_nothing_is_wrong(made):
    result, *lines = made
    assert verify(*lines, FEATURES) == (0, 0, 0, 0, True) and faults(result, *lines) == []


@pytest.mark.parametrize(
    "change, found",
    [
        ({(4, 0): (4.5, 0)}, {"apart": 1}),  # one of two that were one
        ({(2, 7): (0.5, 6.5)}, {"turned": 1, "invalid": 1}),  # a bow tie, in a feature of two polygons
        ({(1, 6): (np.nan, 6)}, {"finite": False}),
        ({(5, 6): (3, 6)}, {"crossings": 1, "invalid": 1}),  # the hole leaves its shell
    ],
)
def test_what_is_planted_is_found(made, change, found):
    _, before, _, starts = made
    after = before.copy()
    for (x, y), to in change.items():
        rows = np.flatnonzero((before == (x, y)).all(axis=1))
        rows = rows[:1] if "apart" in found else rows  # else at all corners there
        after[rows] = to
    verdict = verify(before, after, starts, FEATURES)._asdict()
    for name, least in found.items():
        assert verdict[name] == least if name == "finite" else verdict[name] >= least, (name, verdict)


def test_a_map_that_is_not_one_to_one_is_found(made):
    result, before, after, starts = made
    inner = int(np.flatnonzero(((result.points > 0) & (result.points < (8, 9))).all(axis=1))[0])
    cases = [
        (result._replace(triangles=result.triangles[1:]), "do not fill"),
        (result._replace(triangles=result.triangles[[0, *range(len(result.triangles))]]), "overlap"),
    ]
    for shift, said in (((20.0, 0.0), "turned"), (None, "turned"), (0.0, "not where its vertex is")):
        moved = result.moved.copy()
        if shift is None:  # flat: all three corners on one line, to the last bit
            a, b, c = result.triangles[(result.triangles == inner).any(axis=1)][0]
            moved[a], moved[b], moved[c] = (0.1, 0.1), (0.3, 0.3), (0.7, 0.7)
        elif shift:
            moved[inner] += shift
        else:
            moved[:] += 1.0
        cases.append((result._replace(moved=moved), said))
    corner = int(np.flatnonzero((result.points == result.points.max(axis=0)).all(axis=1))[0])
    moved = result.moved.copy()
    moved[corner] += 1.0
    cases.append((result._replace(moved=moved), "bent"))
    for broken, said in cases:
        assert any(said in fault for fault in faults(broken, before, after, starts)), said
    other = before.copy()
    other[6] += 0.01
    assert faults(result, other, after, starts) == ["a point of the map is no vertex"]
    said = []
    for corner in range(1, starts[1] - 1):  # of the first ring; some neighbours may have an edge
        skipped = np.delete(np.arange(len(before)), corner)
        said += faults(result, before[skipped], after[skipped], np.append(0, starts[1:] - 1))
    assert "a line of the map is no edge of triangles" in said


@pytest.mark.parametrize("seed", range(3))
def test_crossings_are_those_of_brute_force(seed, monkeypatch):
    from . import verify as checker

    monkeypatch.setattr(checker, "AT_ONCE", 7)
    rng = np.random.default_rng(seed)
    xy = rng.integers(0, 6, (30, 2)).astype(float)  # many touch, overlap, or are on one line
    edges = np.unique(np.sort(rng.integers(0, 30, (40, 2)), axis=1), axis=0)
    edges = edges[(xy[edges[:, 0]] != xy[edges[:, 1]]).any(axis=1)]
    found = set(map(tuple, crossing_pairs(xy, edges).tolist()))
    lines = shapely.linestrings(xy[edges])
    expected = {
        (a, b)
        for b in range(len(edges))
        for a in range(b)
        if not set(edges[a]) & set(edges[b]) and lines[a].intersects(lines[b])
    }
    assert found == expected and len(found) > 20


def test_a_polygon_is_triangulated_without_triangle_too(monkeypatch):
    """There is no Triangle for Python 3.14."""
    pytest.importorskip("triangle")
    points = np.array([(0, 0), (9, 1), (8, 7), (1, 6), (3, 2), (3.5, 4), (5, 3)], dtype=float) / 9.0
    number = [np.array([3, 0, 1, 2]), np.array([4, 5, 6])]
    with_triangle = {frozenset(corners) for corners in checker._corners(points, number).tolist()}
    monkeypatch.setitem(sys.modules, "triangle", None)
    without = {frozenset(corners) for corners in checker._corners(points, number).tolist()}
    assert without == with_triangle and len(without) == 7
