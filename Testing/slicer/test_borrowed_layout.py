"""Tables and the learning curve are shown, and the user's own layout is restored after them."""

import uuid

import pytest
import slicer

from Testing.slicer.recorded_trial import store_trial_on_colin

OWN = slicer.vtkMRMLLayoutNode.SlicerLayoutOneUp3DView


@pytest.fixture
def looking(host, make_record):
    """The module with a trainee who has a trial, in the user's own layout."""
    host.open()
    record = make_record(str(uuid.UUID(int=1)), trainee="T001", scenario="colin27")
    store_trial_on_colin(host, record, 2)
    host.press("createTraineeButton")
    host.choose("traineeComboBox", "T001")
    slicer.app.layoutManager().setLayout(OWN)
    return host


def views():
    manager = slicer.app.layoutManager()
    return manager.layout, manager.tableViewCount, manager.plotViewCount


def test_the_score_is_shown_as_a_table_until_the_button_is_pressed_again(looking):
    looking.press("showTablesButton")
    assert looking.shown_tables() == ["Score"]
    looking.idle_for(0.3)
    assert looking.find("showTablesButton").checked
    looking.press("showTablesButton")
    assert views() == (OWN, 0, 0)


def test_the_learning_curve_is_shown_until_the_button_is_pressed_again(looking):
    looking.press("learningCurveButton")
    plot = slicer.app.layoutManager().plotWidget(0).mrmlPlotViewNode()
    assert plot.GetPlotChartNode().GetTitle() == "Learning curve of T001"
    looking.press("learningCurveButton")
    assert views() == (OWN, 0, 0)


def test_the_later_of_the_two_is_shown_and_then_the_users_layout(looking):
    looking.press("learningCurveButton")
    looking.press("showTablesButton")
    looking.wait_until(
        lambda: not looking.find("learningCurveButton").checked, "the other is not shown any more"
    )
    assert views()[1:] == (1, 0)
    looking.press("showTablesButton")
    assert views() == (OWN, 0, 0)


@pytest.mark.parametrize("how", ["folded", "left", "closed"])
def test_leaving_a_section_restores_the_users_layout(looking, how):
    looking.press("showTablesButton")
    assert views()[0] != OWN
    if how == "folded":
        looking.find("scoreCollapsibleButton").collapsed = True
        looking.process_events()
    elif how == "left":
        looking.leave()
    else:
        looking.widget.cleanup()
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
