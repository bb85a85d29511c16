# SPDX-License-Identifier: Apache-2.0
import os
from collections.abc import Callable, Sequence
from types import TracebackType
from typing import Literal, Self, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

__version__: str
convention: int
passes: list[str]
MDF_PARAMETERS: tuple[str, ...]
MDF_METHODS: tuple[str, ...]

Path = str | os.PathLike[str]
Per = Literal["triangle", "vertex", "corner"]
Compression = Literal["none", "zips", "zip", "piz"]

class InvalidInput(ValueError): ...
class FileError(OSError): ...
class Cancelled(RuntimeError): ...

class Mesh:
    def __init__(
        self,
        triangles: NDArray[np.int32],
        corner_vert: NDArray[np.int32],
        corner_uv: NDArray[np.float32] | None,
        vertex_count: int,
    ) -> None: ...
    @property
    def triangles(self) -> NDArray[np.int32]: ...
    @property
    def corner_vert(self) -> NDArray[np.int32]: ...
    @property
    def corner_uv(self) -> NDArray[np.float32] | None: ...
    @property
    def vertex_count(self) -> int: ...
    @property
    def tiles(self) -> list[tuple[int, int]]: ...

class RestReport:
    @property
    def degenerate_triangles(self) -> int: ...
    @property
    def no_uv_triangles(self) -> int: ...
    @property
    def mirrored_triangles(self) -> int: ...
    @property
    def seam_vertices(self) -> int: ...
    @property
    def overlap_fraction(self) -> float: ...

class RestState:
    def __init__(self, mesh: Mesh, positions: NDArray[np.float32]) -> None: ...
    @property
    def report(self) -> RestReport: ...

class TexelCoverage:
    def __init__(
        self,
        mesh: Mesh,
        width: int,
        height: int,
        tile: tuple[int, int] = (0, 0),
        margin: int = 16,
    ) -> None: ...
    def bake(
        self,
        corner_values: NDArray[np.float32],
        background: Sequence[float] = (1.0, 0.0, 1.0),
    ) -> NDArray[np.float32]: ...
    @property
    def width(self) -> int: ...
    @property
    def height(self) -> int: ...
    @property
    def covered(self) -> int: ...
    @property
    def overlapping(self) -> int: ...
    @property
    def triangle(self) -> NDArray[np.int32]: ...

class SequenceBaker:
    def __init__(
        self,
        mesh: Mesh,
        rest: RestState | NDArray[np.float32],
        width: int,
        height: int,
        passes: Sequence[str] = ["tension"],
        *,
        margin: int = 16,
        tile: tuple[int, int] = (0, 0),
        per: Per = "corner",
        compression: Compression = "zip",
        metadata: dict[str, object] = {},
        in_flight: int = 2,
        half: bool = False,
        mantissa_bits: int | None = None,
        alpha: float | Sequence[float] = 0.5,
        M0: ArrayLike | None = None,
        strength: float = 1.0,
        height_response: float = 0.0,
    ) -> None: ...
    def frame(
        self,
        deformed: NDArray[np.float32],
        paths: dict[str, Path],
        metadata: dict[str, object] = {},
        *,
        rest: RestState | NDArray[np.float32] | None = None,
    ) -> None: ...
    def cancel(self) -> None: ...
    def finish(self) -> None: ...
    @property
    def progress(self) -> tuple[int, int]: ...
    @property
    def coverage_report(self) -> dict[str, int]: ...
    def __enter__(self) -> Self: ...
    def __exit__(
        self,
        type: type[BaseException] | None,
        value: BaseException | None,
        traceback: TracebackType | None,
    ) -> None: ...

class VerifyReport:
    @property
    def ok(self) -> bool: ...
    @property
    def problems(self) -> list[str]: ...
    @property
    def sequences(self) -> dict[str, list[int]]: ...

