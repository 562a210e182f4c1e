"""The whole road."""

import csv
import sys
from pathlib import Path

import numpy as np
import pytest
import shapely

from isthmus.core import metric

from isthmus.core.partition import min_size
from isthmus.core.errors import Cancelled, MissingEngine, Unsolvable
from isthmus.core.partition.min_size import SELF

from .. import shapes
from ..brute_force import fewest_cuts
from ..shapes import ENGINES, box, shape
from ..verify import check_dilations, check_everything, check_parts, cut_pairs, polygons, solve

TAUS = [1.0, 1.5, 2.0, 3.0, 4.0, 6.0]


def cut_count(result):
    return int((result.role == SELF).sum())


# ---------------------------------------------------------------- optimal without holes


@pytest.mark.parametrize("share", [1.0, 0.6])
@pytest.mark.parametrize("size", [10**6, 5])
@pytest.mark.parametrize("seed", range(20))
def test_as_few_as_brute_force(seed, size, share, monkeypatch):
    monkeypatch.setattr(min_size, "NARROW", 10**9 * (seed % 2))
    s = shapes.mosaic(seed, 9, 0.6, size, holes=False)
    s = shapes.tour(seed, 4 + seed % 10) if len(s.coords) > 13 else s
    diagonals = shapes.random_diagonals(s.coords, seed, share)
    lines = s.coords[np.array(diagonals, dtype=int).reshape(-1, 2)]
    for tau, fewest in zip(TAUS, fewest_cuts(s.coords, diagonals, TAUS)):
        result = solve(s, tau, lines=lines)
        assert len(result.edges) == len(diagonals)
        assert cut_count(result) == fewest
        check_everything(result, s, tau)


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("seed", range(10))
def test_delaunay_candidates_against_brute_force(seed, engine):
    s = shapes.tour(seed, 5 + seed)
    for tau in TAUS:
        result = solve(s, tau, engine=engine)
        assert [cut_count(result)] == fewest_cuts(result.polygons.xy, result.edges, [tau])


@pytest.mark.parametrize("seed", range(10))
def test_all_candidates_at_tau_1(seed):
    """Where no three points are collinear, only the edge itself is as short as the edge."""
    s = shapes.tour(seed, 30)
    assert (solve(s, 1.0).role == SELF).all()


@pytest.mark.parametrize("seed", range(10))
def test_fewer_cuts_as_tau_grows(seed):
    s = shapes.tour(seed, 60)
    counts = [cut_count(solve(s, tau)) for tau in np.linspace(1, 12, 40)]
    assert counts == sorted(counts, reverse=True)
    assert counts[0] > counts[-1]


def test_infinite_tau_leaves_only_what_connects_holes():
    assert cut_count(solve(shapes.DUMBBELL, np.inf)) == 0
    assert cut_count(solve(shapes.TWO_HOLES, np.inf)) == 2


# ---------------------------------------------------------------- any polygon

CASES = {
    **shapes.TOUCHING,
    "triangle": shapes.TRIANGLE,
    "dumbbell": shapes.DUMBBELL,
    "annulus": shapes.ANNULUS,
    "two holes": shapes.TWO_HOLES,
    "lattice of holes": shapes.lattice_of_holes(3),
    "comb": shapes.comb(4),
    "circle": shapes.shape(np.rint(shapes.circle(32, 1e6))),
    **{f"mosaic {seed}": shapes.mosaic(seed, 35) for seed in range(12)},
    **{f"lattice mosaic {seed}": shapes.mosaic(seed, 35, size=7) for seed in range(12)},
    **{f"polyomino {seed}": shapes.polyomino(seed, 6, 6, 0.7, 0.5) for seed in range(12)},
}


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("tau", [1.0, 2.0, 4.0])
@pytest.mark.parametrize("name", CASES)
def test_guarantees(name, tau, engine):
    s = CASES[name]
    check_everything(solve(s, tau, engine=engine, all_dilations=tau != 4.0), s, tau)


