"""How well a cage's wear is reproduced: `python benchmarks/cage_maps.py MAP MAP ...`.

Maps are `results/cage/cage.nc` of the study of cages, run at tolerances of their own: what
`set: {model.dynamic_tolerance: ...}` in config/cage.yaml says. Cages that all have are compared.
One motion exists where all starts of all maps end in the same, and have it in each of the evaluated
stretches. Wear is the volume of cage that pockets and land take, mean over the evaluated turns.
"""

import itertools
import json
import sys

import numpy as np
import xarray as xr

EVALUATED = 5  # stretches at the end, as in config/cage.yaml


def tolerance(found: xr.Dataset) -> str:
    """Of the steps of a map."""
    return f"{json.loads(found.attrs['scene'])['model']['dynamic_tolerance']:g}"


def main() -> None:
    """A row for each cage, then the largest deviation where there is one motion."""
    maps = [xr.load_dataset(path) for path in sys.argv[1:]]
    shared = xr.align(*maps, join="inner", exclude=("start", "stretch", "across"))
    together = xr.concat(shared, dim="map", combine_attrs="override")
    wear = together["cage_wear_rate"] + together["cage_land_wear_rate"]
    names = together["motion"].attrs["flag_meanings"].split()
    print("deviation: the largest from the mean of all starts and maps, where there is one motion")
    heads = " | ".join(f"wear at {tolerance(found)}" for found in maps)
    print(f"| gravity | pockets, land (mm) | friction | motion | {heads} | deviation |")
    print(f"| ---: | --- | ---: | --- |{' --- |' * len(maps)} ---: |")
    axes = ("gravity", "pocket_clearance", "guide_clearance", "cage_friction")
    every, alone_off = list(itertools.product(*(together[axis].values for axis in axes))), []
    for places in every:
        at = dict(zip(axes, places, strict=True))
        rates = wear.sel(at).values * 3.6e15  # mm3 in 1000 h
        last = together["motions"].sel(at).values[..., -EVALUATED:]
        ended = sorted({names[int(code)] for code in last[..., -1].ravel()})
        alone = bool((last == last.ravel()[0]).all())
        off = np.abs(rates / rates.mean() - 1.0).max()
        if alone:
            alone_off.append(off)
        room = f"{1e3 * at['pocket_clearance']:.3g}, {1e3 * at['guide_clearance']:.3g}"
        row = [f"{at['gravity']:g}", room, f"{at['cage_friction']:g}"]
        row += [", ".join(ended).replace("_", " ") + ("" if alone else ", or not yet")]
        row += [f"{one.min():.3g} to {one.max():.3g}" for one in rates]
        print(f"| {' | '.join(row)} | {f'{100.0 * off:.1f} %' if alone else ''} |")
    worst = 100.0 * max(alone_off)
    print(f"{len(alone_off)} of {len(every)} cages have one motion; deviation {worst:.1f} %")


if __name__ == "__main__":
    main()
