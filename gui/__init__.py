"""What the plugin adds to QGIS's window: menu, panel, dialogs. Nothing here is loaded under qgis_process."""
