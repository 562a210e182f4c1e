"""What is asked of areas in tables, and what is told of regions."""

import numpy as np
import pytest

from isthmus.core.aggregation.areas import joined_rings
from isthmus.core.aggregation.instance import Solution, build
from isthmus.core.aggregation.outcome import lost_areas, outcome
from isthmus.core.aggregation.tables import distances
from isthmus.core.errors import IsthmusError
from isthmus.core.rings import Rings


@pytest.mark.parametrize("classes, missing, told", [("abcd", 8, 8), ("abcde", 14, 8)])
def test_of_many_missing_distances_the_first_eight_are_named(classes, missing, told):
    known = [("a", "b", 1.0), ("c", "d", 1.0), ("e", "a", 1.0)]
    with pytest.raises(IsthmusError) as problem:
        distances(list(classes), "table", known)
    text = str(problem.value)
    assert f"lacks {missing} pairs" in text
    assert text.count(">") == told
    assert ("..." in text) == (missing > told)


def test_an_area_without_geometry_is_in_no_region():
    row = [[0, 1], [1, 2], [2, 3]]
    problem = build([3, 1, 1, 3], [0, 0, 0, 1], range(4), row, np.ones(3), 1 - np.eye(2), [2.0, 2.0])
    found = Solution(np.array([0, 0, 0, 1]), np.array([0, 3]))
    shaped = np.array([True, False, True, True])
    told = outcome(problem, found, shaped, list("pqrs"), {})
    assert told.members == [[0, 2], [3]]
    assert told.merged.tolist() == [-1, -1, -1, -1]
    assert (told.size.tolist(), told.faults, told.small) == ([5.0, 3.0], {}, [])


def test_pieces_of_one_area_in_one_region_are_merged():
    pairs = [[k, k + 1] for k in range(6)]
    problem = build(np.full(7, 3.0), [0] * 7, range(7), pairs, np.ones(6), np.zeros((1, 1)), [2.0])
    found = Solution(np.array([0, 0, 0, 0, 1, 1, 1]), np.array([0, 4]))
    shaped = np.array([True] * 6 + [False])
    told = outcome(problem, found, shaped, list("pprsprr"), {})
    one, other = told.merged[:2]
    assert one == other >= 0  # two of p; the third is in the other region
    assert told.merged[2:].tolist() == [-1] * 5


def test_rows_about_classes_that_are_not_on_the_map_do_not_matter():
    rows = [("a", "b", 0.5), ("a", "lake", 2.0), ("lake", "a", 3.0), ("lake", "sea", -1.0)]
    assert distances(["a", "b"], "table", rows)[0].tolist() == [[0.0, 0.5], [0.5, 0.0]]


def test_an_area_of_which_half_stays_has_not_lost_its_class():
    row = [[0, 1], [1, 2], [2, 3]]
    problem = build([2, 2, 3, 9], [0, 0, 0, 1], range(4), row, np.ones(3), 1 - np.eye(2), [4.0, 4.0])
    told = []
    for region, core in (([0, 1, 1, 1], [0, 3]), ([0, 0, 0, 0], [3])):
        found = Solution(np.array(region), np.array(core))
        told.append(lost_areas(problem, found, ["one", "one", "other", "last"], ["meadow", "wood"]))
    assert told == [[("meadow", 1, 2), ("wood", 0, 1)], [("meadow", 2, 2), ("wood", 0, 1)]]


def test_an_area_without_an_id_is_not_that_whose_id_is_its_number():
    problem = build([3, 3, 3], [0, 0, 1], range(3), [[0, 1], [1, 2]], np.ones(2), 1 - np.eye(2), [4.0, 4.0])
    found = Solution(np.array([0, 1, 1]), np.array([0, 2]))
    assert lost_areas(problem, found, ["1", 1, "2"], ["meadow", "wood"]) == [("meadow", 1, 2), ("wood", 0, 1)]


def test_chunks_without_a_polygon_have_no_say_in_the_ordinates():
    """A layer with Z whose first features are all without geometry."""
    nothing = Rings(np.empty((0, 2)), np.zeros(1, dtype=np.int64), np.zeros(1, dtype=np.int64))
    triangle = Rings(np.arange(9.0).reshape(3, 3), np.array([0, 3]), np.array([0, 1]))
    made = joined_rings([nothing, triangle, nothing, triangle])
    assert made.coords.tolist() == [*triangle.coords.tolist()] * 2
    assert made.offsets.tolist() == [0, 3, 6] and made.polygon_offsets.tolist() == [0, 1, 2]
