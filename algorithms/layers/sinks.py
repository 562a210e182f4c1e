"""Where the tools write: fields, sinks, and results that are on disk as a whole or not at all."""

from __future__ import annotations

import contextlib
import os
import struct
import traceback
from pathlib import Path
from typing import Any, Iterable

from qgis.core import (
    QgsCoordinateReferenceSystem,
    QgsDataSourceUri,
    QgsFeature,
    QgsFeatureSink,
    QgsFields,
    QgsGeometry,
    QgsProcessing,
    QgsProcessingAlgorithm,
    QgsProcessingContext,
    QgsProcessingException,
    QgsProcessingFeedback,
    QgsProcessingOutputLayerDefinition,
    QgsProcessingParameterFeatureSink,
    QgsProcessingParameterFeatureSource,
    QgsProcessingParameterMultipleLayers,
    QgsProperty,
    QgsProviderRegistry,
    QgsVectorFileWriter,
    QgsWkbTypes,
)

from ...core.errors import Sentence
from ..words import spoken, tr

# formats that keep every feature, and can be read
READ_AGAIN = (".gpkg", ".geojson", ".json", ".shp", ".dbf", ".csv", ".fgb", ".sqlite")
# fields that a format adds by itself; one of the input's by that name cannot be written
OWN_FIELDS = {".gpkg": ("fid", "geom"), ".sqlite": ("ogc_fid", "geometry")}
# what belongs to a file besides the file itself
BESIDE = ("-journal", "-wal", "-shm")
SIDECARS = {
    ".shp": (".shx", ".dbf", ".prj", ".cpg", ".qpj", ".qmd", ".qix", ".sbn", ".sbx"),
    ".dbf": (".cpg",),
    ".tab": (".dat", ".map", ".id", ".ind"),
    ".gml": (".xsd", ".gfs"),
}


def overwriting(
    tool: QgsProcessingAlgorithm, parameters: dict[str, Any], context: QgsProcessingContext
) -> str:
    """Return a sentence about a result that would overwrite an input or another result, or ''.

    QGIS would open it for writing, and an input be gone before it is read.
    """
    taken = {}
    for definition in tool.parameterDefinitions():
        for place in _places_read(tool, definition, parameters, context):
            taken[place] = tr("the input {}").format(definition.name())
    for result, file, table in _files_written(tool, parameters):
        for (other, layer), what in taken.items():
            # without a table the whole file is made anew
            if other == file and (None in (table, layer) or table == layer):
                layer = ""
                if file.endswith(".gpkg"):
                    layer = tr(", or another layer of it: {}").format(
                        f"ogr:dbname='{file}' table=\"{result.lower()}\""
                    )
                return tr("{} would overwrite {}: both are {}. Choose another file{}.").format(
                    result, what, file, layer
                )
        taken[file, table] = tr("the result {}").format(result)
    return ""


def unwritable(tool: QgsProcessingAlgorithm, parameters: dict[str, Any]) -> str:
    """Return a sentence about a result that cannot be written where it is wanted, or ''.

    Some tools compute for minutes before they write.
    """
    for result, file, _ in _files_written(tool, parameters):
        folder = Path(file).parent
        while not folder.exists():  # QGIS may make it
            folder = folder.parent
        if not folder.is_dir():
            reason = tr("{} is no folder").format(folder)
        elif os.path.exists(file) and not os.access(file, os.W_OK):
            reason = tr("the file there may not be changed")
        elif not os.access(folder, os.W_OK):
            reason = tr("nothing may be written to the folder {}").format(folder)
        else:
            continue
        return tr("{} cannot be written to {}: {}. Choose another place.").format(result, file, reason)
    return ""


def _files_written(tool, parameters):
    """Name, file and table of each result that goes to a file."""
    for definition in tool.parameterDefinitions():
        if definition.isDestination():
            is_layer = isinstance(definition, QgsProcessingParameterFeatureSink)
            file, table = _place_written(parameters.get(definition.name()), is_layer)
            if file is not None:
                yield definition.name(), file, table