@pytest.mark.parametrize("seed", range(10))
def test_guarantees_with_lines_as_candidates(seed):
    s = shapes.mosaic(seed, 25)
    points = np.unique(s.coords, axis=0)
    lines = points[np.column_stack(np.triu_indices(len(points), 1))]
    for tau in (1.5, 3.0):
        check_everything(solve(s, tau, lines=lines), s, tau)


@pytest.mark.parametrize("name", CASES)
def test_the_same_cuts_however_it_is_told(name):
    s = CASES[name]
    for tau in (1.5, 4.0):
        expected = cut_pairs(solve(s, tau), s.coords)
        for other in (
            shapes.restarted(s, 1),
            shapes.restarted(s, 5),
            shapes.reversed_rings(s),
            shapes.reordered_holes(s, 1),
            shapes.with_duplicates(s, 2),
        ):
            assert cut_pairs(solve(other, tau), other.coords) == expected


@pytest.mark.parametrize("seed", range(10))
def test_the_same_number_turned_scaled_and_moved(seed):
    s = shapes.tour(seed, 50)
    turn = np.exp(1j * (1 + seed)) * 10.0 ** (seed - 5)
    turn = np.array([[turn.real, turn.imag], [-turn.imag, turn.real]])
    for tau in (1.3, 2.0, 5.0):
        moved = s.mapped(lambda xy: (xy + [1e6, -3e5]) @ turn)
        assert cut_count(solve(moved, tau)) == cut_count(solve(s, tau))


@pytest.mark.parametrize("power", [-500, -200, -60, 60, 200, 490])
@pytest.mark.parametrize("name", ["dumbbell", "two holes", "touch in edge", "mosaic 1"])
def test_the_same_cuts_at_any_power_of_two(name, power):
    s = CASES[name]
    scaled = s.mapped(lambda xy: np.ldexp(xy, power))
    one, two = solve(s, 2.0), solve(scaled, 2.0)
    assert np.array_equal(one.role, two.role)
    assert [len(rings) for rings in one.parts.rings] == [len(rings) for rings in two.parts.rings]
    assert np.array_equal(np.ldexp(one.length, power), two.length)
    assert np.array_equal(one.detour, two.detour)
    assert one.largest_dilation == two.largest_dilation


# ---------------------------------------------------------------- small edges and small holes


@pytest.mark.parametrize("seed", range(12))
def test_min_length(seed):
    s = shapes.mosaic(seed, 35, holes=seed % 3 > 0)
    for floor in (1e5, 3e5):
        result = solve(s, 2.0, min_length=floor)
        check_everything(result, s, 2.0, min_length=floor)
        assert (result.length >= floor).all()


@pytest.mark.parametrize("seed", range(6))
def test_shorter_edges_are_only_there_to_connect_holes(seed):
    s = shapes.polyomino(seed, 7, 7, 0.85, 0.5)
    result = solve(s, 2.0, min_length=2.5)
    check_everything(result, s, 2.0, min_length=2.5)
    shorter = result.length < 2.5
    assert 0 < shorter.sum() <= len(s.rings) - 1


def test_a_floor_above_everything_leaves_only_what_connects_holes():
    result = solve(shapes.TWO_HOLES, 1.0, min_length=1e9)
    assert cut_count(result) == 2 and len(result.edges) == 2
    assert result.largest_dilation == 1.0
    assert [len(rings) for rings in result.parts.rings] == [3]


ARCHIPELAGO = shape(
    box(0, 0, 40, 20),
    box(4, 4, 12, 16)[::-1],
    box(24, 4, 32, 16)[::-1],
    box(17, 9, 18, 10)[::-1],
    box(20, 3, 21, 4)[::-1],
    [(12, 10), (13, 11), (13, 9)],
)


@pytest.mark.parametrize("tau", [1.0, 2.0, 4.0])
def test_small_holes_get_no_cut_and_stay_holes(tau):
    result = solve(ARCHIPELAGO, tau, min_hole=5.0)
    check_parts(result, ARCHIPELAGO)
    check_dilations(result, tau)
    small = {tuple(p) for ring in ARCHIPELAGO.rings[3:5] for p in ring} | {(13, 11), (13, 9)}
    ends = {p for pair in cut_pairs(result, ARCHIPELAGO.coords) for p in pair}
    assert not ends & small
    holes = [
        {tuple(p) for p in shapely.get_coordinates(ring)}
        for part in polygons(result, ARCHIPELAGO.coords)
        for ring in part.interiors
    ]
    for ring in ARCHIPELAGO.rings[3:5]:
        assert {tuple(p) for p in ring} in holes


