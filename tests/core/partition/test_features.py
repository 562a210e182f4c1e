"""Features of a chunk: what is too small is told by the area of the feature."""

import numpy as np
import pytest

from isthmus.core import metric
from isthmus.core.partition import features as stage
from isthmus.core.rings import Rings

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
