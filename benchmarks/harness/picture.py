"""Pictures, and what sets one apart from a reference.

relMSE = mean over pixels and channels of (I - R)^2 / (R^2 + 0.01), as `tyndall diff` has it. The standard error of the
mean difference is that of its pixels, which are independent without a filter.
"""

import numpy as np


def read(path):
    """Height x width x 3 of f64, from an .exr or .npy."""
    if str(path).endswith(".npy"):
        return np.load(path)[..., :3].astype(np.float64)
    import OpenEXR

    with OpenEXR.File(str(path)) as file:
        channels = file.channels()
        for name in ("RGB", "RGBA"):
            if name in channels:
                return channels[name].pixels[..., :3].astype(np.float64)
        return np.stack([channels[name].pixels for name in "RGB"], -1).astype(np.float64)


def compare(picture, reference):
    """A dictionary for the record. What is not finite counts as black, and is counted."""
    finite = np.isfinite(picture).all(-1)
    difference = np.where(finite[..., None], picture, 0.0) - reference
    error = (difference**2 / (reference**2 + 0.01)).mean(-1).ravel()
    flat = difference.reshape(-1, 3)
    # The worst 0.1 % of the pixels left out: what fireflies do not decide.
    kept = np.sort(error)[: error.size - -(-error.size // 1000)]
    return {
        "relmse": float(error.mean()),
        "relmse_trimmed": float(kept.mean()),
        "mean": [float(value) for value in picture[finite].mean(0)],
        "mean_difference": [float(value) for value in flat.mean(0)],
        "standard_error": [float(value) for value in flat.std(0, ddof=1) / np.sqrt(len(flat))],
        "reference_mean": [float(value) for value in reference.reshape(-1, 3).mean(0)],
        "non_finite": int((~finite).sum()),
        "negative": int((picture < 0.0).any(-1).sum()),
    }
