"""A view of the contents of a result that reads like an open file (`netCDF4.Dataset`).

A sheet of a result that is not in a file reads its numbers from such a view.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from bearingwear.results.entries import Contents, Entry


class _Dimension(NamedTuple):
    """A dimension of a file."""

    size: int


class _VariableView:
    """A variable of a result: its data by index, its netCDF attributes by name."""

    def __init__(self, entry: Entry, data: np.ndarray) -> None:
        self._attributes, self._data = entry.attrs, data
        self.dimensions, self.dtype, self.ndim = entry.dims, data.dtype, data.ndim

    def __getattr__(self, name: str) -> Any:
        """Returns a netCDF attribute, as `netCDF4.Variable` does."""
        return _attribute(self._attributes, name)

    def __getitem__(self, index: Any) -> Any:
        """Returns the data at an index, as of a NumPy array."""
        return self._data[index]

    def ncattrs(self) -> list[str]:
        """Returns the names of the attributes."""
        return list(self._attributes)


class ContentsView:
    """The contents of a result: variables and dimensions by name, attributes as fields."""

    def __init__(self, contents: Contents) -> None:
        self._attributes = contents.attrs
        self.dimensions = {name: _Dimension(size) for name, size in contents.layout.sizes.items()}
        self.variables = {
            name: _VariableView(entry, contents.data[name])
            for name, entry in contents.layout.entries.items()
        }

    def __getattr__(self, name: str) -> Any:
        """Returns a global attribute, as `netCDF4.Dataset` does."""
        return _attribute(self._attributes, name)

    def __getitem__(self, name: str) -> _VariableView:
        """Returns a variable by name."""
        return self.variables[name]

    def ncattrs(self) -> list[str]:
        """Returns the names of the global attributes."""
        return list(self._attributes)

    def getncattr(self, name: str) -> Any:
        """Returns a global attribute."""
        return self._attributes[name]


def _attribute(attributes: dict[str, Any], name: str) -> Any:
    """Returns an attribute by name. AttributeError: there is none, as for any object."""
    if name not in attributes:
        raise AttributeError(name)
    return attributes[name]
