"""URLs as text, and what is behind them in a store that is the memory of this process."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from rigtri.errors import FileError, UsageError
from rigtri.pipeline.batch import urls

fsspec = pytest.importorskip("fsspec", reason="fsspec is not installed: pip install '.[test]'")


@pytest.fixture
def store() -> Iterator[Any]:
    found = fsspec.filesystem("memory")
    for name in ("in/a.glb", "in/b.usda", "in/.hidden.glb", "in/.git/c.glb", "in/sub/d.glb", "in/sub.glb/e"):
        found.pipe_file(f"/{name}", name.encode())
    yield found
    found.rm("/", recursive=True)


@pytest.mark.parametrize(
    ("pattern", "names"),
    [
        ("in/*.glb", "a.glb"),
        ("in/**/*.glb", "a.glb sub/d.glb"),
        ("in/sub*/*", "sub.glb/e sub/d.glb"),
        ("in/.git/*.glb", ".git/c.glb"),
        ("in/[ab].*", "a.glb b.usda"),
    ],
)
def test_a_pattern_matches_files_and_none_that_is_hidden_below_what_it_names(
    pattern: str, names: str, store: Any
) -> None:
    found = urls.glob(f"memory://{pattern}")
    assert sorted(found) == [f"memory:///in/{name}" for name in names.split()]


def test_a_pattern_without_files_is_reported(store: Any) -> None:
    with pytest.raises(UsageError, match="matches no file"):
        urls.glob("memory://in/*.fbx")


@pytest.mark.parametrize("url", ["http://[a/b.glb", "s3://[::1/*.glb", "https://a]/b.glb"])
def test_a_bracket_that_holds_no_address_is_named(url: str) -> None:
    with pytest.raises(UsageError, match=r"is no URL: \[ and \] in the name of a host are for"):
        urls.glob(url)


def test_a_file_is_written_whole_and_fetched_with_its_hash(store: Any, tmp_path: Path) -> None:
    place = tmp_path / "here" / "a.glb"
    assert urls.get("memory://in/a.glb", place) == ""
    assert place.read_bytes() == b"in/a.glb"
    urls.put(place, "memory://out/deep/a.glb")
    assert store.find("/out") == ["/out/deep/a.glb"]
    assert urls.content_hash("memory://out/deep/a.glb") == hashlib.sha256(b"in/a.glb").hexdigest()
    assert urls.content_hash("memory://out/b.glb") == ""
    assert urls.missing(["memory://in/a.glb", "memory://in/z.glb", "memory://in/sub"]) == [
        "memory://in/z.glb",
        "memory://in/sub",
    ]
    with pytest.raises(FileError, match=r"z\.glb"):
        urls.get("memory://in/z.glb", place)


def test_a_try_leaves_nothing_behind(store: Any) -> None:
    before = store.find("/")
    urls.try_writing("memory://in")
    assert store.find("/") == before


def test_urls_are_put_together_and_taken_apart() -> None:
    assert urls.host("s3://bucket/a/b.glb") == "s3://bucket"
    assert urls.parent("s3://bucket/a/b.glb") == "s3://bucket/a"
    assert urls.join("s3://bucket/a/", "b c.glb") == "s3://bucket/a/b c.glb"
    assert urls.join("https://server/a", "b c.glb") == "https://server/a/b%20c.glb"
    assert urls.common_folder(["s3://b/x/a.glb", "s3://b/x/y/c.glb", "s3://b/x/z/d.glb"]) == "s3://b/x"
    with pytest.raises(UsageError, match="several stores"):
        urls.common_folder(["s3://b/x/a.glb", "s3://c/x/a.glb"])
    for name, url in {"s3://b": True, "C:/a": False, "a/b": False, "http://x/y": True}.items():
        assert urls.is_url(name) is url
        assert urls.is_web(name) is name.startswith("http")


def test_secrets_of_urls_are_kept_apart_and_go_to_another_process(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(urls, "_users", {})
    monkeypatch.setattr(urls, "_queries", {})
    assert urls.without_secrets("HTTPS://me:word@server/a.glb?sig=1") == "https://server/a.glb"
    users, queries = {"https://server": "me:word"}, {"https://server/a.glb": "?sig=1"}
    assert urls.secrets() == (users, queries)
    urls.add_secrets(({"https://other": "you"}, {"https://other/b": "?q"}))
    assert urls.secrets() == (users | {"https://other": "you"}, queries | {"https://other/b": "?q"})


@pytest.mark.parametrize(
    ("tags", "found"), [(["etag:1", "etag:1"], "etag:1"), (["etag:1", "etag:2"], ""), (["", ""], "")]
)
def test_a_file_that_somebody_wrote_while_it_was_fetched_has_no_hash(
    tags: list[str], found: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    source = tmp_path / "in.bin"
    source.write_bytes(b"content")
    left = iter(tags)
    monkeypatch.setattr(urls, "etag", lambda url: next(left))
    assert urls.get(source.as_uri(), tmp_path / "below" / "out.bin") == found
    assert (tmp_path / "below" / "out.bin").read_bytes() == b"content"
