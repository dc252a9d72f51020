"""How exactly each method of registration finds its points, and what was published of its error.

What was measured in patients is the error at a target, not that of a point. Only the figures of
`source` are published; where it says so, the error of a point is our own assumption.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from rastrainer.registration.methods import RegistrationMethod

MONGEN_2019 = (
    "Mongen and Willems 2019, Acta Neurochirurgica, doi:10.1007/s00701-019-03867-8: eleven patients"
)
MULTIMODALITY_1999 = (
    "“Clinical evaluation of multimodality registration in frameless stereotaxy”: 44 patients"
)
SKULL_BASE_PAGE = (
    "“Registration”, www.alpfmedical.info/skull-base/registration.html, of unknown year: "
    "experience of one group"
)
LASER_2003 = (
    "Laser study of 2003, doi:10.1055/s-2003-40811: 25 registrations each on a model of a skull"
)
REALSENSE_2017 = (
    "ten Harkel et al., “Depth accuracy of the RealSense F200”: 34 patients, 1.07 mm at 35 cm"
)


@dataclass(frozen=True)
class MethodNoise:
    """The noise of a method.

    Attributes:
        point_mm: Of a touched point, the RMS length of its error (FLE); of a traced or scanned
            point, the standard deviation across the skin or along the ray.
        source: Where `point_mm` is from.
        published: What was measured at a target, with its source; "" if nothing is cited.
        is_on_skin: Whether the method's points move with the skin.
    """

    point_mm: float
    source: str
    published: str
    is_on_skin: bool = True


PUBLISHED_NOISE: Mapping[RegistrationMethod, MethodNoise] = MappingProxyType(
    {
        RegistrationMethod.BONE_SCREWS: MethodNoise(
            0.5,
            "our assumption: no skin between screw and bone",
            f"below 1 mm ({SKULL_BASE_PAGE})",
            is_on_skin=False,
        ),
        RegistrationMethod.FIDUCIALS: MethodNoise(
            1.5,
            "the published RMSE of 1.4 mm over fifteen fiducials, on which the score is based",
            f"2.49 mm (mean; {MONGEN_2019}); 1.6 ± 0.1 mm ({MULTIMODALITY_1999})",
        ),
        RegistrationMethod.LANDMARKS: MethodNoise(
            4.0,
            f"middle of 3 to 5 mm, at best ({SKULL_BASE_PAGE})",
            f"3.4 ± 0.4 mm ({MULTIMODALITY_1999})",
        ),
        RegistrationMethod.SURFACE: MethodNoise(
            0.5, "our assumption, as of the guidance", f"5.35 mm (mean; {MONGEN_2019})"
        ),
        RegistrationMethod.LANDMARKS_SURFACE: MethodNoise(0.5, "as of the surface", ""),
        RegistrationMethod.SCAN: MethodNoise(
            1.07, REALSENSE_2017, f"2.08 ± 0.49 mm ({LASER_2003})"
        ),
    }
)
