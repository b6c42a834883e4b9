"""The report as a page to keep or to look at."""

from __future__ import annotations

import os

HEIGHT = 720
"""Of the frame in a notebook, pixels: what a laptop's window shows."""


class Report:
    """One page of HTML without network access; as text it is the page."""

    def __init__(self, page: str) -> None:
        self._page = page

    def write(self, path: str | os.PathLike[str]) -> None:
        """Writes the page to a file."""
        with open(path, "w", encoding="utf-8", newline="\n") as file:
            file.write(self._page)

    def __str__(self) -> str:
        return self._page

    def __repr__(self) -> str:
        return f"<sidc.Report, {len(self._page)} characters>"

    def _repr_html_(self) -> str:
        import html

        # The page has styles and a script of its own, which must not reach the notebook.
        page = html.escape(self._page, quote=True)
        return f'<iframe srcdoc="{page}" style="width: 100%; height: {HEIGHT}px; border: 0"></iframe>'
