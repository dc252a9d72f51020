"""Tables and the learning curve are shown, and the user's own layout is restored after them."""

import uuid

import pytest
import slicer

from Testing.slicer.recorded_trial import store_trial_on_colin

OWN = slicer.vtkMRMLLayoutNode.SlicerLayoutOneUp3DView


@pytest.fixture
def looking(fresh_module, make_record):
    """The module with a trainee who has a trial, in the user's own layout."""
    return look(fresh_module, make_record)


def look(host, make_record):
    record = make_record(str(uuid.UUID(int=1)), trainee="T001", scenario="colin27")
    store_trial_on_colin(host, record, 2)
    host.press("createTraineeButton")
    host.choose("traineeComboBox", "T001")
    slicer.app.layoutManager().setLayout(OWN)
    return host


def views():
    manager = slicer.app.layoutManager()
    return manager.layout, manager.tableViewCount, manager.plotViewCount


def test_tables_and_the_learning_curve_are_shown_until_the_button_is_pressed_again(looking):
    looking.press("showTablesButton")
    assert looking.shown_tables() == ["Score"]
    looking.finish_work()
    assert looking.find("showTablesButton").checked
    looking.press("showTablesButton")
    assert views() == (OWN, 0, 0)
    looking.press("learningCurveButton")
    plot = slicer.app.layoutManager().plotWidget(0).mrmlPlotViewNode()
    assert plot.GetPlotChartNode().GetTitle() == "Learning curve of T001"
    looking.press("showTablesButton")
    looking.wait_until(
        lambda: not looking.find("learningCurveButton").checked, "the other is not shown any more"
    )
    assert views()[1:] == (1, 0)
    looking.press("showTablesButton")
    looking.press("learningCurveButton")
    looking.press("learningCurveButton")
    assert views() == (OWN, 0, 0)


def test_leaving_a_section_the_module_or_slicer_restores_the_users_layout(
    host, module_widget, make_record
):
    looking = look(host, make_record)

    def fold():
        looking.find("scoreCollapsibleButton").collapsed = True
        looking.process_events()

    def leave():
        looking.leave()
        looking.enter()

    for end in (fold, leave):
        looking.press("showTablesButton")
        assert views()[0] != OWN
        end()
        assert views() == (OWN, 0, 0)
        looking.wait_until(lambda: not looking.find("showTablesButton").checked, "it follows")
    looking.press("showTablesButton")
    module_widget.cleanup()
    assert views() == (OWN, 0, 0)


def test_a_layout_chosen_by_the_user_meanwhile_stays(looking):
    looking.press("showTablesButton")
    other = slicer.vtkMRMLLayoutNode.SlicerLayoutConventionalView
    slicer.app.layoutManager().setLayout(other)
    looking.wait_until(lambda: not looking.find("showTablesButton").checked, "the button follows")
    looking.leave()
    assert views() == (other, 0, 0)
    looking.enter()


def test_the_users_layout_is_restored_when_the_tables_disappear_with_their_scene(looking):
    looking.press("showTablesButton")
    looking.clear_scene()
    looking.wait_until(lambda: not looking.find("showTablesButton").checked, "the button follows")
    assert slicer.app.layoutManager().layout == OWN
    looking.press("showTablesButton")
    assert looking.shown_tables() == ["Score"]
