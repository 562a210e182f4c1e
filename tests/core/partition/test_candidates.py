import numpy as np
import pytest
import shapely

from isthmus.core.partition.candidates import (
    ACCEPTED,
    CROSSES,
    LEAVES,
    OFF_VERTICES,
    REPEATED,
    TOUCHES,
    counted,
    from_lines,
    from_triangulation,
)
from isthmus.core.partition.polygon import boundary_components
from isthmus.core.metric import planar
from isthmus.core.partition.polygon import one as from_rings

from .. import shapes

NAN = float("nan")


def verdicts(s, *lines):
    return from_lines(from_rings(*s), np.array(lines, dtype=float))


@pytest.mark.parametrize(
    "line, verdict",
    [
        ([(10, 4), (10, 6)], ACCEPTED),
        ([(10, 6), (10, 4)], ACCEPTED),
        ([(10 + 1e-9, 4), (10, 6)], ACCEPTED),
        ([(10 + 1e-6, 4), (10, 6)], OFF_VERTICES),
        ([(5, 5), (10, 6)], OFF_VERTICES),
        ([(10, 4), (10, 4)], OFF_VERTICES),
        ([(NAN, 4), (10, 6)], OFF_VERTICES),
        ([(10, 4), (np.inf, 6)], OFF_VERTICES),
        ([(10, 0), (12, 0)], LEAVES),
        ([(10, 0), (22, 10)], LEAVES),
        ([(0, 0), (10, 0)], TOUCHES),
        ([(10, 0), (10, 6)], TOUCHES),
    ],
)
def test_one_line(line, verdict):
    found = verdicts(shapes.DUMBBELL, line)
    assert found.verdict.tolist() == [verdict]
    assert found.edge_line.tolist() == [0] * (verdict == ACCEPTED)


def test_no_line():
    found = from_lines(from_rings(*shapes.DUMBBELL), np.empty((0, 2, 2)))
    assert found.edges.shape == (0, 2)


def test_a_repeated_line_names_the_first():
    found = verdicts(shapes.DUMBBELL, [(10, 4), (12, 6)], [(10, 4), (10, 6)], [(10, 6), (10, 4)])
    assert found.verdict.tolist() == [ACCEPTED, ACCEPTED, REPEATED]
    assert found.other.tolist() == [-1, -1, 1]


def test_the_shorter_of_two_crossing_lines_stays():
    free = [(10, 4), (12, 6)]
    found = verdicts(shapes.DUMBBELL, [(0, 0), (10, 10)], [(0, 10), (10, 4)], free)
    assert found.verdict.tolist() == [CROSSES, ACCEPTED, ACCEPTED]
    assert found.other.tolist() == [1, -1, -1]


def test_a_line_that_crosses_only_a_rejected_one_stays():
    """a < b < c, b crosses a and c: a and c stay."""
    room = shapes.shape([(0, 0), (3, 0), (6, 0), (20, 0), (20, 10), (9, 10), (4, 4), (0, 4)])
    a, b, c = [(0, 4), (3, 0)], [(0, 0), (4, 4)], [(6, 0), (4, 4)]
    found = verdicts(room, c, b, a)
    assert found.verdict.tolist() == [ACCEPTED, CROSSES, ACCEPTED]


@pytest.mark.parametrize("seed", range(20))
def test_what_is_accepted_is_a_set_of_diagonals(seed):
    """All pairs of vertices: the verdicts against shapely, and the greedy rule."""
    s = shapes.mosaic(seed, 12, size=12, holes=seed % 2 == 0)
    points = np.unique(s.coords, axis=0)
    u, v = np.triu_indices(len(points), 1)
    lines = points[np.column_stack((u, v))]
    found = verdicts(s, *lines)

    segments = shapely.linestrings(lines)
    diagonal = shapely.relate_pattern(s.polygon, segments, "1**F**F**")
    assert np.array_equal(np.isin(found.verdict, (ACCEPTED, CROSSES)), diagonal)
    accepted = found.verdict == ACCEPTED
    crossing = shapely.crosses(segments[:, None], segments[None])
    assert not crossing[accepted][:, accepted].any()
    length = shapely.length(segments)
    for k in np.flatnonzero(found.verdict == CROSSES):
        other = found.other[k]
        assert accepted[other] and crossing[k, other] and length[other] <= length[k]
    ends = from_rings(*s).xy[found.edges]
    assert np.array_equal(np.sort(ends, axis=1)[:, :, 0], np.sort(lines[found.edge_line], axis=1)[:, :, 0])


