"""Files that are elsewhere, by their URLs: names without secrets, and what fsspec does with them.

User names, passwords and queries (which sign requests) are taken out of a URL where it comes in
(`without_secrets`), and put back in here alone: no manifest, log or message can have them.
"""

from __future__ import annotations

import hashlib
import posixpath
import re
import tempfile
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any
from urllib.parse import quote, urlsplit
from uuid import uuid4

from rigtri.errors import FileError, RigtriError, UsageError

_URL = re.compile(r"[A-Za-z][A-Za-z0-9+.-]+://")
_PARTS = re.compile(r"([a-z][a-z0-9+.-]+://)(?:([^/@]*)@)?([^?#]*)([?#].*)?", re.I | re.S)
_WEB = ("http://", "https://")
# Stores where an object appears whole or not at all. Elsewhere it is written under another name first.
_WHOLE = {"s3", "s3a", "gs", "gcs", "az", "abfs", "abfss", "oss"}
# What a hash that a store keeps begins with, in place of one of ours.
_ETAG = "etag "
_AT_ONCE = 32
Secrets = tuple[dict[str, str], dict[str, str]]
# Of this process: user and password by scheme and host, queries by URL.
_users: dict[str, str] = {}
_queries: dict[str, str] = {}


def is_url(name: object) -> bool:
    """Whether a name is a URL, and not a path."""
    return isinstance(name, str) and _URL.match(name) is not None


def is_web(url: str) -> bool:
    """Whether there are only single files behind a URL, to be read."""
    return url.lower().startswith(_WEB)


def without_secrets(url: str) -> str:
    """A URL as everybody may see it, in the one spelling that it has here. UsageError for no such store."""
    found = _PARTS.fullmatch(url)
    if found is None:
        raise UsageError(f"{url!r} is not a URL")
    scheme, user, rest, query = found[1].lower(), found[2], found[3], found[4] or ""
    if is_web(scheme):
        plain = scheme + rest
        if query:
            _queries[plain] = query
    else:
        store, path = _store(scheme + rest + query)
        plain = store.unstrip_protocol(path)
    if user:
        _users[host(plain)] = user
    return plain


def secrets() -> Secrets:
    """What was taken out of URLs, for another process to take (`add_secrets`)."""
    return _users, _queries


def add_secrets(found: Secrets) -> None:
    _users.update(found[0])
    _queries.update(found[1])


def host(url: str) -> str:
    """What holds all of a store: s3://bucket, http://server."""
    return "/".join(url.split("/", 3)[:3])


def parent(url: str) -> str:
    return url.rpartition("/")[0]


def join(folder: str, name: str) -> str:
    """The URL of a file, by its path with forward slashes below a folder's URL."""
    return f"{folder.rstrip('/')}/{quote(name) if is_web(folder) else name}"


def common_folder(found: Sequence[str]) -> str:
    """The deepest folder that holds all of some URLs. UsageError where they are of several stores."""
    hosts = {host(url) for url in found}
    if len(hosts) > 1:
        raise UsageError("the files lie in several stores; give each store a batch of its own")
    (own,) = hosts
    return own + posixpath.commonpath([posixpath.dirname(url.removeprefix(own)) for url in found])


def glob(pattern: str) -> list[str]:
    """The files that a pattern matches, hidden ones left out. UsageError for none."""
    store, path = _store(pattern)
    try:
        with _store_errors(pattern, "listed"):
            details = store.glob(path, detail=True)
    except AbsentError:  # some stores raise it for a bucket that is not there, and some find nothing in it
        details = {}
    fixed = len(re.split(r"[*?\[]", path)[0].rpartition("/")[0])
    found = [name for name, what in details.items() if what["type"] == "file" and "/." not in name[fixed:]]
    if not found:
        bucket, top = _store(host(pattern))
        with _store_errors(pattern, "listed"):
            there = bucket.exists(top)
        why = "** stands for all folders" if there else f"there is no {host(pattern)}"
        raise UsageError(f"'{pattern}' matches no file; {why}")
    return [without_secrets(store.unstrip_protocol(name)) for name in found]


def missing(urls: Sequence[str]) -> list[str]:
    """Those of some URLs behind which there is no file."""
    with ThreadPoolExecutor(_AT_ONCE) as pool:
        return [url for url, there in zip(urls, pool.map(exists, urls), strict=True) if not there]


