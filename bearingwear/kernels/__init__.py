"""Compiled kernels: plain functions on floats, NamedTuples and float64 arrays, SI units, radians.

Kernels never raise and never check their input; that is done once, above, by the scene. Each
module imports `jit` from `bearingwear.kernels.decorators`, which keys numba's disk cache by a
hash of the sources.
"""
