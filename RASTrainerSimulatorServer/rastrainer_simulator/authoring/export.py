"""Pack a scenario for others, without face, title and source unless they are wanted."""

from __future__ import annotations

import hashlib
import shutil
import tempfile
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import scipy.ndimage
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkFiltersCore import vtkImplicitPolyDataDistance
from vtkmodules.vtkImagingStencil import vtkImageStencilToImage, vtkPolyDataToImageStencil
from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper, vtkRenderer

from rastrainer import transforms
from rastrainer.errors import InputError
from rastrainer.head.mesh import HeadMesh, nearest_on_mesh, read_head_mesh
from rastrainer.head.volume import KEPT_MM, HeadVolume, read_head_volume
from rastrainer.scenario.library import checked_scenario, pack
from rastrainer.scenario.scenario import PREVIEW_NAME, Camera, Scenario
from rastrainer.scenario.writer import read_files, scenario_name, write_scenario
from rastrainer_simulator.authoring.face_removal import (
    RADIUS_MM,
    check_front,
    face_vertices,
    nose_tip,
    without_face,
)
from rastrainer_simulator.authoring.scenario_check import ON_SKIN_MM
from rastrainer_simulator.rendering.picture import draw_preview, frames, write_png
from rastrainer_simulator.scene.surfaces import surface


@dataclass(frozen=True)
class Grid:
    """The grid of an image's voxels; the matrix is (4, 4) float, mm."""

    shape: tuple[int, int, int]
    ijk_to_ras: np.ndarray

    def part(self, slices: tuple[slice, slice, slice]) -> Grid:
        first = np.array([each.start for each in slices])
        size = tuple(each.stop - each.start for each in slices)
        return Grid(size, self.ijk_to_ras @ transforms.rigid(np.eye(3), first))

    def around(self, center: np.ndarray, radius: float) -> tuple[slice, slice, slice]:
        """Return the part of the image within `radius` (mm) of a point (3,), RAS."""
        to_ijk = transforms.inverse(self.ijk_to_ras)
        middle = transforms.apply(to_ijk, center)
        reach = radius * np.linalg.norm(to_ijk[:3, :3], axis=1)
        low = np.clip(np.floor(middle - reach), 0, np.array(self.shape) - 1).astype(int)
        high = np.clip(np.ceil(middle + reach) + 1, low + 1, self.shape).astype(int)
        i, j, k = (slice(start, stop) for start, stop in zip(low, high, strict=True))
        return i, j, k

    def places(self) -> np.ndarray:
        """Return the center of each voxel, (i, j, k, 3) float, RAS mm."""
        return transforms.apply(self.ijk_to_ras, np.moveaxis(np.indices(self.shape), 0, -1))

    def inside(self, mesh: HeadMesh) -> np.ndarray:
        """Return which voxels (i, j, k) bool are inside a closed surface."""
        vertices = transforms.apply(transforms.inverse(self.ijk_to_ras), mesh.vertices)
        stencil = vtkPolyDataToImageStencil()
        stencil.SetInputData(surface(vertices, mesh.triangles))
        stencil.SetOutputWholeExtent(*(end for size in self.shape for end in (0, size - 1)))
        image = vtkImageStencilToImage()
        image.SetInputConnection(stencil.GetOutputPort())
        image.SetOutputScalarTypeToUnsignedChar()
        image.Update()
        scalars = vtk_to_numpy(image.GetOutput().GetPointData().GetScalars())
        return scalars.reshape(self.shape, order="F") > 0

    def at(self, places: np.ndarray) -> np.ndarray:
        """Return which voxels (i, j, k) bool contain one of the points (n, 3), RAS mm."""
        indices = np.rint(transforms.apply(transforms.inverse(self.ijk_to_ras), places)).astype(int)
        indices = indices[((indices >= 0) & (indices < self.shape)).all(axis=1)]
        marked = np.zeros(self.shape, dtype=bool)
        marked[tuple(indices.T)] = True
        return marked

    def distances(self, marked: np.ndarray) -> np.ndarray:
        """Return the distance (i, j, k) float, mm, of each voxel to the nearest marked one."""
        spacing = np.linalg.norm(self.ijk_to_ras[:3, :3], axis=0)
        return scipy.ndimage.distance_transform_edt(~marked, spacing)