def _places_read(tool, definition, parameters, context):
    """File and layer of each layer that a parameter reads."""
    value = parameters.get(definition.name())
    if definition.type() == QgsProcessingParameterMultipleLayers.typeName():
        layers = tool.parameterAsLayerList(parameters, definition.name(), context)
    elif definition.type() == QgsProcessingParameterFeatureSource.typeName() and value:
        source = getattr(value, "source", None)  # of a QgsProcessingFeatureSourceDefinition
        source = source.staticValue() if isinstance(source, QgsProperty) else value
        layers = [tool.parameterAsVectorLayer({definition.name(): source}, definition.name(), context)]
    else:
        layers = []
    for layer in layers:
        provider = layer and layer.dataProvider()
        if provider and provider.name() == "ogr":
            parts = QgsProviderRegistry.instance().decodeUri("ogr", layer.source())
            path = parts.get("path")
            if path and os.path.isfile(path):
                yield os.path.realpath(path), parts.get("layerName") or Path(path).stem


def _place_written(value, is_layer):
    """File and layer of a destination: (None, None) for none, no layer for the whole file."""
    if isinstance(value, QgsProcessingOutputLayerDefinition):
        if _appends(value):
            return None, None
        value = value.sink
    if isinstance(value, QgsProperty):
        value = value.staticValue()
    if not isinstance(value, str) or value in ("", QgsProcessing.TEMPORARY_OUTPUT):
        return None, None
    if value.startswith("ogr:"):
        uri = QgsDataSourceUri(value[4:])
        return os.path.realpath(uri.database()), uri.table() or None
    if ":" in value[2:]:  # memory: and the like; the colon of a drive is the second character
        return None, None
    if is_layer and not QgsVectorFileWriter.driverForExtension(Path(value).suffix[1:]):
        value += ".gpkg"  # as QGIS does
    return os.path.realpath(value), None


_FAST = QgsFeatureSink.Flag.FastInsert  # looked up a million times


