"""Statuses of scenes that have no verified answer, as the study of robustness counts them."""

from bearingwear.kernels.status import NOT_CONVERGED, UNVERIFIED

WITHOUT_REASON = (NOT_CONVERGED, UNVERIFIED)
"""Ends that give no physical reason."""

REFUSED = -1
"""Status of a draw that makes no bearing and is refused before any solve."""
