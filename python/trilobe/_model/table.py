"""Arrays that know what their axes stand for."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray


class Table(np.ndarray):
    """A numpy array with named axes, as the tables of a model are.

    Attributes:
        dims: a name for each axis: "lobe", "channel", "theta_h", "phi_h", "theta_d", "theta", "phi".
        coords: where the entries stand along an axis: angles in radians, channels by their names.

    Arithmetic keeps both where the shape stays as it is; what has another shape has neither.
    """

    dims: tuple[str, ...]
    coords: dict[str, Any]
    rules: dict[str, Any]

    def __new__(
        cls,
        values: ArrayLike,
        dims: tuple[str, ...] = (),
        coords: Mapping[str, Any] | None = None,
        rules: Mapping[str, Any] | None = None,
    ) -> Table:
        """A view of the values, which are not copied where they are an array already."""
        table = np.asarray(values, np.float64).view(cls)
        table.dims = dims
        table.coords = dict(coords or {})
        table.rules = dict(rules or {})
        return table

    def __array_finalize__(self, of: NDArray[Any] | None) -> None:
        """Keeps the names in results of the same shape."""
        same = isinstance(of, Table) and of.shape == self.shape
        self.dims = getattr(of, "dims", ()) if same else ()
        self.coords = getattr(of, "coords", {}) if same else {}
        self.rules = getattr(of, "rules", {}) if same else {}

    def __reduce__(self) -> Any:
        """Pickles the names, too."""
        return Table, (np.asarray(self), self.dims, self.coords, self.rules)

    def to_xarray(self) -> Any:
        """The same as an ``xarray.DataArray``, if xarray is installed."""
        import xarray

        return xarray.DataArray(np.asarray(self), dims=self.dims, coords=self.coords)
