"""Where the tools write: fields, sinks, and features that must not get lost."""

from qgis.core import QgsFeature, QgsFeatureSink, QgsFields, QgsProcessingException

from . import features


def make_fields(definition):
    """Return fields of (name, kind) pairs; kinds as in `features.field`."""
    fields = QgsFields()
    for name, kind in definition:
        fields.append(features.field(name, kind))
    return fields


def open_sink(tool, parameters, name, context, fields, wkb_type, crs, needed):
    """Open a sink; (None, None) for one that is not wanted.

    Several results may come of one feature, so the primary key is made anew.
    """
    sink, destination = tool.parameterAsSink(
        parameters, name, context, fields, wkb_type, crs,
        QgsFeatureSink.SinkFlag.RegeneratePrimaryKey,
    )  # fmt: skip
    if sink is None and (needed or parameters.get(name)):
        raise QgsProcessingException(tool.invalidSinkError(parameters, name))
    return sink, destination


def add_feature(sink, fields, geometry, values):
    """Write a feature; a failure is an error, so that nothing is lost in silence."""
    feature = QgsFeature(fields)
    if geometry is not None:
        feature.setGeometry(geometry)
    feature.setAttributes(values)
    if not sink.addFeature(feature, QgsFeatureSink.Flag.FastInsert):
        raise QgsProcessingException(
            "A result could not be written (is the disk full, or a value too long for the "
            f"format?): {sink.lastError()}"
        )
