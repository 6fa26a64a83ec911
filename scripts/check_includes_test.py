#!/usr/bin/env python3
"""check_includes.py on small trees, each with one thing right or wrong."""

import pathlib
import tempfile
import unittest

import check_includes

CMAKE = """
groundscale_module(core LINK fmt::fmt)
groundscale_module(geometry DEPENDS core)
groundscale_module(io DEPENDS
                   geometry LINK opencv_core)  # over two lines
groundscale_module(plane DEPENDS geometry)
"""


def check(files, cmake=CMAKE):
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        (root / "CMakeLists.txt").write_text(cmake)
        for name, text in files.items():
            (root / name).parent.mkdir(parents=True, exist_ok=True)
            (root / name).write_text(text)
        return check_includes.check_tree(root)


class CheckIncludes(unittest.TestCase):
    def test_downwards_is_right_through_a_module_between(self):
        self.assertEqual(check({"src/groundscale/plane/a.hpp": '#include "groundscale/core/result.hpp"\n'}), [])

    def test_upwards_and_sideways_are_named_with_their_line(self):
        found = check({"src/groundscale/core/a.cpp": '\n#include "groundscale/geometry/so3.hpp"\n',
                       "src/groundscale/plane/a_test.cpp": '#include "groundscale/io/config.hpp"\n'})
        self.assertEqual(len(found), 2)
        self.assertIn("src/groundscale/core/a.cpp:2:", found[0])
        self.assertIn("plane must not see io", found[1])

    def test_third_parties_stay_in_their_modules_and_out_of_public_headers(self):
        opencv = "#include <opencv2/core.hpp>\n"
        self.assertEqual(check({"src/groundscale/io/a.cpp": opencv, "src/groundscale/io/a_internal.hpp": opencv}), [])
        self.assertEqual(len(check({"src/groundscale/io/a.hpp": opencv})), 1)
        self.assertEqual(len(check({"src/groundscale/geometry/a.cpp": opencv})), 1)
        self.assertEqual(len(check({"src/groundscale/io/a.cpp": "#include <pcl/point_types.h>\n".replace(".h", "")})), 1)

    def test_public_headers_see_the_standard_library_and_eigen(self):
        self.assertEqual(check({"src/groundscale/core/a.hpp": "#include <vector>\n#include <Eigen/Core>\n"}), [])
        self.assertEqual(len(check({"src/groundscale/core/a.hpp": "#include <unistd.h>\n"})), 1)

    def test_gtest_is_for_tests(self):
        gtest = "#include <gtest/gtest.h>\n"
        self.assertEqual(check({"src/groundscale/core/a_test.cpp": gtest, "tests/b_test.cpp": gtest}), [])
        self.assertEqual(len(check({"src/groundscale/core/a.cpp": gtest})), 1)

    def test_a_module_without_a_line_and_a_wrong_order_are_named(self):
        self.assertIn("no groundscale_module(road", check({"src/groundscale/road/a.cpp": ""})[0])
        self.assertIn("depends on b", check({}, "groundscale_module(a DEPENDS b)\ngroundscale_module(b)\n")[0])


if __name__ == "__main__":
    unittest.main()