@pytest.mark.parametrize("seed", range(5))
def test_order_of_the_lines_does_not_matter(seed):
    s = shapes.mosaic(seed, 14)
    points = np.unique(s.coords, axis=0)
    lines = points[np.column_stack(np.triu_indices(len(points), 1))]
    order = np.random.default_rng(seed).permutation(len(lines))
    one, two = verdicts(s, *lines), verdicts(s, *lines[order][:, ::-1])
    assert np.array_equal(one.verdict[order], two.verdict)
    assert np.array_equal(one.edges, two.edges)


# ---------------------------------------------------------------- holes that do not count


def attachments(s, min_hole):
    polygon = from_rings(*s)
    wanted, attachable = counted(
        polygon, boundary_components(polygon), planar().equal_area, np.array([min_hole])
    )
    return set(np.flatnonzero(wanted).tolist()), {tuple(p) for p in polygon.xy[attachable]}


def test_a_neck_can_be_cut_beside_an_islet():
    """Triangulated with the islet, each diagonal across the neck would end at it."""
    islet = [(4.9, 4.9), (4.9, 5.1), (5.1, 5.1), (5.1, 4.9)]
    shell = [(0, 0), (4.8, 4), (5, 4), (5.2, 4), (10, 0), (10, 10), (5.2, 6), (5, 6), (4.8, 6), (0, 10)]
    polygon = from_rings(*shapes.shape(shell, islet))
    component = boundary_components(polygon)
    wanted, attachable = counted(polygon, component, planar().equal_area, np.ones(1))
    edges = from_triangulation(polygon, component, wanted, measure=planar()).edges
    ends = {frozenset(map(tuple, polygon.xy[edge])) for edge in edges}
    assert attachable[edges].all()
    assert frozenset({(4.8, 4), (4.8, 6)}) in ends and frozenset({(5.2, 4), (5.2, 6)}) in ends
    hole = shapely.Polygon(islet)
    assert not any(hole.intersects(shapely.LineString(list(edge))) for edge in ends)


BY_AN_ULP = [  # GEOS takes the crossing of two lines for a touch: it rounds the point where they meet
    ([(23, 0), (21, -3.3306690738754696e-16), (21.5, 0.28867513459481275), (22, 0.5773502691896257),
      (22.5, 0.8660254037844387), (22.5, 0.288675134594813)], (0, 2), (1, 3)),
    ([(-0.6666666666666666, -0.19245008972987543), (-0.5000000000000002, 0.28867513459481275),
      (-0.33333333333333376, 0.7698003589195008), (0.6666666666666665, 0.1924500897298754)],
     (0, 2), (1, 3)),
]  # fmt: skip


@pytest.mark.parametrize("ring, one, other", BY_AN_ULP)
def test_lines_that_cross_by_an_ulp(ring, one, other):
    lines = from_lines(from_rings(*shapes.shape(ring)), [[ring[k] for k in one], [ring[k] for k in other]])
    assert len(lines.edges) < 2, "both were accepted, though they cross"


def test_a_line_far_off_a_tiny_polygon():
    s = shapes.SQUARE.mapped(lambda xy: xy * 1e-300)
    with np.errstate(all="raise"):
        assert verdicts(s, [(1e9, 0), (1e9, 1)]).verdict.tolist() == [OFF_VERTICES]


def test_small_holes_get_no_edges():
    s = shapes.shape(shapes.box(0, 0, 20, 10), shapes.box(2, 2, 5, 5)[::-1], shapes.box(14, 4, 16, 6)[::-1])
    big, small = {(2, 2), (5, 5)}, {(14, 4), (16, 6)}
    for floor, holes, ends in [
        (0, 2, big | small),
        (4, 2, big | small),
        (4.1, 1, big),
        (9, 1, big),
        (9.1, 0, set()),
        (1e9, 0, set()),
    ]:
        wanted, attached = attachments(s, floor)
        assert len(wanted) == 1 + holes
        assert attached & (big | small) == ends
        assert (0, 0) in attached, "the shell always counts"


def test_a_small_hole_that_touches_a_large_one_belongs_to_it():
    s = shapes.shape(shapes.box(0, 0, 20, 10), [(2, 2), (2, 8), (8, 5)], [(8, 5), (9, 6), (9, 4)])
    wanted, attached = attachments(s, 5.0)
    assert len(wanted) == 2
    assert (8, 5) in attached and (9, 6) not in attached