def set_threads(count: int) -> None: ...
def threads() -> int: ...
def udim(tile: tuple[int, int]) -> int: ...
def tension(
    mesh: Mesh,
    rest: RestState | NDArray[np.float32],
    deformed: NDArray[np.float32],
    per: Per = "corner",
) -> NDArray[np.float32]: ...
def tension_matrix(t: NDArray[np.float32]) -> NDArray[np.float32]: ...
def stretch(t: NDArray[np.float32]) -> NDArray[np.float32]: ...
def wrinkle(t: NDArray[np.float32]) -> NDArray[np.float32]: ...
def stretch_matrix(s: float) -> NDArray[np.float64]: ...
def material_matrix(stretch: float, rotation: float, shear: float) -> NDArray[np.float64]: ...
def alpha2(
    t: NDArray[np.float32],
    alpha: float | Sequence[float],
    M0: ArrayLike | None = None,
    strength: float = 1.0,
    height_response: float = 0.0,
) -> NDArray[np.float32]: ...
def roughness(
    t: NDArray[np.float32],
    alpha: float | Sequence[float],
    M0: ArrayLike | None = None,
    strength: float = 1.0,
    height_response: float = 0.0,
) -> NDArray[np.float32]: ...
def correlated_stretch(alpha_x: float, alpha_y: float, r_xy: float) -> NDArray[np.float64]: ...
def lobe_parameters(
    t: NDArray[np.float32],
    alpha: float | Sequence[float],
    M0: ArrayLike | None = None,
    strength: float = 1.0,
    height_response: float = 0.0,
) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.float32]]: ...
def deformation_tensor(
    mesh: Mesh, rest: RestState | NDArray[np.float32], deformed: NDArray[np.float32]
) -> NDArray[np.float32]: ...
def project_tensor(
    tensor: NDArray[np.float32], x: NDArray[np.float32], y: NDArray[np.float32]
) -> NDArray[np.float32]: ...
def bake(
    mesh: Mesh,
    corner_values: NDArray[np.float32],
    width: int,
    height: int,
    tile: tuple[int, int] = (0, 0),
    margin: int = 16,
    background: Sequence[float] = (1.0, 0.0, 1.0),
) -> NDArray[np.float32]: ...
def write_exr(
    path: Path,
    pixels: NDArray[np.float32],
    *,
    channels: Sequence[str] | None = None,
    compression: Compression = "zip",
    half: bool = False,
    mantissa_bits: int | None = None,
    metadata: dict[str, object] = {},
) -> None: ...
def read_exr(path: Path) -> NDArray[np.float32]: ...
def exr_metadata(path: Path) -> dict[str, str]: ...
def verify(
    directory: Path,
    frames: Sequence[int] | None = None,
    sequences: Sequence[str] | None = None,
) -> VerifyReport: ...

_Floats = NDArray[np.float32] | NDArray[np.float64]

class Distribution:
    def P22(self, slopes: ArrayLike) -> _Floats: ...
    def D(self, m: ArrayLike) -> _Floats: ...
    def Lambda(self, v: ArrayLike) -> _Floats: ...
    def G1(self, v: ArrayLike) -> _Floats: ...
    def projected_area(self, v: ArrayLike) -> _Floats: ...
    def sample(self, u: ArrayLike) -> _Floats: ...
    def pdf(self, m: ArrayLike) -> _Floats: ...
    def sample_visible(self, v: ArrayLike, u: ArrayLike) -> _Floats: ...
    def pdf_visible(self, v: ArrayLike, m: ArrayLike) -> _Floats: ...
    def transformed(self, M: ArrayLike) -> TransformedDistribution: ...
    def sheared(self, slope_x: float, slope_y: float) -> NonCentredDistribution: ...

class TransformedDistribution(Distribution):
    @property
    def base(self) -> Distribution: ...
    @property
    def M(self) -> NDArray[np.float64]: ...

class Beckmann(Distribution):
    def __init__(self, alpha_x: float, alpha_y: float | None = None) -> None: ...
    @property
    def alpha_x(self) -> float: ...
    @property
    def alpha_y(self) -> float: ...

