"""The module in a Slicer that has less than usual."""

from Testing.slicer.host.host import Host


def test_without_the_connector_connecting_says_what_to_install(tmp_path):
    host = Host(tmp_path, connector=False)
    try:
        host.open()
        host.press("connectButton")
        told = host.text("stateText") + host.text("remedyText")
    finally:
        host.close()
    assert "SlicerOpenIGTLink" in told
    assert host.errors == []


def test_without_main_window_and_layout_manager_the_module_opens(tmp_path):
    host = Host(tmp_path, window=False)
    try:
        host.open()
        host.leave()
        host.enter()
    finally:
        host.close()
    assert host.errors == []