def test_no_hole_counts():
    result = solve(ARCHIPELAGO, 1.0, min_hole=np.inf)
    assert cut_count(result) == 0
    assert [len(rings) for rings in result.parts.rings] == [6]


def test_a_hole_that_only_small_ones_could_connect():
    """An island ringed by islets: all its diagonals end at them."""
    islets = [shapes.circle(4, 0.4, centre)[::-1] for centre in shapes.circle(16, 3.0)]
    s = shape(shapes.circle(24, 30.0), shapes.circle(6, 1.5)[::-1], *islets)
    result = solve(s, 2.0, min_hole=1.0)
    assert sum(part.area for part in polygons(result, s.coords)) == pytest.approx(s.polygon.area)


def test_holes_that_no_line_connects():
    lines = np.array([[(0, 0), (4, 4)]], dtype=float)
    with pytest.raises(Unsolvable, match="do not connect 1 of 2 holes"):
        solve(shapes.TWO_HOLES, 2.0, lines=lines)
    assert cut_count(solve(shapes.ANNULUS, np.inf, lines=lines)) == 1


# ---------------------------------------------------------------- what comes back


@pytest.mark.parametrize(
    "tau, cuts, areas",
    [
        (4.0, 1, [104, 100]),
        (19.0, 0, [204]),
    ],
)
def test_dumbbell(tau, cuts, areas):
    result = solve(shapes.DUMBBELL, tau)
    assert cut_count(result) == cuts
    assert result.parts.area.tolist()[: len(areas)] == areas


def test_sides_length_and_detour_of_a_cut():
    result = solve(shapes.DUMBBELL, 5.0, lines=[[(10, 4), (10, 6)]])
    assert sorted(result.parts.sides[0].tolist()) == [0, 1]
    assert result.length.tolist() == [2.0]
    assert result.detour.tolist() == [19.0], "around the left room"


@pytest.mark.parametrize("seed", range(5))
def test_other_ordinates_never_matter(seed):
    s = shapes.mosaic(seed, 30)
    plain, numbered = solve(s, 2.0), solve(shapes.numbered(s), 2.0)
    assert np.array_equal(plain.edge_rows, numbered.edge_rows)
    for one, two in zip(plain.parts.rings, numbered.parts.rings):
        assert all(np.array_equal(a, b) for a, b in zip(one, two))


def test_input_is_left_as_it_is():
    s = shapes.mosaic(1, 30)
    before = s.coords.copy()
    solve(s, 2.0)
    assert np.array_equal(s.coords, before)


# ---------------------------------------------------------------- hostile input


def teeth(n):
    """Long walls beside short cuts: sums of lengths cancel."""
    up = [(k, 1e6 * (k % 2)) for k in range(n)]
    return shape(up + [(n, -1), (-1, -1)])


HOSTILE = {
    "one row twice": shape([(0, 0), (10, 0), (10, 0), (10, 10), (0, 10)]),
    "closed": shape([(0, 0), (10, 0), (10, 10), (0, 10), (0, 0)]),
    "nearly twice": shape([(0, 0), (1, 0), (1, 2**-43), (1, 1), (0, 1), (0, 0.5 + 2**-43), (0, 0.5)]),
    "sliver": shape([(0, 0), (1000, 0), (1000, 2**-13), (0, 2**-13)]),
    "needle": shape([(0, 0), (1000, 2**-43), (2000, 0), (1000, 2**-42)]),
    "far from the origin": shapes.DUMBBELL.mapped(lambda xy: xy * 2**-10 + 2**24),
    "teeth": teeth(41),
    "spiral": shapes.spiral(4),
    "koch": shapes.koch(3),
    "circle": shape(shapes.circle(64)),
}


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("name", HOSTILE)
def test_hostile_but_solvable(name, engine):
    s = HOSTILE[name]
    for tau in (1.5, 4.0):
        result = solve(s, tau, engine=engine)
        check_dilations(result, tau)
        parts = polygons(result, s.coords)
        assert all(shapely.is_valid(part) for part in parts)
        assert sum(part.area for part in parts) == pytest.approx(s.polygon.area, rel=1e-9)


