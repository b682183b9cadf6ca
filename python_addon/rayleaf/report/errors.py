"""How far a picture is from a reference. Pictures are (height, width, 3 or 4), scene-linear, rows in either order."""

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np


@dataclass(frozen=True)
class PictureError:
    """Of one picture against its reference, in display terms: channels are clipped to [0, 1] first."""

    mean_rgb: float  # mean Euclidean distance of RGB, at most sqrt(3): the measure of Atalay & Mount, section 3.2
    rmse: float  # root of the mean square over pixels and channels
    p99: float  # 99th percentile of the RGB distance over pixels
    maximum: float  # largest RGB distance
    ssim: float | None  # structural similarity of the sRGB-encoded pictures, 1 is equal; None without scikit-image

    def as_dict(self) -> dict[str, float | None]:
        return asdict(self)


def to_srgb(linear: Any) -> Any:
    """sRGB's transfer function (IEC 61966-2-1) of values in [0, 1]."""
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * np.power(linear, 1 / 2.4) - 0.055)


def displayed(picture: Any) -> Any:
    """RGB clipped to what a screen shows, in double precision. NaN raises: no picture may hold any."""
    rgb = np.asarray(picture, dtype=np.float64)[..., :3]
    if np.isnan(rgb).any():
        raise ValueError("a picture holds NaN")
    return np.clip(rgb, 0.0, 1.0)


def _ssim(picture: Any, reference: Any) -> float | None:
    try:
        from skimage.metrics import structural_similarity
    except ImportError:
        return None
    if min(picture.shape[:2]) < 7:  # the width of its window
        return None
    return float(structural_similarity(to_srgb(picture), to_srgb(reference), channel_axis=-1, data_range=1.0))


def compare(picture: Any, reference: Any) -> PictureError:
    """Raises ValueError where the shapes differ or a picture holds NaN."""
    a, b = displayed(picture), displayed(reference)
    if a.shape != b.shape:
        raise ValueError(f"pictures of different shapes: {a.shape} and {b.shape}")
    distance = np.linalg.norm(a - b, axis=-1)
    return PictureError(
        mean_rgb=float(distance.mean()),
        rmse=float(np.sqrt(np.mean((a - b) ** 2))),
        p99=float(np.quantile(distance, 0.99)),
        maximum=float(distance.max()),
        ssim=_ssim(a, b),
    )


def silhouette_error(alpha: Any, reference: Any) -> float:
    """Mean distance in pixels between the outlines of two coverage masks (height, width), values in [0, 1].

    The area that differs over the length of the reference's outline, which is the total variation of its coverage.
    """
    mask, exact = np.asarray(alpha, dtype=np.float64), np.asarray(reference, dtype=np.float64)
    if mask.shape != exact.shape:
        raise ValueError(f"masks of different shapes: {mask.shape} and {exact.shape}")
    across, up = np.diff(exact, axis=1)[:-1, :], np.diff(exact, axis=0)[:, :-1]
    outline = float(np.hypot(across, up).sum())
    if outline == 0.0:
        raise ValueError("the reference has no outline")
    return float(np.abs(mask - exact).sum() / outline)
