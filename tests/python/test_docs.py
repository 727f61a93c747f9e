"""The Python in README.md and docs/python.md runs, and the README's is ten lines."""

import os
import re
import unittest

from limn_test import TestCase

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))


def blocks(page):
    with open(os.path.join(ROOT, page), encoding="utf-8") as file:
        return re.findall(r"```python\n(.*?)```", file.read(), re.DOTALL)


class Pages(TestCase):
    def test_what_they_show_runs(self):
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(self.folder)
        for page in ("README.md", "docs/python.md"):
            shown = blocks(page)
            self.assertTrue(shown, page)
            for block in shown:
                exec(compile(block, page, "exec"), {})  # pylint: disable=exec-used
        self.assertTrue(os.path.exists("cup.svg"))

    def test_the_readmes_is_ten_lines(self):
        self.assertLessEqual(len([line for line in blocks("README.md")[0].splitlines() if line.strip()]), 10)


if __name__ == "__main__":
    unittest.main()
