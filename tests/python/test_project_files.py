# SPDX-License-Identifier: Apache-2.0
"""What is written down twice says the same."""

import pathlib
import re
import tomllib

import ltmd

ROOT = pathlib.Path(__file__).resolve().parents[2]


def text(path):
    return (ROOT / path).read_text()


def test_the_commit_hooks_use_the_versions_of_the_tests():
    pins = text("tests/requirements-tools.txt").splitlines()
    hooks = re.findall(r"\[([\w-]+==[\d.]+)\]", text(".pre-commit-config.yaml"))
    assert {hook.partition("==")[0] for hook in hooks} == {"clang-format", "ruff"}
    assert set(hooks) <= set(pins)


def test_the_changelog_begins_with_this_version():
    assert re.search(r"^## (\S+)", text("CHANGELOG.md"), re.MULTILINE)[1] == ltmd.__version__


def test_the_inner_namespace_goes_with_the_major_version():
    major = ltmd.__version__.partition(".")[0]
    for path in [*ROOT.glob("cpp/include/ltmd/*.h"), *ROOT.glob("cpp/src/*.[ch]*")]:
        for version in re.findall(r"namespace ltmd::inline v(\w+)", path.read_text()):
            assert version == major, path


def test_one_openexr_for_tests_and_wheels():
    def pin(path):
        content = text(path)
        return re.search(r"sha256=(\w{64})", content, re.I)[1], "3.5.3" in content

    assert pin(".github/openexr.sh") == pin("tests/environment.sh")


def test_wheels_are_built_for_the_pythons_of_the_blenders():
    wheels = tomllib.loads(text("pyproject.toml"))["tool"]["cibuildwheel"]
    assert wheels["build"] == ["cp311-*", "cp313-*"]
