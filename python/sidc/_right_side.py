"""The equations as a function, for other integrators."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Union

from . import _sidc

if TYPE_CHECKING:
    from numpy import float64
    from numpy.typing import ArrayLike, NDArray

    Inputs = Union[ArrayLike, Callable[[float], ArrayLike]]


class Function:
    """dy/dt = f(t, y[, u]); in discrete time the next y. Compiled, for `scipy.integrate.solve_ivp`:

        f = result.function()
        solve_ivp(f, (0, 10), y0, jac=f.jacobian, args=(u,))

    `y` has shape (n,), or (n, k) for k points, and so has the result. `u` has shape (m,) or (m, k), or is a function of time that
    returns it. Arrays are taken as delayed already; a function of time is evaluated with the model's delay of each input. NaN
    marks a point where the equations have no value.
    """

    def __init__(self, found: _sidc.Discovery) -> None:
        self._found = found
        self._native = found.right_side()
        self._delays = self._native.input_delays

    @property
    def states(self) -> list[str]:
        """The names of the n components of y."""
        return self._native.states

    @property
    def inputs(self) -> list[str]:
        """The names of the m components of u: inputs, parameters and lagged samples that the equations mention."""
        return self._native.inputs

    def __call__(self, t: float | ArrayLike, y: ArrayLike, u: Inputs | None = None) -> NDArray[float64]:
        """f at y, in the shape of y."""
        return self._native.rates(*self._arguments(t, y, u))

    def jacobian(self, t: float | ArrayLike, y: ArrayLike, u: Inputs | None = None) -> NDArray[float64]:
        """The derivatives of f by y: (n, n), or (k, n, n) for k points."""
        return self._native.jacobian(*self._arguments(t, y, u))

    def __repr__(self) -> str:
        given = f", [{', '.join(self.inputs)}]" if self.inputs else ""
        return f"<sidc.Function f(t, [{', '.join(self.states)}]{given})>"

    def __reduce__(self) -> tuple[Any, tuple[str]]:
        return _of_document, (self._found.to_json(),)

    def _arguments(self, t: Any, y: Any, u: Any) -> tuple[Any, Any, Any]:
        import numpy as np

        given = self._acting(u, t) if callable(u) else u
        if given is not None:
            given = np.require(given, np.float64, "A")
            given = given if given.ndim else given[None]
        time = t if isinstance(t, (float, int)) else np.require(t, np.float64, "A")
        return time, np.require(y, np.float64, "A"), given

    def _acting(self, u: Callable[[float], ArrayLike], t: Any) -> ArrayLike:
        """The delayed inputs at a time."""
        if not any(self._delays):
            return u(t)
        import numpy as np

        return np.array([np.atleast_1d(u(t - delay))[place] for place, delay in enumerate(self._delays)])


def _of_document(text: str) -> Function:
    """Restores the function from a result document in another process."""
    return Function(_sidc.Discovery.from_json(text))
