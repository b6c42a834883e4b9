"""Equation discovery: what you know of a system and what was measured -> differential equations, with evidence.

>>> import numpy as np, sidc
>>> t = np.arange(0, 6, 0.1)
>>> result = sidc.Model("state x\\ndx ~ poly(x; 3)\\n").identify({"t": t, "x": 2 * np.exp(-0.5 * t)})
>>> result.passes
True
>>> [term.term for term in result.equations[0].terms]
['x']

`Model` is what you know, a table (a dict of arrays, a pandas, polars, pyarrow or dask frame) what you measured, and `Result` what was
found. `Identifier` offers the same through the interface of PySINDy and scikit-learn. Models use the language of the program `sidc`.
"""

from ._errors import Error
from ._identifier import Identifier
from ._model import Model, new, read
from ._result import Result
from ._right_side import Function
from ._runs import Run
from ._sidc import __version__

__all__ = ["Error", "Function", "Identifier", "Model", "Result", "Run", "__version__", "new", "read"]
