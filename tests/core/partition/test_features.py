"""Features of a chunk: what is too small is told by the area of the feature."""

import numpy as np
import pytest

from isthmus.core import metric
from isthmus.core.partition import candidates, solve
from isthmus.core.partition import features as stage
from isthmus.core.rings import Rings, offsets_of

from .. import shapes

# parts of 30 and 60 on the two sides of a neck, and an island of 20 with a lake of 10: an area of 100
HOURGLASS = [(0, 0), (5, 4), (15, 0), (15, 10), (5, 6), (0, 10)]
ISLAND = [(30, 0), (35, 0), (35, 4), (30, 4)]
LAKE = [(30.5, 0.75), (30.5, 3.25), (34.5, 3.25), (34.5, 0.75)]


@pytest.mark.parametrize("share, parts", [(0.0, 3), (29.0, 3), (31.0, 2)])
def test_the_smallest_part_is_a_share_of_the_whole_feature_without_lakes(share, parts):
    rings = Rings(
        np.concatenate((HOURGLASS, ISLAND, LAKE)).astype(float), np.array([0, 6, 10, 14]), np.array([0, 1, 3])
    )
    chunk = stage.Chunk(["land"], rings, np.array([0, 0]), [None], metric.planar())
    no = np.zeros(1)
    problem = stage.prepare(
        chunk, natural=False, smallest_part=np.array([share]), min_length=no, min_hole=np.array([99.0])
    )
    selection, _ = stage.for_tau(problem, np.array([4.0]))
    assert len(selection.selected) == parts - 2


@pytest.mark.parametrize(
    "options",
    [
        {},
        {"natural": True, "smallest": 0.01},
        {"smallest": 1.0, "min_hole": 3.0, "min_length": 0.5},
        {"smallest": 1.0, "min_hole": 1e10},
        {"natural": True, "smallest": 0.01, "min_hole": 1e10},
    ],
)
def test_a_polygon_that_cannot_be_triangulated_leaves_the_others_as_they_are(options, monkeypatch):
    """The second of three: the first and the third come out as if they had been alone."""
    tours = [shapes.mosaic(seed, 60) for seed in (1, 2, 3)]
    original = candidates.triangulate

    def failing(polygons, **more):
        triangles, verdict, sides = original(polygons, **more)
        if len(verdict) == 3:
            verdict[1] = "no triangles"
            triangles, sides = triangles[polygons.polygon_of_vertex[triangles[:, 0]] != 1], None
        return triangles, verdict, sides

    two = solve.prepare(_together(tours[0], tours[2]), **options)
    assert two.wanted[two.component].all() == (options.get("min_hole", 0.0) < 1e10)  # no hole is left out
    monkeypatch.setattr(candidates, "triangulate", failing)
    three = solve.prepare(_together(*tours), **options)
    assert three.verdict.tolist() == ["", "no triangles", ""]
    for name in ("edges", "owner", "chord", "length", "detour", "share", "bounded", "edge_length", "wanted"):
        np.testing.assert_array_equal(getattr(three, name), getattr(two, name), err_msg=name)
    np.testing.assert_array_equal(three.set_aside[[0, 2]], two.set_aside)
    for one, other in zip(three.places, two.places):
        np.testing.assert_array_equal(one, other)
    selected = solve.select(three, 3.0).selected
    assert len(selected)
    np.testing.assert_array_equal(selected, solve.select(two, 3.0).selected)


def _together(*all_rings):
    coords = [np.asarray(coords, dtype=float)[:, :2] for coords, _ in all_rings]
    sizes = [np.diff(offsets) for _, offsets in all_rings]
    return Rings(
        np.concatenate(coords), offsets_of(np.concatenate(sizes)), offsets_of([len(one) for one in sizes])
    )


def test_a_budget_whose_best_detour_is_not_proven_is_told_for_its_feature(monkeypatch):
    """Where the search for MinLength ends by its time, say."""
    rings = Rings(
        np.tile(np.array(HOURGLASS, dtype=float), (2, 1)), np.array([0, 6, 12]), np.array([0, 1, 2])
    )
    chunk = stage.Chunk(["one", "other"], rings, np.array([0, 1]), [None, None], metric.planar())
    no = np.zeros(2)
    problem = stage.prepare(chunk, natural=False, smallest_part=no, min_length=no, min_hole=no)
    together = stage.together
    monkeypatch.setattr(
        stage,
        "together",
        lambda *given: [(answer, k == 0) for k, (answer, _) in enumerate(together(*given))],
    )
    selection, unproven = stage.within_budget(problem, [1.0, 1.0])
    assert unproven == {1: pytest.approx(selection.dilation[1])}
