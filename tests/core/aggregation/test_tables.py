"""What is asked of areas in tables, and what is told of regions."""

import numpy as np
import pytest

from isthmus.core.aggregation.instance import Solution, build
from isthmus.core.aggregation.outcome import outcome
from isthmus.core.aggregation.tables import distances
from isthmus.core.errors import IsthmusError


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
