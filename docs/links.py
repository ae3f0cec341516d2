"""Preprocessor of the site: a link that leaves `docs/` leads nowhere there, so its text names the file of the clone instead."""

import json
import re
import sys

# [text](../reports/README.md#part), from the top folder of the documents or from one below.
OUTWARD = re.compile(r"\[([^\]]*)\]\(((?:\.\./)+)([^)#]*)[^)]*\)")


def replaced(chapter):
    depth = chapter["path"].count("/")

    def plain(link):
        text, ups, file = link.groups()
        return f"{text} (`{file}`)" if ups.count("../") > depth else link.group(0)

    chapter["content"] = OUTWARD.sub(plain, chapter["content"])
    for item in chapter["sub_items"]:
        if "Chapter" in item:
            replaced(item["Chapter"])


if sys.argv[1:2] != ["supports"]:
    _, book = json.load(sys.stdin)
    for item in book.get("items", book.get("sections", [])):
        if "Chapter" in item:
            replaced(item["Chapter"])
    json.dump(book, sys.stdout)
