"""What an edit writes: a part beside its target and what goes with it; either all stay or none."""

from __future__ import annotations

import errno
import filecmp
import glob
import os
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import IO

from rigtri.errors import FileError, UsageError, system_reason
from rigtri.files.atomic_write import (
    atomic_write,
    commit,
    discard_stale,
    fsync,
    inherit,
    resolve_link,
    same_file,
    stale_files,
    stale_parts,
    temp_path,
)
from rigtri.files.background_copy import BackgroundCopies, copy_file
from rigtri.files.buffer_files import added_buffers, remove_unnamed
from rigtri.files.text_files import check_name


@dataclass(frozen=True)
class Companion:
    """A file that must lie beside the output: new bytes, or a copy of a file of the source.

    name: where, relative to the output's folder, with forward slashes.
    """

    name: str
    content: bytes | Path


class StagedOutput:
    """A part beside its target and the companions placed so far; either all stay or none.

    The rename of the part is the moment that counts: as long as there is a part, the old
    files are the valid ones, and what a killed run has replaced is put back by the next. Where there is
    something to do after the rename, the old output stays meanwhile, too, under the name of a backup:
    a backup without a part shows the next run what a killed one has not done.
    """

    def __init__(
        self,
        final: Path,
        overwrite: bool,
        needed: Sequence[tuple[Path, str]] = (),
        ahead: BackgroundCopies | None = None,
        *,
        shared: bool = False,
        passing: bool = False,
    ) -> None:
        """shared: other files appear in the folder at the same time, and may need the same copies.

        Copies of the source's files then are not ours to take back, to force names to the disk is the
        caller's, who does it while the next file is worked on. passing: nobody needs it when the process has
        ended, so nothing waits for the disk.
        """
        self.final, self.overwrite, self._needed, self._shared = final, overwrite, needed, shared
        self._ahead = ahead or BackgroundCopies()
        self.part = temp_path(final)
        self._on_disk = self._passing = passing
        self._syncing: threading.Thread | None = None
        self.placed: list[tuple[Path, Path | None]] = []
        self._folders: list[Path] = []  # those that were not there before
        self.beside: list[Path] = []  # all companions, also those that were there
        # Where the bytes of each are now: a file of the source, whatever others put there, or a part.
        self.copied: dict[Path, Path] = {}
        self._followers: list[Path] = []
        self._backup = _backup_path(final, os.getpid())

    def add(self, companion: Companion) -> None:
        """Put a companion in place, keeping what was there until the whole has passed."""
        name = Path(companion.name)
        if name.is_absolute() or ".." in name.parts:
            raise FileError(
                f"'{companion.name}' lies outside the folder of the source; it will not be copied "
                "beside the output. Use --resources relink."
            )
        place = self.final.parent / name
        self.beside.append(place)
        if isinstance(companion.content, Path):
            self.copied[place] = companion.content
        # Asked for once: what another process puts there between two questions is the same copy.
        known = place.exists()
        if known and _same(companion.content, place):
            return
        if known and not self.overwrite:
            raise UsageError(
                f"{place} exists and is another file than the one that {self.final.name} needs there; "
                "it is replaced only with --overwrite"
            )
        check_not_an_input(place, [*self._needed, (self.final, "the output itself")])
        self._make_folder(place.parent)
        content = companion.content
        there = isinstance(content, Path) and self._ahead.take(content, temp_path(place))
        if not there and not self._shared:
            discard_stale(place)
        if not (self._shared and isinstance(content, Path)):
            backup = _backup_path(place, os.getpid()) if place.exists() else None
            if backup is not None:
                _link(place, backup)
            self.placed.append((place, backup))
        with atomic_write(place) as fresh:
            if isinstance(content, bytes):
                fresh.write_bytes(content)
            elif not there:
                copy_file(content, fresh)

    def follow(self, place: Path, content: bytes) -> None:
        """Write what is true of the new output alone: it takes its name after the output has.

        It counts as a companion. What has that name now loses it before, so that at no moment one stands
        beside the other's output.
        """
        place = destination(place)
        with as_file_error(place):
            for stale, _ in stale_files(place.parent, f".{place.name}.part-"):
                stale.unlink(missing_ok=True)
            self._followers.append(place)
            part = _follower_part(place, os.getpid())
            part.write_bytes(content)
            fsync(part)
            inherit(place, part)
        self.beside.append(place)
        self.copied[place] = part

    def _make_folder(self, folder: Path) -> None:
        if not folder.is_dir():
            self._make_folder(folder.parent)
            folder.mkdir(exist_ok=True)
            self._folders.append(folder)

    def fsync_in_background(self) -> None:
        """Let the disk take the part meanwhile, so that the rename need not wait for that."""
        if self._passing:
            return
        # The thread must not open it: it would wait for this one before it came to the sync.
        thread = threading.Thread(target=self._fsync, args=(self.part.open("rb+"),))
        thread.start()
        self._syncing = thread

    def _fsync(self, part: IO[bytes]) -> None:
        with part, suppress(OSError):  # it comes again before the rename, and is raised then
            os.fsync(part.fileno())
            self._on_disk = True

    def _fsynced(self) -> bool:
        """Wait for `fsync_in_background`; whether the disk has all of the part."""
        if self._syncing is not None:
            self._syncing.join()
        return self._on_disk

    def finish(self) -> None:
        """Rename the part into place, and what follows it; remove buffers of ours that nothing refers to."""
        backups = [backup for _, backup in self.placed if backup is not None]
        with as_file_error(self.final):
            # Of what is there now: another run may have put it there since this one began.
            orphans = added_buffers(self.final, self.final, every=not self._shared)
            if backups or orphans or self._followers:
                _link(self.final if self.final.exists() else self.part, self._backup)
        for place in filter(Path.exists, self._followers):
            with as_file_error(place):
                backups.append(_backup_path(place, os.getpid()))
                _link(place, backups[-1])
                self.placed.append((place, backups[-1]))
                place.unlink()
        with as_file_error(self.final):
            commit(self.part, self.final, synced=self._fsynced(), named=not (self._shared or self._passing))
        for place in self._followers:
            with as_file_error(place):
                commit(_follower_part(place, os.getpid()), place, synced=True)
        # The new files are there; what cannot be tidied up any more is no reason to fail.
        with suppress(OSError):
            for backup in backups:
                backup.unlink()
            remove_unnamed(orphans)
            self._backup.unlink(missing_ok=True)

    def undo(self) -> None:
        """Leave the folder as it was; where the part has become the file, leave what follows it."""
        self._fsynced()
        if (self.placed or self._followers) and not self.part.exists():
            with suppress(OSError):
                recover(self.final, self._followers)
            return
        # What cannot be put back keeps the part, too, by which the next run knows; the others are put back.
        stuck = [one for one in reversed(self.placed) if not _restored(*one)]
        if stuck:
            return
        for folder in [] if self._shared else reversed(self._folders):
            with suppress(OSError):  # somebody else has put something there
                folder.rmdir()
        with suppress(OSError):  # the reason for undoing is raised, not this
            for place in self._followers:
                _follower_part(place, os.getpid()).unlink(missing_ok=True)
            self._backup.unlink(missing_ok=True)
            self.part.unlink(missing_ok=True)


