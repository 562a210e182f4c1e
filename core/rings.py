"""The one layout of polygons: coordinates, ring offsets and polygon offsets, and its few operations.

It is that of GeoArrow and of shapely's ``to_ragged_array``, but no ring repeats its first vertex: ring i has
the rows ``offsets[i]`` to ``offsets[i + 1] - 1``, polygon p the rings ``polygon_offsets[p]`` to
``polygon_offsets[p + 1] - 1``, its shell first. Whatever is *ragged* here is such a pair of flat values and
offsets, and a *group* is what lies between two offsets.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import shapely

__all__ = [
    "Rings",
    "closed",
    "cycles",
    "following",
    "groups",
    "locate",
    "offsets_of",
    "one_polygon",
    "previous",
    "ranges",
    "running",
    "shapes",
    "signed_areas",
    "spread",
    "starts",
    "take",
]


class Rings(NamedTuple):
    """Polygons as flat arrays.

    Attributes
    ----------
    coords : (k, d) float, d >= 2
        x, y and what rides along, one row a vertex.
    offsets : (r + 1,) int
        Where each ring starts.
    polygon_offsets : (p + 1,) int
        Where the rings of each polygon start.
    """

    coords: np.ndarray
    offsets: np.ndarray
    polygon_offsets: np.ndarray


def one_polygon(coords: np.ndarray, offsets: np.ndarray) -> Rings:
    """Return the rings of a single polygon as `Rings`.

    Examples
    --------
    >>> one_polygon(np.zeros((3, 2)), [0, 3]).polygon_offsets
    array([0, 1])
    """
    offsets = np.asarray(offsets, dtype=np.int64)
    return Rings(np.asarray(coords), offsets, np.array([0, len(offsets) - 1]))


def offsets_of(sizes: np.ndarray) -> np.ndarray:
    """Return the offsets of groups of these sizes.

    Examples
    --------
    >>> offsets_of([2, 0, 3])
    array([0, 2, 2, 5])
    """
    offsets = np.zeros(len(sizes) + 1, dtype=np.int64)
    np.cumsum(sizes, out=offsets[1:])
    return offsets


def groups(offsets: np.ndarray) -> np.ndarray:
    """Return the group of each element.

    Examples
    --------
    >>> groups(np.array([0, 2, 2, 5]))
    array([0, 0, 2, 2, 2])
    """
    if len(offsets) == 2:  # one huge ring: repeat copies element by element
        return np.zeros(offsets[1] - offsets[0], dtype=np.int64)
    return np.repeat(np.arange(len(offsets) - 1), np.diff(offsets))


def spread(values: np.ndarray, offsets: np.ndarray) -> np.ndarray:
    """Return the value of its group for each element, only to be read.

    Examples
    --------
    >>> spread(np.array([7, 8, 9]), np.array([0, 2, 2, 5]))
    array([7, 7, 9, 9, 9])
    """
    if len(values) == 1:  # one huge ring: repeat copies element by element
        return np.broadcast_to(values, (offsets[1] - offsets[0],) + values.shape[1:])
    return np.repeat(values, np.diff(offsets), axis=0)


def following(offsets: np.ndarray) -> np.ndarray:
    """Return the element after each in its group, the first after the last.

    Examples
    --------
    >>> following(np.array([0, 3, 5]))
    array([1, 2, 0, 4, 3])
    """
    after = np.arange(1, offsets[-1] + 1)
    some = offsets[1:] > offsets[:-1]
    after[offsets[1:][some] - 1] = offsets[:-1][some]
    return after


def previous(offsets: np.ndarray) -> np.ndarray:
    """Return the element before each in its group, the last before the first.

    Examples
    --------
    >>> previous(np.array([0, 3, 5]))
    array([2, 0, 1, 4, 3])
    """
    before = np.arange(-1, offsets[-1] - 1)
    some = offsets[1:] > offsets[:-1]
    before[offsets[:-1][some]] = offsets[1:][some] - 1
    return before


def closed(offsets: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the elements of each group with the first one again at its end, and the offsets of these.

    Examples
    --------
    >>> closed(np.array([0, 3, 3, 5]))
    (array([0, 1, 2, 0, 3, 4, 3]), array([0, 4, 4, 7]))
    """
    size = np.diff(offsets)
    some = size > 0  # an empty group stays empty
    closed_offsets = offsets_of(size + some)
    place = np.arange(closed_offsets[-1]) - spread(np.cumsum(some) - some, closed_offsets)
    place[closed_offsets[1:][some] - 1] = offsets[:-1][some]
    return place, closed_offsets


