"""The kernels as a project of `kerneljit`: where their machine code lies. Does not import numba."""

from bearingwear.provenance import IN_CHECKOUT, PACKAGE, kernels_hash
from kerneljit.project import Project

PROJECT = Project(
    name="bearingwear", folder=PACKAGE, kernels_hash=kernels_hash, in_checkout=IN_CHECKOUT
)