class Sinks:
    """The sinks of one run, for a ``with`` block around all that is written.

    At its end what was written to files is read again, because some formats lose the end of a layer
    on a full disk without a word. After an error, or if the user has cancelled, files that are half
    written are removed: they would look complete. To a layer that was there before nothing is added then.

    Parameters
    ----------
    tool : QgsProcessingAlgorithm
    parameters, context, feedback
        Those of the run.

    Attributes
    ----------
    destinations : dict
        What the tool returns for each sink that was wanted and has come to an end.
    """

    def __init__(
        self,
        tool: QgsProcessingAlgorithm,
        parameters: dict[str, Any],
        context: QgsProcessingContext,
        feedback: QgsProcessingFeedback,
    ) -> None:
        self.tool, self.parameters = tool, parameters
        self.context, self.feedback = context, feedback
        problem = overwriting(tool, parameters, context) or unwritable(tool, parameters)
        if problem:
            raise QgsProcessingException(problem)
        self.destinations, self.fields, self._types = {}, {}, {}
        self._sinks, self._written, self._texts = {}, {}, []
        self._held = {}  # what is added to layers that were there before, all at once in the end

    def open(
        self,
        name: str,
        fields: QgsFields,
        wkb_type: QgsWkbTypes.Type,
        crs: QgsCoordinateReferenceSystem,
        needed: bool = True,
    ) -> bool:
        """Open a sink; return whether it is wanted.

        Several results may come of one feature, so the primary key is made anew.
        """
        file, _ = _place_written(self.parameters.get(name), True)
        is_new = file is not None and not os.path.exists(file)
        try:
            sink, destination = self.tool.parameterAsSink(
                self.parameters, name, self.context, fields, wkb_type, crs,
                QgsFeatureSink.SinkFlag.RegeneratePrimaryKey,
            )  # fmt: skip
        except QgsProcessingException as error:
            if is_new:  # a disk that is full leaves its beginning
                _remove_files(Path(file))
            if file is None:
                raise
            if os.path.isdir(os.path.dirname(file)):
                raise QgsProcessingException(f"{error}{_of_the_format(fields, file)}") from error
            raise QgsProcessingException(
                tr("{} cannot be written to {}: there is no such folder. {}").format(name, file, error)
            ) from error
        if sink is not None:
            self._sinks[name], self.fields[name], self._types[name] = sink, fields, wkb_type
            self.destinations[name], self._written[name] = destination, 0
            if _appends(self.parameters.get(name)):
                self._held[name] = []
        elif needed or self.parameters.get(name):
            raise QgsProcessingException(self.tool.invalidSinkError(self.parameters, name))
        return sink is not None

    def add(self, name: str, geometry: QgsGeometry | None, values: list, origin: str | int = "") -> None:
        """Write a feature; see `add_all`."""
        self.add_all(name, [(geometry, values, origin)])

    def add_all(self, name: str, rows: Iterable[tuple[QgsGeometry | bytes | None, list, str | int]]) -> None:
        """Write features; a failure is an error, so that nothing is lost in silence.

        Parameters
        ----------
        name : str
        rows : iterable of (QgsGeometry, bytes or None; list; str or int)
            The geometry (bytes are WKB) and the values of each, and in a few words what it is a result of: a
            number is the id of a feature.
        """
        held, add, written = self._held.get(name), self._sinks[name].addFeature, 0
        read = QgsGeometry()  # one for all, for QGIS copies what a feature has before it changes
        for geometry, values, origin in rows:
            # only a layer that was there before asks for fields by name. Never one feature again: where all
            # values are the same but for some 1e-12, setAttributes leaves the old ones
            feature = QgsFeature() if held is None else QgsFeature(self.fields[name])
            if isinstance(geometry, bytes):
                read.fromWkb(geometry)
                geometry = read
            if geometry is not None:
                feature.setGeometry(geometry)
            if Sentence in map(type, values):  # Qt takes no subclass of str for a text
                values = [str(value) if isinstance(value, Sentence) else value for value in values]
            feature.setAttributes(values)
            if held is not None:
                held.append(feature)
            elif not add(feature, _FAST):
                raise QgsProcessingException(self._not_written(name, origin, geometry))
            written += 1
        self._written[name] += written

    def write_text(self, path: str, text: str) -> None:
        """Write a report, which is removed with the layers if anything fails."""
        try:
            with open(path, "w", encoding="utf-8") as stream:
                self._texts.append(path)
                stream.write(text)
        except OSError as error:
            raise QgsProcessingException(tr("The report could not be written: {}").format(error)) from error

    def __enter__(self):
        return self

    def __exit__(self, kind, error, trace):
        traceback.clear_frames(trace)  # where a sink was at work when it failed
        message = ""
        if kind is None and not self.feedback.isCanceled():
            for name, features in self._held.items():
                if not self._sinks[name].addFeatures(features, _FAST):
                    message = message or self._not_written(name)
        self._sinks.clear()  # this closes them
        if kind is None and not self.feedback.isCanceled():
            lost = [name for name in self.destinations if not self._is_complete(name)]
            if not lost and not message:
                return
            message = message or self._message(lost)
            self._discard()
            raise QgsProcessingException(message)
        if self._discard() and kind is None:
            self.feedback.pushInfo(tr("What was half written has been removed."))

    def _is_complete(self, name):
        """Whether a file has all that was written to it."""
        path, layer = _path(self.destinations[name]), _layer_name(self.destinations[name])
        if path is None or path.suffix.lower() not in READ_AGAIN:
            return True
        if path.suffix.lower() == ".shp":
            return _is_whole_shapefile(path, self._written[name])
        if path.suffix.lower() == ".dbf":
            return _is_whole_table(path, self._written[name])
        with _quiet() as gdal:
            source = gdal.OpenEx(str(path), gdal.OF_VECTOR)
            table = source and (source.GetLayerByName(layer) if layer else source.GetLayer(0))
            return table is not None and table.GetFeatureCount() >= self._written[name]

    def _not_written(self, name, origin="", geometry=None):
        """Why a result could not be written, and what to do about it."""
        if isinstance(origin, int):
            origin = Sentence("feature {}", origin)
        origin = origin and f" ({spoken(origin)})"
        kind = self._types[name]
        if geometry and not geometry.isNull() and geometry.type() != QgsWkbTypes.geometryType(kind):
            return tr(
                "A result{} could not be written: it is of the type {}, and the layer takes {} only. Leave "
                "it out of the input, or write to a GeoPackage."
            ).format(origin, *map(QgsWkbTypes.displayString, (geometry.wkbType(), kind)))
        return tr(
            "A result{} could not be written (is the disk full, or a value too long or unknown to "
            "the format?): {}"
        ).format(origin, self._sinks[name].lastError()) + _of_the_format(
            self.fields[name], self.destinations[name].partition("|")[0]
        )

    def _message(self, lost):
        paths = ", ".join(str(_path(self.destinations[name])) for name in lost)
        return tr(
            "Not everything could be written to {}. Is the disk full? Some formats also drop "
            "features without geometry; a GeoPackage keeps them."
        ).format(paths)

    def _discard(self):
        """Remove the files of this run; whether there were any."""
        found = False
        for name, destination in list(self.destinations.items()):
            if name in self._held:
                del self.destinations[name]
            elif _path(destination) is not None:
                _remove(destination)
                del self.destinations[name]
                found = True
        for path in self._texts:
            with contextlib.suppress(OSError):
                os.unlink(path)
                found = True
        return found


