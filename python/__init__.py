"""Isthmus: natural partitions of polygons, for Python without QGIS.

Polygons cut at their isthmuses, straits and necks (Haunert and Meulemans 2016), within a budget, for every
tau, and what each tau costs; areas of a map cut and aggregated (Haunert and Wolff 2010); a region of a map
enlarged (Haunert and Sering 2011). A shapely geometry, an array of these, a GeoSeries or a GeoDataFrame goes
in, and the same kind comes out. The options are those of the plugin's tools in lower case, with their
defaults.
"""

from ._aggregation import Pieces, Regions, aggregate, prepare_aggregation
from ._cutting import Candidates, Parts, hierarchy, partition, partition_within, tradeoff
from ._focus import FocusMap, enlarge
from .core.errors import IsthmusError

__version__ = "0.2.0"
__all__ = [
    "Candidates",
    "FocusMap",
    "IsthmusError",
    "Parts",
    "Pieces",
    "Regions",
    "aggregate",
    "enlarge",
    "hierarchy",
    "partition",
    "partition_within",
    "prepare_aggregation",
    "tradeoff",
]