def _follower_part(place: Path, process: int) -> Path:
    """What takes a name after an output has; its own name tells it from the part of an output."""
    return place.with_name(f".{place.name}.part-{process}")


def _backup_path(place: Path, process: int) -> Path:
    """Where a run keeps the file that it replaces."""
    return place.with_name(f".{place.name}.kept-{process}")


def _link(place: Path, backup: Path) -> None:
    """A second name for a file, or a copy where the file system has no links."""
    backup.unlink(missing_ok=True)
    try:
        os.link(place, backup)
    except OSError:
        import shutil

        shutil.copy2(place, backup)


def _restored(place: Path, backup: Path | None) -> bool:
    """Put back what was there, or nothing; whether that is there now. A locked file never went."""
    try:
        if backup is None:
            place.unlink(missing_ok=True)
        elif place.exists() and _same(backup, place):
            backup.unlink()
        else:
            _put_back(backup, place)
    except OSError:
        return False
    return True


def _put_back(backup: Path, place: Path) -> None:
    os.replace(backup, place)
    # Of two names of one file the rename drops neither.
    backup.unlink(missing_ok=True)


def recover(final: Path, side_files: Sequence[Path] = (), *, alone: bool = False) -> None:
    """Finish what killed runs have left.

    Those that had not renamed their part: put back what they had replaced, remove their parts and the
    buffers that only these refer to. Those that had: let what follows the output take its name, and remove
    what they had replaced.
    side_files: what may follow the output; in its folder and with its name it is found without. alone:
    nobody else writes ``final``.
    """
    for own, process in stale_parts(final, every=alone):
        _backup_path(final, process).unlink(missing_ok=True)
        for backup in chain(final.parent.rglob(f".*.kept-{process}"), _left(side_files, f"kept-{process}")):
            _put_back(backup, _of_name(backup))
        for part in _left(side_files, f"part-{process}"):
            part.unlink()
        remove_unnamed(added_buffers(own, final, every=not alone), but=own)
        for part in final.parent.rglob(f".*.part-{process}*"):
            if part != own:
                part.unlink(missing_ok=True)
        own.unlink(missing_ok=True)
    for old, process in stale_files(final.parent, f".{final.name}.kept-", every=alone):
        named = final.parent.glob(f".{glob.escape(final.stem)}.*.part-{process}")
        for part in chain(named, _left(side_files, f"part-{process}")):
            os.replace(part, _of_name(part))
        remove_unnamed(added_buffers(old, final, every=not alone))
        for backup in chain(final.parent.rglob(f".*.kept-{process}"), _left(side_files, f"kept-{process}")):
            if backup != old:
                backup.unlink(missing_ok=True)
        old.unlink(missing_ok=True)