LEAST_DEPTH_MM = 15.0
"""Least depth behind the shield (which replaces the face) that is removed, too."""
BEHIND_FACE_MM = 4.0
"""Least depth behind the deepest point of the face, which may be behind the shield."""
BEYOND_MM = 4.0
"""Margin around the radius of the face."""
_SAMPLES = 6
"""Samples along each side of a triangle, about two millimeters long."""


def without_face_in(volume: HeadVolume, head: HeadMesh) -> HeadVolume:
    """Return the images of a head without its face and without anything around the head.

    The removed part of the face depends only on the shield of `without_face`, so that the images
    reveal no more about the face than the exported surface.
    """
    shield, tip = without_face(head), nose_tip(head)
    grid = Grid(volume.values.shape, volume.ijk_to_ras)
    values, nothing = volume.values.copy(), volume.values.min()
    values[grid.distances(grid.inside(head)) > KEPT_MM] = nothing
    around = grid.around(tip, RADIUS_MM + BEYOND_MM)
    part = grid.part(around)
    is_near = np.linalg.norm(part.places() - tip, axis=-1) < RADIUS_MM + BEYOND_MM
    is_face = face_vertices(head)
    # Points all over the triangles of the shield that have a corner in the face.
    corners = shield.vertices[shield.triangles[is_face[shield.triangles].any(axis=1)]]
    steps = np.arange(_SAMPLES + 1) / _SAMPLES
    weights = np.array([(a, b, 1.0 - a - b) for a in steps for b in steps if a + b < 1.0 + 1e-9])
    to_shield = part.distances(part.at(np.einsum("wc,tcx->wtx", weights, corners).reshape(-1, 3)))
    # The depth behind the shield that contains the whole face.
    signed = vtkImplicitPolyDataDistance()
    signed.SetInput(surface(shield.vertices, shield.triangles))
    face = head.vertices[is_face].astype(float)
    deepest = max((-signed.EvaluateFunction(place) for place in face), default=0.0)
    depth = max(LEAST_DEPTH_MM, deepest + BEHIND_FACE_MM)
    is_taken = ~part.inside(shield) | (to_shield < depth)
    values[around][is_near & is_taken] = nothing
    return replace(volume, values=values)


VIEWS = np.array([[0.3, 1.0, 0.1], [1.0, 0.0, 0.0], [0.0, -1.0, 0.1]])
"""Where the eye is: in front, at the right and behind, as A and R of RAS say."""

SIDE = 300
"""Pixels along each side of a view."""

_DISTANCE, _ANGLE_DEG = 5.2, 26.0
_SKIN, _AROUND = (0.85, 0.66, 0.55), (1.0, 1.0, 1.0)


def _middle(volume: HeadVolume, head: HeadMesh) -> np.ndarray:
    """Return the sagittal plane through a head's middle as gray (SIDE, SIDE, 3) uint8, A left."""
    along = (np.arange(SIDE) + 0.5) / SIDE - 0.5
    heights, depths = np.meshgrid(along, along, indexing="ij")
    places = head.middle + float(head.size.max()) * 1.1 * np.stack(
        [np.zeros_like(depths), -depths, -heights], axis=-1
    )
    voxels = np.moveaxis(transforms.apply(transforms.inverse(volume.ijk_to_ras), places), -1, 0)
    values = scipy.ndimage.map_coordinates(
        volume.values, voxels, float, order=0, cval=float(volume.values.min())
    )
    share = np.clip((values - volume.level) / volume.window + 0.5, 0.0, 1.0)
    return np.repeat((255 * share).astype(np.uint8)[:, :, None], 3, axis=2)


FACELESS = " The face was taken off."
NO_SOURCE = "Removed before the scenario was shared."


