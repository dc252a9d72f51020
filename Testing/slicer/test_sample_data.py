"""The built-in head's MRI is a sample of Slicer's module Sample Data, without any network."""

import sys
from pathlib import Path

from rastrainer_simulator.assets import asset_path


def test_the_bundled_mri_is_a_sample_that_needs_no_network_where_there_are_samples(
    host, monkeypatch, tmp_path
):
    import SampleData
    import slicer

    from rastrainer.sections.sample_data import registerSampleData

    (source,) = SampleData.SampleDataLogic.sampleDataSourcesByCategory("RASTrainer")
    assert source.uris == [asset_path("scenarios", "colin27", "volume.nrrd").as_uri()]
    assert Path(source.thumbnailFileName).is_file()
    volume = SampleData.SampleDataLogic().downloadSample(source.sampleName)
    assert host.scene.GetFirstNodeByName("Colin27Head") is volume
    assert volume.GetImageData().GetScalarRange()[1] > 200
    # A module without the MRI, and a Slicer without Sample Data.
    del slicer.modules.sampleDataSources
    registerSampleData(tmp_path)
    monkeypatch.setitem(sys.modules, "SampleData", None)
    registerSampleData(asset_path())
    assert SampleData.SampleDataLogic.sampleDataSourcesByCategory() == {}