def _left(side_files: Sequence[Path], end: str) -> Iterator[Path]:
    """What a process has left of side files, under names that end so; not what was done away with by then."""
    for place in map(resolve_link, side_files):
        if (left := place.with_name(f".{place.name}.{end}")).exists():
            yield left


def _of_name(left: Path) -> Path:
    """What a backup, or the part of what follows an output, is to be called."""
    return left.with_name(left.name[1:].rpartition(".")[0])


def _same(content: bytes | Path, place: Path) -> bool:
    if isinstance(content, bytes):
        return place.is_file() and place.read_bytes() == content
    return place.is_file() and filecmp.cmp(content, place, shallow=False)


def check_not_an_input(place: Path, needed: Sequence[tuple[Path, str]]) -> None:
    """UsageError where writing to ``place`` would destroy a file that the output needs."""
    for file, what in needed:
        if same_file(place, file):
            raise UsageError(f"{place} is {what}; it would be lost. Give another name")


@contextmanager
def as_file_error(path: Path) -> Iterator[None]:
    """An error of the operating system, with the file it concerns."""
    try:
        yield
    except OSError as error:
        raise FileError(f"{path} cannot be written: {system_reason(error)}") from error


def destination(path: Path) -> Path:
    """Where what is to be named ``path`` is written: a link stays a link, and what it leads to is replaced.

    UsageError for a device, a pipe, or a name that no file can have; FileError for links in a circle.
    """
    check_name(path)
    with as_file_error(path):
        place = resolve_link(path)
        # The name itself is checked: what a link in /proc leads to need be no name.
        if path.exists() and not (path.is_file() or path.is_dir()):
            raise UsageError(
                f"{path} is a device or a pipe; give the name of a plain file "
                "(-o - and --json write to standard output)"
            )
        return place


def why_unwritable(path: Path) -> str:
    """Why no file can be written there, as the system says it; "" where nothing is known against it."""
    folder = path.parent
    if path.is_dir():
        return os.strerror(errno.EISDIR)
    if not folder.is_dir():
        return os.strerror(errno.ENOTDIR if folder.exists() else errno.ENOENT)
    if os.access(folder, os.W_OK):
        return ""
    # Root, too, may not write to a disk that is mounted so.
    closed = hasattr(os, "statvfs") and os.statvfs(folder).f_flag & os.ST_RDONLY
    return os.strerror(errno.EROFS if closed else errno.EACCES)


def write_text(path: Path, text: str) -> None:
    """Write a small text file as `write_bytes` does, in UTF-8."""
    write_bytes(path, encoded(text))


def encoded(text: str) -> bytes:
    """Text in UTF-8."""
    # Half of a surrogate pair has no UTF-8; in JSON its escape means the same.
    return text.encode("utf-8", errors="backslashreplace")


def write_bytes(path: Path, content: bytes) -> None:
    """Write a small file beside and rename it, at its `destination`; FileError when that fails."""
    path = destination(path)
    with as_file_error(path):
        discard_stale(path)
        with atomic_write(path) as part:
            part.write_bytes(content)
