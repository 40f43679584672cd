"""The long description of the package: the README, whose links lead to this version in the repository."""

import re
import tomllib
from pathlib import Path

from setuptools import setup

HERE = Path(__file__).parent


def long_description() -> str:
    """The README with absolute links; pictures as what they are, not as pages about them."""
    urls = tomllib.loads((HERE / "pyproject.toml").read_text("utf-8"))["project"]["urls"]
    version = re.search(r'"(.+)"', (HERE / "rigtri" / "_version.py").read_text("utf-8").partition("=")[2])
    assert version
    blob, raw = (f"{urls['Repository']}/{kind}/v{version[1]}" for kind in ("blob", "raw"))
    text = (HERE / "README.md").read_text("utf-8")
    text = re.sub(r"(!\[[^]]*\]\()(?!https?:|#)", rf"\g<1>{raw}/", text)
    return re.sub(r"((?<!!)\[[^]]*\]\()(?!https?:|#)", rf"\g<1>{blob}/", text)


setup(long_description=long_description(), long_description_content_type="text/markdown")
