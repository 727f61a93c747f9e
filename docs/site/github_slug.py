"""Anchors of headings as GitHub names them, so that links work there and in the site."""
import re


def slugify(value, separator):
    return re.sub(r"\s", separator, re.sub(r"[^\w\s-]", "", value).strip().lower())
