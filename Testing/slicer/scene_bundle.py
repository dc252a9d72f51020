"""Opening a bundle (.mrb) in a headless scene, as Slicer does when a scene is loaded."""

import tempfile

import slicer

from rastrainer_headless.scene import HeadlessScene


def load_bundle(application: HeadlessScene, path):
    """Replace the scene by the scene of a bundle."""
    scene, messages = application.scene, slicer.vtkMRMLMessageCollection()
    with tempfile.TemporaryDirectory() as cache_folder:
        cache = slicer.vtkCacheManager()
        cache.SetRemoteCacheDirectory(cache_folder)
        data_io = slicer.vtkDataIOManager()
        data_io.SetCacheManager(cache)
        scene.SetDataIOManager(data_io)
        try:
            assert scene.ReadFromMRB(str(path), True, messages), messages.GetAllMessagesAsString()
        finally:
            scene.SetDataIOManager(None)
