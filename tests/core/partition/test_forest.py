"""A polygon's result does not depend on its neighbours in the chunk."""

import numpy as np
import pytest
from isthmus.core import metric
from isthmus.core.errors import Unsolvable
from isthmus.core.partition.min_size import SELF
from isthmus.core.partition.solve import finish, partition, prepare, select

from .. import shapes, stages

BAD = [
    (np.zeros((0, 2)), [0]),
    (np.zeros((3, 2)), [0, 3]),
    shapes.shape([(0, 0), (1, 1), (1, 0), (0, 1)]),
    (np.array([(0, 0), (np.nan, 1), (1, 0)]), [0, 3]),
    (np.array([(0, 0), (1, 0), (1, 1.0)]), [0, 3, 3]),
]


def some(seed):
    """Polygons of all kinds, extreme and bad ones among them, in random order."""
    kinds = [
        lambda s: shapes.tour(s, 4 + s % 30),
        lambda s: shapes.mosaic(s, 15 + s % 25),
        lambda s: shapes.polyomino(s, 5, 5, 0.7, 0.5),
        lambda s: shapes.with_duplicates(shapes.mosaic(s, 15, size=7), 2),
        lambda s: shapes.reversed_rings(shapes.polyomino(s, 4, 4, 0.8, 0.5)),
        lambda s: shapes.tour(s, 12).mapped(lambda xy: xy * 1e90),
        lambda s: shapes.tour(s, 9).mapped(lambda xy: xy * 1e-120),
        lambda s: list(shapes.TOUCHING.values())[s % len(shapes.TOUCHING)],
        lambda s: BAD[s % len(BAD)],
    ]
    rng = np.random.default_rng(seed)
    chosen, seeds = rng.integers(0, len(kinds), 60), rng.integers(0, 10**6, 60)
    return [kinds[k](s) for k, s in zip(chosen.tolist(), seeds.tolist())], rng


def alone(s, tau, **options):
    try:
        return partition(*s, tau, all_dilations=True, **options), ""
    except Unsolvable as problem:
        return None, str(problem)


@pytest.mark.parametrize(
    "options",
    [
        {},
        {"min_length": 2e5},
        {"min_hole": 1e11},
        {"weigh": lambda prepared: prepared.length},
        {"measure": metric.ellipsoidal()},
        {"engine": "shapely"},
        {"natural": True, "smallest": 1e9},
    ],
    ids=lambda options: next(iter(options), "plain"),
)
@pytest.mark.parametrize("seed", range(6))
def test_together_as_alone(seed, options):
    polygons, rng = some(seed)
    if "measure" in options:
        polygons = [(np.asarray(c, dtype=float)[:, :2] * 1e-6, o) for c, o in polygons]
    tau = rng.choice([1.0, 1.5, 2.0, 4.0], len(polygons))
    cuts = np.sort(rng.integers(0, len(polygons) + 1, 3))
    for chunk in np.split(np.arange(len(polygons)), cuts):
        if len(chunk):
            compare([polygons[k] for k in chunk], tau[chunk], options)


def compare(polygons, tau, options):
    options = dict(options)
    weigh = options.pop("weigh", None)
    prepared = prepare(stages.together(polygons), **options)
    weight = None if weigh is None else weigh(prepared)
    selection = select(prepared, tau[prepared.polygons.number], weight=weight, max_gap=0.0)
    result = finish(prepared, selection, all_dilations=True)
    rings, bounds = result.parts.rings, result.parts.part_offsets
    first = np.append(0, np.cumsum([len(s[0]) for s in polygons]))
    side = np.zeros((len(result.edges), 2), dtype=int)
    side[result.role == SELF] = result.parts.sides
    place = 0
    for number, s in enumerate(polygons):
        more = {"weigh": weigh, "max_gap": 0.0} if weigh else {}
        one, problem = alone(s, tau[number], **options, **more)
        assert result.verdict[number] == problem
        if problem:
            continue
        own = result.owner == place
        assert np.array_equal(result.edge_rows[own] - first[number], one.edge_rows)
        assert np.array_equal(result.role[own], one.role)
        assert np.array_equal(result.length[own], one.length)
        assert np.array_equal(result.detour[own], one.detour)
        assert np.allclose(result.dilation[own], one.dilation, rtol=1e-12, atol=0)
        assert result.largest_dilation[place] == pytest.approx(one.largest_dilation, rel=1e-12)
        assert result.cost[place] == pytest.approx(one.cost, rel=1e-12)
        mine = slice(bounds[place], bounds[place + 1])
        assert np.array_equal(result.parts.area[mine], one.parts.area)
        assert np.array_equal(side[own][one.role == SELF] - bounds[place], one.parts.sides)
        for together, single in zip(rings[mine], one.parts.rings, strict=True):
            for ring, other in zip(together, single, strict=True):
                assert np.array_equal(ring - first[number], other)
        place += 1
    assert place == len(prepared.polygons.unit)


def test_a_chunk_of_bad_polygons_only():
    prepared = prepare(stages.together(BAD))
    assert (prepared.verdict != "").all()
    result = finish(prepared, select(prepared, 2.0))
    assert len(result.parts.area) == len(result.edges) == len(result.cost) == 0


def test_holes_that_lines_do_not_connect_spare_the_neighbours():
    polygons = [shapes.DUMBBELL, shapes.TWO_HOLES, shapes.DUMBBELL]
    lines = [np.array([[(10, 4), (10, 6)]], dtype=float), np.empty((0, 2, 2)), np.empty((0, 2, 2))]
    prepared = prepare(stages.together(polygons), lines=lines)
    assert [verdict == "" for verdict in prepared.verdict] == [True, False, True]
    assert "do not connect 2 of 2 holes" in prepared.verdict[1]
    assert select(prepared, 4.0).cost.tolist() == [1.0, 0.0]
    assert prepared.polygons.number.tolist() == [0, 2] and prepared.owner.tolist() == [0]
