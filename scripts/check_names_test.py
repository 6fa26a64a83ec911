#!/usr/bin/env python3
"""check_names.py on small trees."""

import pathlib
import tempfile
import unittest

import check_names


def check(first, second):
    """Of a type each, with the lines around it."""
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        for name, text in (("src/a.hpp", first), ("apps/b.cpp", second)):
            (root / name).parent.mkdir(parents=True)
            (root / name).write_text(text)
        return check_names.check_tree(root)


def inside(namespace, text):
    return f"namespace {namespace} {{\n{text}\n}}  // namespace {namespace}\n"


TYPE = "struct Plot {\n  int a;\n};"


class CheckNames(unittest.TestCase):
    def test_two_types_of_a_name_are_found(self):
        found = check(inside("groundscale", TYPE), inside("groundscale", "class Plot final : public Base {\n};"))
        self.assertEqual(found, ["apps/b.cpp:2: groundscale::Plot is defined in src/a.hpp:2 too"])

    def test_not_in_namespaces_of_their_own(self):
        self.assertEqual(check(inside("groundscale", TYPE), inside("groundscale::internal", TYPE)), [])
        self.assertEqual(check(inside("groundscale", TYPE), inside("groundscale", "namespace {\n" + TYPE + "\n}  // namespace")),
                         [])

    def test_declarations_and_members_are_none(self):
        self.assertEqual(check(inside("groundscale", TYPE), inside("groundscale", "struct Plot;  // there")), [])
        self.assertEqual(check(inside("groundscale", TYPE), inside("groundscale", "struct Other {\n  struct Plot {\n  };\n};")),
                         [])


if __name__ == "__main__":
    unittest.main()