def draw_face_removal(folder: Path, picture: Path) -> str:
    """Draw a scenario's head before and after its face is removed, and return a sentence on it.

    Each is drawn from three sides, and its images in the middle.
    """
    scenario = checked_scenario(folder)
    head = read_head_mesh(scenario.head)
    warning = check_front(head)
    volume = read_head_volume(scenario.volume) if scenario.volume else None
    _, shield = _faceless(scenario, head)
    after = without_face_in(volume, head) if volume else None
    reach = _DISTANCE * float(head.size.max()) / 2.0
    up = np.array([0.0, 0.0, 1.0])
    cameras = [
        Camera(head.middle + reach * view / np.linalg.norm(view), head.middle, up, _ANGLE_DEG)
        for view in VIEWS
    ]
    rows = []
    for shown, images in ((head, volume), (shield, after)):
        mapper, actor, renderer = vtkPolyDataMapper(), vtkActor(), vtkRenderer()
        # A renderer's camera is in meters.
        mapper.SetInputData(surface(shown.vertices / 1000.0, shown.triangles, shown.vertex_normals))
        actor.SetMapper(mapper)
        actor.GetProperty().SetColor(*_SKIN)
        renderer.AddActor(actor)
        renderer.SetBackground(*_AROUND)
        parts = list(frames(renderer, ((camera, (SIDE, SIDE)) for camera in cameras)))
        if images is not None:
            parts.append(_middle(images, head))
        rows.append(np.concatenate(parts, axis=1))
    write_png(np.concatenate(rows), picture)
    return f"The picture shows the head before (above) and after. {warning}".rstrip()


def pack_for_sharing(
    folder: Path, package: Path, keeps_face: bool = False, keeps_names: bool = False
) -> str:
    """Write a scenario as one zip file, and return a sentence that lists the removed parts.

    Without the face, head, picture and images lack it, and the skull is left out with the
    procedures, which need it. Title, name and sources, which often are the patient's name, are
    replaced by a number computed from the head's surface, unless they are kept.
    """
    scenario, taken = checked_scenario(folder), []
    head, skull, volume, no_go = read_files(scenario)
    preview = scenario.preview
    warning = "" if keeps_face else check_front(head)
    if not keeps_face:
        volume = without_face_in(volume, head) if volume else None
        scenario, head, skull = *_faceless(scenario, head), None
        taken += ["the face", "the skull"] if scenario.skull else ["the face"]
        if scenario.landmarks:
            scenario = replace(scenario, landmarks=())
            taken.append("the landmarks, most of which were on the face")
        if scenario.procedures:
            scenario, no_go = replace(scenario, procedures=()), {}
            taken.append("the procedures, which need the skull")
    if not keeps_names:
        number = hashlib.sha256(head.vertices.astype("<f4").tobytes()).hexdigest()[:6]
        title = f"Head {number}"
        scenario = replace(
            scenario,
            name=scenario_name(title),
            title=title,
            provenance=replace(scenario.provenance, source=NO_SOURCE),
            procedures=tuple(replace(each, source=NO_SOURCE) for each in scenario.procedures),
        )
        taken += ["its title", "its name", "its source"]
    with tempfile.TemporaryDirectory() as temporary:
        clean = Path(temporary)
        write_scenario(clean, scenario, head, skull, volume, no_go)
        if not keeps_face:
            draw_preview(clean / PREVIEW_NAME, scenario, head)
        elif preview:
            shutil.copyfile(preview, clean / PREVIEW_NAME)
        pack(clean, package)
    if not taken:
        return "Nothing was removed."
    return f"Removed: {', '.join(taken)}. It is called {scenario.title} now. {warning}".rstrip()


def _faceless(scenario: Scenario, head: HeadMesh) -> tuple[Scenario, HeadMesh]:
    head = without_face(head)
    for task in scenario.tasks:
        away = [nearest_on_mesh(head, point).distance for point in task.fiducials]
        lost = [label for label, d in zip(task.labels, away, strict=True) if d > ON_SKIN_MM]
        if lost:
            raise InputError(
                f"{task.title} has fiducials on the face ({', '.join(lost)}), which would be taken "
                "off; move them, or keep the face."
            )
    provenance = scenario.provenance
    if not provenance.method.endswith(FACELESS):
        provenance = replace(provenance, method=provenance.method + FACELESS)
    return replace(scenario, provenance=provenance), head
