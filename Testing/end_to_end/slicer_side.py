"""Slicer's side of a delivery: scene, link, study and the logic that stores what arrives."""

import time

from rastrainer.slicer.background_work import BackgroundWork
from rastrainer.slicer.link.link import Link
from rastrainer.study.database.study import Study
from rastrainer_headless.connector import headlessKit
from rastrainer_headless.scene import HeadlessScene
from Testing.slicer.simulator_double import process_link


class SlicerSide:
    """`make_logic(scene, link, open_study, work)` returns the logic, which is closed with it."""

    def __init__(self, path, port, make_logic):
        scene = HeadlessScene().scene
        self.link = Link(scene, headlessKit)
        self.work = BackgroundWork()
        self.logic = make_logic(scene, self.link, lambda: Study.open(path), self.work)
        self.link.connectTo(port=port)

    def run_for(self, steps):
        for _ in range(steps):
            process_link(self.link)
            self.work.process()
            time.sleep(0.002)

    def close(self):
        self.logic.close()
        self.work.close()
        self.link.disconnect()
