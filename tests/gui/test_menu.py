"""The menu, the button and the example, in a window on no screen."""

import pytest
from qgis.core import QgsProject
from qgis.PyQt.QtWidgets import QToolButton


@pytest.fixture
def menu(iface):
    from isthmus.gui.menu import Menu

    menu = Menu(iface)
    yield menu
    menu.unload()


def texts(menu):
    return [action.text() for action in menu.menu.actions() if not action.isSeparator()]


def test_menu_and_button_list_the_same(menu, iface, provider):
    (button,) = iface.toolbar.findChildren(QToolButton, options=_direct())[-1:]
    assert button.menu() is menu.menu and not button.icon().isNull()
    assert iface.menu.actions()[0].menu() is menu.menu
    tools = [f"{tool.displayName()}…" for tool in provider.algorithms()]
    assert texts(menu)[: len(tools)] == tools
    assert texts(menu)[len(tools) :] == [
        "Try values of tau…",
        "Try it on an example",
        "Install packages…",
        "Help",
    ]


def _direct():
    from qgis.PyQt.QtCore import Qt

    return Qt.FindChildOption.FindDirectChildrenOnly


def test_unload_leaves_nothing(iface):
    from isthmus.gui.menu import Menu

    menus, buttons = len(iface.menu.actions()), len(iface.toolbar.actions())
    menu = Menu(iface)
    menu.open_panel()
    assert len(iface.menu.actions()) == menus + 1 and len(iface.toolbar.actions()) == buttons + 1
    menu.unload()
    assert len(iface.menu.actions()) == menus and len(iface.toolbar.actions()) == buttons


def test_the_example_leaves_styled_layers_and_a_message(menu, iface):
    (action,) = [a for a in menu.menu.actions() if a.text() == "Try it on an example"]
    action.trigger()
    layers = {layer.name(): layer for layer in QgsProject.instance().mapLayers().values()}
    assert set(layers) == {"Isthmus example", "Parts", "Cuts"}
    assert all(layer.isValid() for layer in layers.values())
    parts, cuts = layers["Parts"], layers["Cuts"]
    assert parts.featureCount() > layers["Isthmus example"].featureCount() == 3
    assert cuts.featureCount() > 5 and {f["status"] for f in parts.getFeatures()} == {""}
    assert cuts.renderer().symbol().symbolLayerCount() == 2  # the style of cuts
    assert str(parts.featureCount()) in iface.bar.currentItem().text()
    assert iface.canvas.extent().contains(layers["Isthmus example"].extent())


def test_a_tool_opens_its_dialog(menu, monkeypatch):
    import processing

    opened = []

    class Dialog:
        def show(self):
            opened.append("shown")

    monkeypatch.setattr(
        processing, "createAlgorithmDialog", lambda name, given: opened.append(name) or Dialog()
    )
    menu.menu.actions()[0].trigger()
    assert len(opened) == 2 and opened[0].startswith("isthmus:") and opened[1] == "shown"


def test_where_packages_miss_every_way_leads_to_their_dialog(menu, monkeypatch):
    """And from there to what was wanted."""
    from isthmus.gui import menu as module

    monkeypatch.setattr(module, "dependency_problem", lambda: "shapely is missing")
    for action in menu.menu.actions()[:1] + [a for a in menu.menu.actions() if a.text().startswith("Try")]:
        menu.dialogs.clear()
        action.trigger()
        dialog = menu.dialogs["packages"]
        assert dialog.isVisible() and dialog.then is not None
        dialog.close()
    monkeypatch.setattr(module, "dependency_problem", lambda: "")
    gone_on = []
    monkeypatch.setattr(dialog, "then", lambda: gone_on.append(True))
    dialog.installed(None, None)
    assert gone_on == [True]
