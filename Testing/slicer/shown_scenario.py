"""A scenario in the scene with all its files, read at once."""

from rastrainer.slicer.background_work import BackgroundWork
from rastrainer.slicer.scene.scenario_nodes import SceneFileLoader, showScenario
from Testing.slicer.work_at_once import in_turns


def show_whole(scene, scenario):
    """Show a scenario, and fill its nodes; return the sentences about files that are unusable."""
    showScenario(scene, scenario)
    work, problems = BackgroundWork(), []
    loader = SceneFileLoader(scene, work)
    loader.problemFound.connect(problems.append)
    loader.process()
    in_turns(work)
    work.close()
    return problems
