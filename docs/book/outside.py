"""Preprocessor of mdBook: brings pages that stand outside docs/ into the book.

In: the book as mdBook read it (JSON on standard input). Out: the same book, in which `../models/README.md` is the page `models/index`, and links between
pages lead to where the pages are. A link to a file that is no page becomes the path of the file, since the book holds no files of the project but
pictures. Never touches files.
"""

import json
import posixpath
import re
import sys

FENCE = re.compile(r"^ *```")
LINK = re.compile(r"(?P<image>!?)\[(?P<text>(?:[^\[\]]|\[[^\[\]]*\])*)\]\((?P<goal>[^()\s]+)\)")
DOCS = "docs"


def chapters(items):
    for item in items:
        if isinstance(item, dict) and "Chapter" in item:
            yield item["Chapter"]
            yield from chapters(item["Chapter"]["sub_items"])


def from_root(path, folder=DOCS):
    """A path relative to `folder`, relative to the root of the project."""
    return posixpath.normpath(posixpath.join(folder, path))


def in_book(path):
    """The path in the book of what stands at `path` in the project."""
    path = path.removeprefix(DOCS + "/").replace("SUMMARY.md", "README.md")
    return re.sub(r"README\.md$", "index.md", path)


def renewed(link, page, pages):
    goal = link["goal"]
    if "://" in goal or goal.startswith(("#", "mailto:")):
        return link[0]
    path, sign, heading = goal.partition("#")
    path = from_root(path, posixpath.dirname(page))
    if path in pages or path.startswith(DOCS + "/"):
        relative = posixpath.relpath(in_book(path), posixpath.dirname(in_book(page)) or ".")
        return f"{link['image']}[{link['text']}]({relative}{sign}{heading})"
    text = link["text"]
    return text if path in text or text.strip("`") in path else f"{text} (`{path}`)"


def rewritten(text, page, pages):
    lines, code = [], False
    for line in text.split("\n"):
        code ^= bool(FENCE.match(line))
        lines.append(line if code else LINK.sub(lambda link: renewed(link, page, pages), line))
    return "\n".join(lines)


def main():
    if sys.argv[1:2] == ["supports"]:
        return
    _, book = json.load(sys.stdin)
    found = [c for c in chapters(book.get("items", book.get("sections"))) if c["path"]]
    pages = {from_root(c["path"]) for c in found}
    for chapter in found:
        page = from_root(chapter["path"])
        chapter["content"] = rewritten(chapter["content"], page, pages)
        chapter["path"] = in_book(page)
    json.dump(book, sys.stdout)


main()