def beckmann_lambda_rational(a: ArrayLike) -> NDArray[np.float64]: ...

class STD(Distribution):
    def __init__(self, alpha: float, gamma: float) -> None: ...
    @property
    def alpha(self) -> float: ...
    @property
    def gamma(self) -> float: ...

def std_lambda_rational(a: ArrayLike, gamma: ArrayLike) -> NDArray[np.float64]: ...

class Phong(Distribution):
    def __init__(self, exponent: float) -> None: ...
    @property
    def exponent(self) -> float: ...

class EllipsoidNDF(Distribution):
    def __init__(self, A: ArrayLike) -> None: ...
    @staticmethod
    def from_angles(
        alpha_x: float,
        alpha_y: float,
        theta_x: float = 0.0,
        theta_y: float = 0.0,
        theta_z: float = 0.0,
    ) -> EllipsoidNDF: ...
    @staticmethod
    def from_sggx(S: ArrayLike) -> EllipsoidNDF: ...
    @property
    def A(self) -> NDArray[np.float64]: ...
    @property
    def sggx_matrix(self) -> NDArray[np.float64]: ...
    @property
    def mean_normal(self) -> NDArray[np.float64]: ...
    @property
    def mean_slope(self) -> tuple[float, float]: ...
    @property
    def unit_size(self) -> float: ...
    def unclamped_G1(self, v: ArrayLike) -> _Floats: ...
    def gaussian_curvature(self, m: ArrayLike, C_e: float = 1.0) -> NDArray[np.float64]: ...
    def ellipsoid_area(self, u: ArrayLike, C_e: float = 1.0) -> NDArray[np.float64]: ...
    def lune_area(self, u: ArrayLike, v: ArrayLike, C_e: float = 1.0) -> NDArray[np.float64]: ...
    def transformed(self, M: ArrayLike) -> EllipsoidNDF: ...  # type: ignore[override]
    def sheared(self, slope_x: float, slope_y: float) -> EllipsoidNDF: ...  # type: ignore[override]

class NonCentredDistribution(Distribution):
    @property
    def base(self) -> Distribution: ...
    @property
    def offset(self) -> tuple[float, float]: ...
    def mesosurface_area(self, v: ArrayLike) -> _Floats: ...
    def mesosurface_G1(self, v: ArrayLike) -> _Floats: ...
    def sheared(self, slope_x: float, slope_y: float) -> NonCentredDistribution: ...

class GGX(Distribution):
    def __init__(self, alpha_x: float, alpha_y: float | None = None) -> None: ...
    @property
    def alpha_x(self) -> float: ...
    @property
    def alpha_y(self) -> float: ...

MdfParameter = Literal[
    "beckmann_alpha",
    "gauss_m",
    "ggx_alpha",
    "blender_roughness",
    "gtr_alpha",
    "phong_exponent",
    "ashikhmin_shirley_n",
    "schlick_m",
    "sawicki_n",
]

def unit_mdf(
    parameter: MdfParameter, value: float, beta: ArrayLike, gamma: float = 2.0
) -> _Floats: ...

class Tabulated(Distribution):
    @overload
    def __init__(self, p22_or_r: Callable[[NDArray[np.float64]], NDArray[np.float64]]) -> None: ...
    @overload
    def __init__(self, p22_or_r: ArrayLike, p22: ArrayLike) -> None: ...

MaskingModel = Literal[
    "separable",
    "height_correlated",
    "direction_correlated",
    "height_direction_correlated",
    "v_cavity",
    "implicit",
    "schlick_smith",
    "kelemen",
]
MASKING_MODELS: tuple[MaskingModel, ...]

