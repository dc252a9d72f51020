"""The built-in head's MRI is a sample of Slicer's module Sample Data, without any network."""

import sys
from pathlib import Path

from rastrainer_simulator.assets import asset_path


def test_the_bundled_mri_is_a_sample_that_needs_no_network(host):
    import SampleData

    (source,) = SampleData.SampleDataLogic.sampleDataSourcesByCategory("RASTrainer")
    assert source.uris == [asset_path("scenarios", "colin27", "volume.nrrd").as_uri()]
    assert Path(source.thumbnailFileName).is_file()
    volume = SampleData.SampleDataLogic().downloadSample(source.sampleName)
    assert volume.GetName() == "Colin27Head"
    assert volume.GetSpacing() == (1.0, 1.0, 1.0)
    assert volume.GetImageData().GetScalarRange()[1] > 200
    assert host.scene.GetFirstNodeByName("Colin27Head") is volume


def test_a_slicer_without_sample_data_or_a_module_without_the_mri_registers_nothing(
    host, monkeypatch, tmp_path
):
    import SampleData
    import slicer

    from rastrainer.sections.sample_data import registerSampleData

    del slicer.modules.sampleDataSources
    registerSampleData(tmp_path)
    monkeypatch.setitem(sys.modules, "SampleData", None)
    registerSampleData(asset_path())
    assert SampleData.SampleDataLogic.sampleDataSourcesByCategory() == {}
    assert host.errors == []