def ranges(start: np.ndarray, count: np.ndarray) -> np.ndarray:
    """Return start[0], start[0] + 1, ... (count[0] numbers), start[1], ...

    Examples
    --------
    >>> ranges(np.array([5, 0]), np.array([2, 3]))
    array([5, 6, 0, 1, 2])
    """
    end = np.cumsum(count)
    total = int(end[-1]) if len(end) else 0
    return np.arange(total) + np.repeat(start - end + count, count)


def starts(values: np.ndarray) -> np.ndarray:
    """Return the elements at which runs of equal values start; none of nothing.

    Examples
    --------
    >>> starts(np.array([4, 4, 7, 4])), starts(np.array([]))
    (array([0, 2, 3]), array([], dtype=int64))
    """
    begins = np.ones(len(values), dtype=bool)
    np.not_equal(values[1:], values[:-1], out=begins[1:])
    return np.flatnonzero(begins)


def take(offsets: np.ndarray, which: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the elements of some groups, and the offsets of these alone.

    Examples
    --------
    >>> take(np.array([0, 2, 3, 5]), np.array([2, 0]))
    (array([3, 4, 0, 1]), array([0, 2, 4]))
    """
    if len(which) and (np.diff(which) == 1).all():  # a run, often everything
        own = offsets[which[0] : which[-1] + 2]
        return np.arange(own[0], own[-1]), own - own[0]
    size = np.diff(offsets)[which]
    return ranges(offsets[:-1][which], size), offsets_of(size)


def running(values: np.ndarray, offsets: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the sum of the values before each one in its group, and of all values of each group.

    Parameters
    ----------
    values : (k,) float
        Finite.
    offsets : (g + 1,) int

    Returns
    -------
    before : (k,) float
    total : (g,) float

    Notes
    -----
    In integers, 2**61 or so to the sum of a group's magnitudes: they add up exactly, so that a group does
    not depend on the digits of those before it (a sum of floats over all groups would lose them). O(k).

    Examples
    --------
    >>> running(np.array([1.0, 2.0, 4.0, 8.0]), np.array([0, 3, 4]))
    (array([0., 1., 3., 0.]), array([7., 8.]))
    """
    some = offsets[1:] > offsets[:-1]
    total = np.zeros(len(some))
    if not len(values):
        return np.zeros(0), total
    size = np.zeros(len(some))
    total[some] = np.add.reduceat(values, offsets[:-1][some])
    size[some] = np.add.reduceat(np.abs(values), offsets[:-1][some])
    exponent = spread(61 - np.frexp(size)[1], offsets)
    steps = np.rint(np.ldexp(values, exponent)).astype(np.int64)
    passed = np.cumsum(steps) - steps  # overflows, which subtraction undoes
    start = np.zeros(len(some), dtype=np.int64)
    start[some] = passed[offsets[:-1][some]]
    passed -= spread(start, offsets)
    return np.ldexp(passed.astype(float), -exponent), total


def locate(
    before: np.ndarray, total: np.ndarray, offsets: np.ndarray, group: np.ndarray, where: np.ndarray
) -> np.ndarray:
    """Return the elements in which places along groups lie.

    Parameters
    ----------
    before, total : (k,) float, (g,) float
        See `running`; no value is negative, no total zero.
    offsets : (g + 1,) int
    group : int array
        Of each place.
    where : float array
        Distance of each from the start of its group, from 0 to its total.

    Notes
    -----
    O(log k) a place, by one search: a group and a share of its total are one integer.

    Examples
    --------
    >>> locate(np.array([0.0, 2.0, 0.0]), np.array([5.0, 1.0]), np.array([0, 2, 3]), np.array([0, 1]),
    ...        np.array([2.5, 0.5]))
    array([1, 2])
    """

    def key(number, share):
        return (number << 41) + (share * 2.0**40).astype(np.int64)

    of = groups(offsets)
    found = np.searchsorted(key(of, before / total[of]), key(group, where / total[group]), side="right") - 1
    return np.clip(found, offsets[group], offsets[group + 1] - 1)


def signed_areas(xy: np.ndarray, offsets: np.ndarray) -> np.ndarray:
    """Return the signed areas of rings, counter-clockwise positive.

    Parameters
    ----------
    xy : (k, 2) float
    offsets : (r + 1,) int
        No ring is empty.

    Examples
    --------
    >>> signed_areas(np.array([[0, 0], [2, 0], [2, 1], [0, 1.0]]), np.array([0, 4]))
    array([2.])
    """
    if not len(xy):
        return np.zeros(0)
    # near the origin the shoelace formula cancels least
    x, y = (axis - spread(axis[offsets[:-1]], offsets) for axis in xy.T)
    first, last = offsets[:-1], offsets[1:] - 1
    x_after, y_after = np.append(x[1:], x[:1]), np.append(y[1:], y[:1])
    x_after[last], y_after[last] = x[first], y[first]
    y_after *= x
    x_after *= y
    y_after -= x_after
    return 0.5 * np.add.reduceat(y_after, first)


def shapes(xy: np.ndarray, offsets: np.ndarray, polygon_offsets: np.ndarray) -> np.ndarray:
    """Return polygons as shapely geometries; each has a ring, and each ring three vertices.

    Examples
    --------
    >>> shapes(np.array([[0, 0], [2, 0], [2, 1.0]]), np.array([0, 3]), np.array([0, 1]))[0].area
    1.0
    """
    if len(offsets) > len(polygon_offsets):  # with holes shapely 2.1.0 may crash below (its issue 2291)
        lines = shapely.linearrings(xy, indices=groups(offsets))
        return shapely.polygons(lines, indices=groups(polygon_offsets))
    # closed rings are taken as they are, without a geometry for each ring
    place, closed_offsets = closed(offsets)
    return shapely.from_ragged_array(
        shapely.GeometryType.POLYGON, xy.take(place, axis=0), (closed_offsets, polygon_offsets)
    )


def cycles(point: np.ndarray, offsets: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Split closed walks where they meet themselves.

    Parameters
    ----------
    point : (k,) int
        What is passed at each place.
    offsets : (w + 1,) int
        Where each walk starts.

    Returns
    -------
    place : (k',) int
        Places of all cycles, one after the other; those of fewer than three are left out (an edge there
        and back).
    cycle_offsets : (c + 1,) int
    walk : (c,) int
        The walk that each cycle was part of, ascending.

    Notes
    -----
    O(k log k); a loop only over places whose point is passed more than once.

    Examples
    --------
    >>> cycles(np.array([0, 1, 2, 0, 3, 4]), np.array([0, 6]))
    (array([0, 1, 2, 3, 4, 5]), array([0, 3, 6]), array([0, 0]))
    """
    k, of = len(point), groups(offsets)
    order = np.lexsort((point, of))
    same = (point[order][1:] == point[order][:-1]) & (of[order][1:] == of[order][:-1])
    repeated = np.zeros(k, dtype=bool)
    repeated[order[1:][same]] = repeated[order[:-1][same]] = True
    if not repeated.any():
        return np.arange(k), np.asarray(offsets), np.arange(len(offsets) - 1)
    # runs: from a place with a repeated point, or the start of a walk, to the next such place
    head = repeated.copy()
    head[offsets[:-1]] = True
    head = np.flatnonzero(head)
    size = np.diff(np.append(head, k))
    label = np.where(repeated[head], point[head], -1).tolist()
    owner = of[head].tolist()
    pieces, lengths, walks = [], [], []
    stack, depth = [], {}

    def close(base):
        found = stack[base:]
        del stack[base:]
        for run in found:
            depth.pop(label[run], None)
        pieces.extend(found)
        lengths.append(len(found))
        walks.append(owner[found[0]])

    for run, name in enumerate(label):
        if stack and owner[stack[-1]] != owner[run]:
            close(0)
        if name in depth:
            close(depth[name])
        if name >= 0:
            depth[name] = len(stack)
        stack.append(run)
    close(0)
    pieces = np.array(pieces)
    place = ranges(head[pieces], size[pieces])
    count = np.add.reduceat(size[pieces], offsets_of(lengths)[:-1])
    long = np.flatnonzero(count > 2)
    long = long[np.argsort(np.array(walks)[long], kind="stable")]
    index, cycle_offsets = take(offsets_of(count), long)
    return place[index], cycle_offsets, np.array(walks)[long]