def fresnel_dielectric(cosine: ArrayLike, eta: ArrayLike) -> _Floats: ...
def fresnel_conductor(cosine: ArrayLike, eta: ArrayLike, k: ArrayLike) -> _Floats: ...
def fresnel_schlick(cosine: ArrayLike, f0: ArrayLike) -> _Floats: ...
def fresnel_f82(cosine: ArrayLike, f0: ArrayLike, tint: ArrayLike) -> _Floats: ...
def G1(
    d: Distribution, v: ArrayLike, m: ArrayLike, model: MaskingModel = "height_correlated"
) -> _Floats: ...
def G2(
    d: Distribution,
    wi: ArrayLike,
    wo: ArrayLike,
    m: ArrayLike | None = None,
    model: MaskingModel = "height_correlated",
) -> _Floats: ...
def v_cavity_pdf_visible(d: Distribution, v: ArrayLike, m: ArrayLike) -> _Floats: ...
def v_cavity_sample_visible(d: Distribution, v: ArrayLike, u: ArrayLike) -> _Floats: ...
def brdf(
    d: Distribution,
    wi: ArrayLike,
    wo: ArrayLike,
    fresnel: ArrayLike | Callable[[_Floats], ArrayLike] | None = None,
    model: MaskingModel = "height_correlated",
) -> _Floats: ...
def btdf(
    d: Distribution,
    wi: ArrayLike,
    wo: ArrayLike,
    eta: float,
    model: MaskingModel = "height_correlated",
) -> _Floats: ...

class GTR(Distribution):
    def __init__(
        self, alpha: float, gamma: float, masking: Literal["exact", "spline"] = "exact"
    ) -> None: ...
    @property
    def alpha(self) -> float: ...
    @property
    def gamma(self) -> float: ...
    @property
    def masking(self) -> str: ...

MdfMethod = Literal["rmse", "half_angle", "closed_form", "ward"]

@overload
def convert(
    value: float,
    source: MdfParameter,
    target: MdfParameter,
    method: MdfMethod = "rmse",
    gamma: float = 2.0,
) -> float: ...
@overload
def convert(
    value: ArrayLike,
    source: MdfParameter,
    target: MdfParameter,
    method: MdfMethod = "rmse",
    gamma: float = 2.0,
) -> _Floats: ...
def fit_mdf(
    value: float,
    source: MdfParameter,
    target: MdfParameter,
    largest_angle: float,
    gamma: float = 2.0,
) -> tuple[float, float]: ...
def smith_lambda(slopes: Callable[[float], float], cotangent: ArrayLike) -> NDArray[np.float64]: ...
def smith_lambda_of_shape(shape: Callable[[float], float], a: ArrayLike) -> NDArray[np.float64]: ...
def shape_integral(shape: Callable[[float], float]) -> float: ...

Heights = Literal["uniform", "gaussian"]

def G1_at_height(
    d: Distribution, v: ArrayLike, m: ArrayLike, h: ArrayLike, heights: Heights = "gaussian"
) -> _Floats: ...
def G2_at_height(
    d: Distribution,
    wi: ArrayLike,
    wo: ArrayLike,
    m: ArrayLike,
    h: ArrayLike,
    heights: Heights = "gaussian",
) -> _Floats: ...
def diffuse_brdf(
    d: Distribution,
    wi: ArrayLike,
    wo: ArrayLike,
    model: MaskingModel = "height_correlated",
    points: int = 32,
) -> _Floats: ...
def diffuse_weak_furnace(
    d: Distribution,
    wi: ArrayLike,
    wo: ArrayLike,
    model: MaskingModel = "height_correlated",
    points: int = 32,
) -> _Floats: ...
def single_scattering_albedo(
    d: Distribution, wo: ArrayLike, model: MaskingModel = "height_correlated", points: int = 32
) -> _Floats: ...
def average_visible_fresnel(
    d: Distribution, wo: ArrayLike, fresnel: Callable[[_Floats], ArrayLike], points: int = 32
) -> _Floats: ...

class MultipleScattering:
    def __init__(
        self, d: Distribution, model: MaskingModel = "height_correlated", points: int = 32
    ) -> None: ...
    @property
    def mean_energy(self) -> float: ...
    def energy(self, w: ArrayLike) -> _Floats: ...
    def brdf(self, wi: ArrayLike, wo: ArrayLike) -> _Floats: ...
