"""Tables and the learning curve are shown, and the user's own layout is restored after them."""

import uuid

import pytest
import slicer

from Testing.slicer.recorded_trial import store_trial_on_colin

OWN = slicer.vtkMRMLLayoutNode.SlicerLayoutOneUp3DView


@pytest.fixture
def looking(fresh_module, make_record):
    """The module with a trainee who has a trial, in the user's own layout."""
    record = make_record(str(uuid.UUID(int=1)), trainee="T001", scenario="colin27")
    store_trial_on_colin(fresh_module, record, 2)
    fresh_module.press("createTraineeButton")
    fresh_module.choose("traineeComboBox", "T001")
    slicer.app.layoutManager().setLayout(OWN)
    return fresh_module


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
    assert views() == (OWN, 0, 0)


def test_leaving_a_section_or_the_module_restores_the_users_layout(looking):
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


def test_the_users_layout_is_restored_with_a_closed_scene_unless_the_user_has_chosen_another(
    looking,
):
    looking.press("showTablesButton")
    looking.clear_scene()
    looking.wait_until(lambda: not looking.find("showTablesButton").checked, "the button follows")
    assert slicer.app.layoutManager().layout == OWN
    looking.press("showTablesButton")
    assert looking.shown_tables() == ["Score"]
    other = slicer.vtkMRMLLayoutNode.SlicerLayoutConventionalView
    slicer.app.layoutManager().setLayout(other)
    looking.wait_until(lambda: not looking.find("showTablesButton").checked, "the button follows")
    looking.leave()
    assert views() == (other, 0, 0)
    looking.enter()
