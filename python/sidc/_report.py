"""The report as a page to save or display."""

from __future__ import annotations

import os

HEIGHT = 720
"""Height of the frame in a notebook, pixels: what fits a laptop's screen."""


class Report:
    """One page of HTML without network access; str() gives its text."""

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

        # The page has its own styles and script, which must not affect the notebook.
        page = html.escape(self._page, quote=True)
        return f'<iframe srcdoc="{page}" style="width: 100%; height: {HEIGHT}px; border: 0"></iframe>'
