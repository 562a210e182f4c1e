"""What becomes of the areas, as plain tables: what is written, told and reported follows from it."""

from __future__ import annotations

from typing import NamedTuple, Sequence

import numpy as np

from ..errors import Sentence
from .instance import Instance, Solution, costs, problems


class Outcome(NamedTuple):
    """Regions and areas of a result.

    Attributes
    ----------
    members : list of list of int
        The areas of each region that have a geometry.
    groups : dict of (source, region) to list of int
        Areas that are one again: the pieces of one area that ended in one region. Without a geometry
        an area stays alone, with the key (its number, None).
    merged : (n,) int
        The number of the group of each area, -1 where it is alone.
    size : (r,) float
        Of each region.
    faults : dict of int to str
        Why regions are not as they should be.
    small : list of int
        Regions that could not be helped, apart from areas that were left as they are.
    """

    members: list
    groups: dict
    merged: np.ndarray
    size: np.ndarray
    faults: dict
    small: list


class Balance(NamedTuple):
    """The map before and after, for the report.

    Attributes
    ----------
    costs : list of (str, float, float)
        Parts of the cost, of the areas as they were and of the regions.
    classes : list of (str, int, float, int, float)
        For each class: areas and their size before, regions and their size after.
    lost : list of (str, int, int)
        For each class: areas above half of the smallest size that lost it, and how many there are.
    """

    costs: list
    classes: list
    lost: list


def outcome(
    problem: Instance, found: Solution, shaped: np.ndarray, sources: Sequence, reason: dict[int, str]
) -> Outcome:
    """Return the `Outcome` of a solution.

    Parameters
    ----------
    shaped : (n,) bool
        Whether an area has a geometry.
    sources : list
        What identifies the area of each piece.
    reason : dict of int to str
        Areas that are left as they are, and why.
    """
    count, cores = len(found.core), found.core.tolist()
    region = [r if has else None for r, has in zip(found.region.tolist(), shaped.tolist())]
    faults = {}
    for r, fault in problems(problem, found):
        if fault == "excluded class":
            fault = Sentence("its class is excluded, and no other is possible here")
        faults[r] = reason.get(cores[r]) or fault
    members, groups = [[] for _ in range(count)], {}
    for k, its in enumerate(region):
        if its is not None:
            members[its].append(k)
        groups.setdefault((k if its is None else sources[k], its), []).append(k)
    merged = np.full(len(region), -1)
    for number, group in enumerate(groups.values()):
        if len(group) > 1:
            merged[group] = number
    return Outcome(
        members,
        groups,
        merged,
        np.bincount(found.region, weights=problem.size, minlength=count),
        faults,
        [r for r in sorted(faults) if members[r] and cores[r] not in reason],
    )


def balance(problem: Instance, found: Solution, sources: Sequence, classes: Sequence[str]) -> Balance:
    """Return the `Balance` of a solution; ``classes`` are the names."""
    n, kept = len(problem.size), problem.cls[found.core]
    before = costs(problem, Solution(np.arange(n), np.arange(n)))
    after = costs(problem, found)
    parts = [
        (name, getattr(before, part), getattr(after, part))
        for name, part in (
            (Sentence("class change"), "change"),
            (Sentence("boundary length"), "boundary"),
            (Sentence("centre distance"), "centre"),
            (Sentence("total"), "total"),
        )
    ]

    def tally(cls, size):
        many = len(problem.theta)
        return np.bincount(cls, minlength=many), np.bincount(cls, weights=size, minlength=many)

    size = np.bincount(found.region, weights=problem.size, minlength=len(kept))
    columns = (*tally(problem.cls, problem.size), *tally(kept, size))
    rows = [(name, *row) for name, *row in zip(classes, *(column.tolist() for column in columns))]
    return Balance(parts, rows, lost_areas(problem, found, sources, classes))


def lost_areas(
    problem: Instance, found: Solution, sources: Sequence, classes: Sequence[str]
) -> list[tuple[str, int, int]]:
    """Count the areas above half of the smallest size of their class, and those that lost it.

    An area in pieces lost its class if more than half of its size did.
    """
    kept = problem.cls[found.core][found.region]
    number: dict = {}  # as they are: text and numbers do not mix, and the number 5 is not the text "5"
    area = np.array([number.setdefault(one, len(number)) for one in sources], dtype=np.int64)
    cls = problem.cls[np.unique(area, return_index=True)[1]]
    size = np.bincount(area, weights=problem.size)
    gone = np.bincount(area, weights=problem.size * (kept != problem.cls))
    large = size >= problem.theta[cls] / 2.0
    result = []
    for c, name in enumerate(classes):
        mine = large & (cls == c)
        result.append((name, int((mine & (gone > size / 2.0)).sum()), int(mine.sum())))
    return [row for row in result if row[2]]