def _of_the_format(fields, file):
    """What to do about a field that the format of a file has for itself, or ''."""
    for name in fields.names():
        if name.lower() in OWN_FIELDS.get(Path(file).suffix.lower(), ()):
            return " " + tr(
                "The format keeps a field {} of its own: rename that of the input, or choose another format."
            ).format(name)
    return ""


def _path(destination):
    """The file of a destination; None for one in memory or in a database."""
    path = Path(destination.partition("|")[0])
    if path.suffix.lower() == ".shp" and not path.is_file():  # a table without geometry
        path = path.with_suffix(".dbf")
    return path if path.is_file() else None


def _is_whole_shapefile(path, count):
    """Whether the files of a shapefile are as long as their headers say, for so many features.

    GDAL would read what there is, and go without attributes that are not.
    """
    files = [path, path.with_suffix(".shx"), path.with_suffix(".dbf")]
    if not all(file.is_file() for file in files):
        return False
    sizes = [file.stat().st_size for file in files]
    words, index_words = (struct.unpack_from(">i", _head(file), 24)[0] for file in files[:2])
    return (
        sizes[0] >= 2 * words > 0
        and sizes[1] >= 2 * index_words >= 100 + 8 * count
        and _is_whole_table(files[2], count)
    )


def _is_whole_table(path, count):
    """The same of its table."""
    records, start, length = struct.unpack_from("<IHH", _head(path), 4)
    return records >= count and path.stat().st_size >= start + records * length > 0


def _head(path):
    with open(path, "rb") as stream:
        return stream.read(32).ljust(32, b"\0")


def _layer_name(destination):
    """The layer's name in its file, or ''."""
    return destination.partition("|layername=")[2].partition("|")[0]


@contextlib.contextmanager
def _quiet():
    """GDAL, telling of failures by None and nothing else."""
    from osgeo import gdal

    raises = gdal.GetUseExceptions()
    gdal.DontUseExceptions()
    gdal.PushErrorHandler("CPLQuietErrorHandler")
    try:
        yield gdal
    finally:
        gdal.PopErrorHandler()
        if raises:
            gdal.UseExceptions()


def _appends(parameter):
    """Whether the features were added to a layer that was there before."""
    return (
        isinstance(parameter, QgsProcessingOutputLayerDefinition)
        and getattr(parameter, "useRemapping", lambda: False)()
    )


def _remove(destination):
    """Remove a layer, and its file unless that has other layers."""
    path, layer = _path(destination), _layer_name(destination)
    if layer:
        with _quiet() as gdal:
            source = gdal.OpenEx(str(path), gdal.OF_VECTOR | gdal.OF_UPDATE)
            tables = range(source.GetLayerCount()) if source else ()
            names = [source.GetLayer(k).GetName() for k in tables]
            if set(names) - {layer}:
                if layer in names:
                    source.DeleteLayer(names.index(layer))
                return
    _remove_files(path)


def _remove_files(path):
    others = [path.with_suffix(end) for end in SIDECARS.get(path.suffix.lower(), ())]
    for file in [path, *others, *(Path(f"{path}{end}") for end in BESIDE)]:
        file.unlink(missing_ok=True)