def exists(url: str) -> bool:
    store, path = _store(url)
    with _store_errors(url, "read"):
        return bool(store.isfile(path))


def etag(url: str) -> str:
    """The hash that the store itself keeps of a file's content; "" where it keeps none."""
    store, path = _store(url)
    with _store_errors(url, "read"):
        details = store.info(path)
    found = str(details.get("ETag") or details.get("etag") or "").strip('"')
    return "" if not found or found.startswith("W/") else _ETAG + found


def content_hash(url: str, like: str = "") -> str:
    """The hash of a file's content, of the kind that ``like`` is, else the cheapest. "" without a file."""
    try:
        own = "" if like and not like.startswith(_ETAG) else etag(url)
        if own:
            return own
        store, path = _store(url)
        with _store_errors(url, "read"), store.open(path, "rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except AbsentError:
        return ""


def get(url: str, place: Path) -> str:
    """Fetch a file; its `etag`, "" where there is none or somebody wrote the file meanwhile."""
    store, path = _store(url)
    before = etag(url)
    place.parent.mkdir(parents=True, exist_ok=True)
    with _store_errors(url, "read"):
        store.get_file(path, str(place))
    return before if before == etag(url) else ""


def put(place: Path, url: str) -> None:
    """Write a file, which appears whole."""
    store, path = _store(url)
    with _store_errors(url, "written"):
        if url.partition(":")[0] in _WHOLE:
            store.put_file(str(place), path)
        else:
            part = f"{path}.rigtri-part"
            store.makedirs(posixpath.dirname(path), exist_ok=True)
            store.put_file(str(place), part)
            store.mv(part, path)


def try_writing(folder: str) -> None:
    """Write an empty file into a folder, and remove it. FileError where nothing can be written there."""
    url = join(folder, f".rigtri-{uuid4().hex[:8]}")
    with tempfile.NamedTemporaryFile(prefix="rigtri-") as empty:
        try:
            put(Path(empty.name), url)
        except AbsentError:
            raise FileError(
                f"nothing can be written to {folder}: there is no {host(folder)}; make it, or give another -O"
            ) from None
        except FileError as error:
            reason = str(error).removeprefix(f"{url} cannot be written: ")
            raise FileError(f"nothing can be written to {folder}: {reason}") from error
    store, path = _store(url)
    with suppress(FileError), _store_errors(url, "removed"):  # there are stores that take and never give back
        store.rm_file(path)


class AbsentError(FileError):
    """There is no such file."""


def _store(url: str) -> tuple[Any, str]:
    """The file system of fsspec that a URL is of, and the path there."""
    try:
        import fsspec
    except ImportError:
        raise UsageError(f'{url}: URLs need more packages: pip install "rigtri[remote]"') from None
    if not _closes_brackets(url):
        raise UsageError(f"{url} is no URL: [ and ] in the name of a host are for an IPv6 address")
    user = _users.get(host(url))
    whole = url.replace("://", f"://{user}@", 1) if user else url
    try:
        store, path = fsspec.core.url_to_fs(whole + _queries.get(url, ""), use_listings_cache=False)
    except ImportError as error:
        raise UsageError(f"{url}: a store of this kind needs another package: {error}") from None
    except ValueError as error:
        raise UsageError(f"{url}: {_without_secrets(str(error))}") from None
    return store, path


def _closes_brackets(url: str) -> bool:
    """Whether brackets of the host, if it has any, hold an address; fsspec may fail anyhow."""
    try:
        urlsplit(url)
    except ValueError:
        return False
    return True


@contextmanager
def _store_errors(url: str, what: str) -> Iterator[None]:
    """What a store refuses, as an error of the file; stores have errors of many kinds."""
    try:
        yield
    except RigtriError:
        raise
    except FileNotFoundError:
        raise AbsentError(f"There is no file {url}") from None
    except Exception as error:
        reason = _without_secrets(f"{type(error).__name__}: {error}")
        raise FileError(f"{url} cannot be {what}: {reason}") from error


def _without_secrets(text: str) -> str:
    """A text without the secrets of URLs in it."""
    for secret in (*_users.values(), *_queries.values()):
        text = text.replace(secret, "…")
    return re.sub(r"(://)[^/@\s]*@|(://[^\s?'\"]*)\?[^\s'\")]*", r"\1\2", text)
