"""The examples in the documentation run in order, and print the output shown below them."""

from __future__ import annotations

import contextlib
import io
import re
import warnings
from pathlib import Path

import pytest

BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


@pytest.mark.parametrize("page", ["python.md", "pysindy.md", "scale.md"])
def test_examples_print_what_is_shown(page: str, root: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    if page == "pysindy.md":
        pytest.importorskip("pysindy")
    blocks = BLOCK.findall((root / "docs" / page).read_text(encoding="utf-8"))
    assert len(blocks) > 5
    # The pages write files.
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    printed, shown = "", ""
    for language, text in blocks:
        if language == "text":
            shown += text
            assert comparable(printed) == comparable(shown)
            continue
        assert language == "python"
        said = io.StringIO()
        with contextlib.redirect_stdout(said), warnings.catch_warnings():
            # PySINDy warns about its own dependencies.
            warnings.simplefilter("ignore")
            exec(compile(text, page, "exec"), names)
        printed, shown = said.getvalue(), ""
        assert printed == "" or followed_by_text(blocks, text), f"{page} does not show: {printed}"


def comparable(text: str) -> str:
    """Hides errors on exact data, which are rounding and differ between processors."""
    return re.sub(r"\b(below|linear) [-+.\de]+\d", r"\1 #", text)


def followed_by_text(blocks: list[tuple[str, str]], text: str) -> bool:
    place = [block for _, block in blocks].index(text)
    return place + 1 < len(blocks) and blocks[place + 1][0] == "text"
