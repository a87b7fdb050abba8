"""What cells cost and what they are worth in the contact of a ball and a worn groove.

    python benchmarks/worn_contact.py [-o docs/figures/worn_contact.png]
    python benchmarks/worn_contact.py --judge     the same loads by tamaas (`pip install tamaas`)

Three profiles of wear: load over Hertz's, against 192 x 64 cells; time of a solve from the pressure
of a profile moved by 0.02 a, against conjugate gradients without preconditioner in plain NumPy on
the same cells, with dense influence (one BLAS call an iteration) and with NumPy's FFT.
"""

import argparse
import math
import sys
import time
from pathlib import Path

import numpy as np

from bearingwear.kernels.contact.hertz import elliptic_integrals
from bearingwear.kernels.worn.cells import contact_buffers
from bearingwear.kernels.worn.pressure import CLOSED_GAP, FULL_WIDTH, contact_cells, worn_pressure
from bearingwear.plotting.drawing import (
    frame,
    key,
    new_figure,
    save,
)
from bearingwear.results.words import percent_in_text

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))
from kernels.test_worn_contact import KAPPA, PROFILES  # noqa: E402

SIZES = [(32, 8), (48, 5), (48, 8), (48, 10), (64, 12), (96, 16), (192, 64)]
USED = (48, 10)  # of `model.accuracy: standard`
MOVED = 0.02
SHAPES = {"flat": "one groove, centred", "skew": "one groove, off centre", "two": "two grooves"}
MOST_TIMED = 2000  # cells; more are only the judge of the others


def dense_influence(cells):
    """Displacements (m n, m n) by unit pressures."""
    m, n = cells.gap.shape
    along = n - 1 - np.arange(n)[None, :] + np.arange(n)[:, None]  # out, source
    blocks = cells.influence[:, :, along]  # (m, m, n, n)
    return blocks.transpose(0, 2, 1, 3).reshape(m * n, m * n)


def fft_displacement(cells):
    """The displacement of a pressure by NumPy's FFT over the whole contact."""
    m, n = cells.gap.shape
    kernel = np.zeros((4 * m, 2 * n))
    single = single_influence(cells)
    for j in range(-2 * m + 1, 2 * m):
        kernel[j % (4 * m), :n] = single[abs(j)]
        kernel[j % (4 * m), n + 1 :] = single[abs(j), 1:][::-1]
    transform = np.fft.rfft2(kernel)

    def displacement(pressure):
        padded = np.zeros((4 * m, 2 * n))
        padded[:m, :n] = pressure[::-1]
        padded[m : 2 * m, :n] = pressure
        return np.fft.irfft2(np.fft.rfft2(padded) * transform, s=padded.shape)[m : 2 * m, :n]

    return displacement


def single_influence(cells):
    """Displacement of a cell by another (2 m, n), by their distance in cells."""
    m, n = cells.gap.shape
    kappa = math.exp(cells.log_kappa)
    K = elliptic_integrals(1.0 / kappa)[0]
    c, d = 0.5 * (cells.X[1] - cells.X[0]), cells.Y[0] / kappa
    x, y = 2.0 * c * np.arange(n)[None, :], 2.0 * d * np.arange(2 * m)[:, None]

    def corner(x, y):
        with np.errstate(divide="ignore"):
            return x * np.arcsinh(y / np.abs(x)) + y * np.arcsinh(x / np.abs(y))

    return (
        kappa
        / (math.pi * K)
        * (
            corner(x + c, y + d)
            - corner(x + c, y - d)
            - corner(x - c, y + d)
            + corner(x - c, y - d)
        )
    )


def plain_pressure(cells, wear, pressure, displacement):
    """`worn_pressure` in plain NumPy, without preconditioner."""
    own = np.array([cells.influence[j, j, cells.X.size - 1] for j in range(cells.Y.size)])[:, None]
    unloaded = cells.gap + wear
    while True:
        g = unloaded + displacement(pressure)
        t, before = np.zeros_like(g), math.inf
        while True:
            loaded = pressure > 0.0
            left = np.where(loaded, g, 0.0)
            size = (left * left).sum()
            if size <= CLOSED_GAP**2:
                break
            t = np.where(loaded, g + size / before * t, 0.0)
            before = size
            r = displacement(t)
            step = size / (r * t).sum()
            g = g - step * r
            pressure = pressure - step * t
            if pressure.min() < 0.0:
                pressure = np.maximum(pressure, 0.0)
                break
        if size > CLOSED_GAP**2:
            continue
        g = unloaded + displacement(pressure)
        overlap = (pressure == 0.0) & (g < -CLOSED_GAP)
        if not overlap.any():
            return pressure
        pressure = np.where(overlap, -g / own, pressure)


def best(work, seconds=0.5):
    """Shortest time of a call [s]."""
    shortest, end = math.inf, time.perf_counter() + seconds
    while time.perf_counter() < end:
        start = time.perf_counter()
        work()
        shortest = min(shortest, time.perf_counter() - start)
    return shortest


def times(cells, work, near, wear, pressure):
    """Of a solve [s]: compiled, in NumPy with dense influence and by FFT."""
    dense, fft = dense_influence(cells), fft_displacement(cells)

    def compiled():
        pressure[:] = near
        worn_pressure(cells, wear, work, pressure)

    def plain(displacement):
        return plain_pressure(cells, wear, near, displacement)

    def by_dense(p):
        return (dense @ p.ravel()).reshape(p.shape)

    for displacement in (by_dense, fft):
        assert abs(plain(displacement).sum() / pressure.sum() - 1.0) < 1e-8
    return [best(compiled), best(lambda: plain(by_dense)), best(lambda: plain(fft))]