@pytest.mark.parametrize("factor", [1e300, 1e150, 1e80, 1e-90, 1e-170, 1e-300])
def test_extreme_values(factor):
    result = solve(shapes.DUMBBELL.mapped(lambda xy: xy * factor), 4.0)
    assert cut_count(result) == 1
    assert result.length[result.role == SELF] == pytest.approx(2.0 * factor)
    assert len(result.parts.rings) == 2
    assert result.largest_dilation <= 4.0 * (1 + 1e-9)


def test_841_holes():
    s = shapes.lattice_of_holes(29)
    result = solve(s, 4.0)
    assert cut_count(result) >= 841
    check_parts(result, s)
    assert result.largest_dilation <= 4.0 * (1 + 1e-9)


def test_a_large_koch_curve():
    s = shapes.koch(6)
    counts = []
    for tau in (2.0, 4.0, 8.0):
        result = solve(s, tau)
        counts.append(cut_count(result))
        assert result.largest_dilation <= tau * (1 + 1e-9)
        assert result.parts.area.sum() == pytest.approx(s.polygon.area)
    assert counts == sorted(counts, reverse=True) and counts[0] > 0


def test_no_engine():
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(sys.modules, "triangle", None)
        patch.setitem(sys.modules, "pythoncdt", None)
        patch.delattr(shapely, "constrained_delaunay_triangles", raising=False)
        with pytest.raises(MissingEngine):
            solve(shapes.SQUARE)
        lines = [[(0, 0), (10, 10)]]
        assert len(solve(shapes.SQUARE, lines=lines).edges) == 1, "lines need no engine"


# ---------------------------------------------------------------- progress and cancel


@pytest.mark.parametrize("s", [shapes.DUMBBELL, shapes.lattice_of_holes(4)], ids=["plain", "holes"])
def test_cancel_at_any_time(s):
    asked = 0

    def never():
        nonlocal asked
        asked += 1
        return False

    expected = cut_count(solve(s, 2.0, cancelled=never))
    assert asked > 5
    for when in range(1, asked + 1):
        calls = iter(range(1, asked + 1))
        with pytest.raises(Cancelled):
            solve(s, 2.0, cancelled=lambda: next(calls) == when)
    assert cut_count(solve(s, 2.0)) == expected


def test_progress_runs_from_0_to_1():
    shares = []
    solve(shapes.lattice_of_holes(4), 2.0, progress=shares.append)
    assert shares == sorted(shares)
    assert shares[0] == 0.0 and shares[-1] == 1.0
    assert len(shares) > 5


# ---------------------------------------------------------------- a real map


@pytest.fixture(scope="module")
def western_europe():
    path = Path(__file__).parents[2] / "data" / "western_europe.csv"
    with open(path) as file:
        return np.array([[float(row["lon"]), float(row["lat"])] for row in csv.DictReader(file)])


@pytest.mark.parametrize("tau, fewest", [(2, 509), (4, 151), (6, 77), (10, 40)])
def test_western_europe(tau, fewest, western_europe):
    """The values of an independent solver."""
    lon, lat = western_europe.T
    xy = np.column_stack(((lon - 10) * np.cos(np.radians(lat)), lat - 48)) * 111.32
    result = solve(shape(xy), tau)
    assert cut_count(result) == fewest
    assert len(result.parts.rings) == fewest + 1
    assert result.largest_dilation <= tau * (1 + 1e-9)
    assert all(shapely.is_valid(part) for part in polygons(result, xy))


def test_western_europe_in_degrees(western_europe):
    """On the ellipsoid: nearly the same cuts as on a map of it, lengths in metres."""
    result = solve(shape(western_europe), 4.0, measure=metric.ellipsoidal())
    assert 140 <= cut_count(result) <= 160
    assert result.parts.area.sum() == pytest.approx(3.37e12, rel=0.05)
    assert result.largest_dilation <= 4.0 * (1 + 1e-9)