def rows():
    """Cells, loads over Hertz's of the profiles, times [s] of each as `times` has them."""
    for n, m in SIZES:
        _, cells = contact_cells(math.log(KAPPA), -1.9, 1.9, FULL_WIDTH, n, m)
        work, loads, taken = contact_buffers(n, m), [], []
        for profile in PROFILES.values():
            near, pressure = cells.fresh.copy(), cells.fresh.copy()
            worn_pressure(cells, profile(cells.X - MOVED), work, near)
            worn_pressure(cells, profile(cells.X), work, pressure)
            loads.append(pressure.sum() / cells.fresh.sum())
            if n * m <= MOST_TIMED:
                taken.append(times(cells, work, near, profile(cells.X), pressure))
        yield n, m, np.array(loads), np.array(taken).reshape(-1, 3)


def figure(found, path):
    drawn, ((pressures, worn, errors),) = new_figure(1, 3, 7.2, 2.9)
    _, cells = contact_cells(math.log(KAPPA), -1.9, 1.9, FULL_WIDTH, 96, 16)
    sizes = [n * m for n, m, *_ in found[:-1]]
    colours = dict(zip(PROFILES, ("C2", "C3", "C4"), strict=True))
    for k, (name, profile) in enumerate(PROFILES.items()):
        wear, pressure = profile(cells.X), cells.fresh.copy()
        worn_pressure(cells, wear, contact_buffers(96, 16), pressure)
        pressures.plot(cells.X, pressure[0], color=colours[name])
        worn.plot(cells.X, -wear, color=colours[name])
        off = [abs(loads[k] / found[-1][2][k] - 1.0) for _, _, loads, _ in found[:-1]]
        errors.loglog(sizes, off, "o", color=colours[name])
    pressures.plot(cells.X, cells.fresh[0], color="0.6")
    pressures.set(xlabel="x/a", ylabel="pressure / Hertz's maximum")
    worn.set(xlabel="x/a", ylabel="worn profile / approach")
    errors.set(xlabel="cells in half of the contact", ylabel="relative error of the load")
    errors.set_xticks([250, 500, 1000], ["250", "500", "1000"], minor=False)
    errors.set_xticks([], minor=True)
    errors.set_yticks([1e-5, 1e-4, 1e-3], ["10⁻⁵", "10⁻⁴", "10⁻³"])
    handles = [key(SHAPES[name], color=colour) for name, colour in colours.items()]
    worst = max(abs(loads / found[-1][2] - 1.0).max() for n, m, loads, _ in found if (n, m) == USED)
    cells_used = " by ".join(map(str, USED))
    said = f"With {cells_used} cells the error of a worn contact's load is {percent_in_text(worst)}"
    frame(drawn, said, [*handles, key("unworn", color="0.6")], columns=4)
    save(drawn, [path])


def judge():
    """Loads and centres of the profiles by tamaas."""
    import tamaas as tm

    tm.set_log_level(tm.LogLevel.error)
    K, _, s = elliptic_integrals(1.0 / KAPPA)
    for n in (128, 256):
        L, N = [3.8, 3.0 / KAPPA], [n, n // 2]
        model = tm.ModelFactory.createModel(tm.model_type.basic_2d, L, N)
        model.E, model.nu = 1.0, 0.0
        tm.ModelFactory.registerNonPeriodic(model, "dcfft")
        x, y = ((np.arange(k) + 0.5) / k * size - size / 2 for k, size in zip(N, L, strict=True))
        for name, profile in PROFILES.items():
            gap = s * x[:, None] ** 2 + (1.0 - s) * (KAPPA * y) ** 2 + profile(x)[:, None]
            kind = tm.PolonskyKeerRey.pressure
            solver = tm.PolonskyKeerRey(model, -gap, 1e-11, kind, kind)
            solver.setIntegralOperator("dcfft")

            def approach(load, model=model, solver=solver, gap=gap, L=L):
                solver.solve(load / (L[0] * L[1]))
                moved = np.zeros_like(model.traction)
                model.operators["dcfft"](model.traction.copy(), moved)
                return (moved + gap)[model.traction > 0.0].mean()

            hertz = 2.0 / 3.0 * math.pi / K  # load at the approach 1, for E* = 1 and a = 1
            a, b = 0.97 * hertz, 1.02 * hertz
            f_a, f_b = approach(a) - 1.0, approach(b) - 1.0
            while abs(f_b) > 1e-9:
                a, b, f_a = b, b - f_b * (b - a) / (f_b - f_a), f_b
                f_b = approach(b) - 1.0
            p = model.traction
            centre = (p * x[:, None]).sum() / p.sum()
            print(f"{N[0]:4d} x {N[1]:3d} {name:5s} {b / hertz:.6f} {centre:9.6f}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-o", type=Path, help="write a figure")
    parser.add_argument("--judge", action="store_true")
    chosen = parser.parse_args()
    if chosen.judge:
        return judge()
    found = list(rows())
    exact = found[-1][2]
    print("cells     error of the load, three profiles   solve ms   dense NumPy   FFT NumPy")
    for n, m, loads, taken in found:
        errors = "  ".join(f"{e:9.1e}" for e in loads / exact - 1.0)
        t = taken.mean(axis=0) if taken.size else np.full(3, np.nan)
        print(
            f"{n:3d} x {m:2d}   {errors}   {1e3 * t[0]:7.3f}   x {t[1] / t[0]:5.1f}"
            f"       x {t[2] / t[0]:5.1f}"
        )
    if chosen.o:
        figure(found, chosen.o)


if __name__ == "__main__":
    main()
