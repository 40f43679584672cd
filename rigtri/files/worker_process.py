"""Work done in a process of its own: what ends that process costs one file, not the run.

usd-core crashes on some damaged files, and no Python can catch that. A child
does one task after another; one that dies, hangs or takes too much memory is
ended and replaced, and its task becomes a FileError. One that has done many is replaced, too.
"""

from __future__ import annotations

import contextlib
import errno
import gc
import multiprocessing
import os
import pickle
import signal
import tempfile
import threading
import time
import traceback
import warnings
from collections.abc import Callable, Iterator, Sequence
from multiprocessing import resource_tracker
from multiprocessing.connection import Connection
from multiprocessing.util import get_temp_dir
from pathlib import Path
from typing import Any, ClassVar, TypeVar

from rigtri.errors import MORE_FILES, FileError, RigtriError
from rigtri.files.import_path import no_working_folder_in_children
from rigtri.files.temp_dirs import adopt, root

T = TypeVar("T")

# What the server of children has loaded already, so that a new child costs milliseconds. None of it may start
# threads: a child has none of them, but the locks that they held.
PRELOADED = ["rigtri.pipeline.edit", "rigtri.formats.gltf.document", "rigtri.formats.usd.document"]

# How many more objects there must be before rings of them are looked for, and how often that must have
# been so before older ones are looked at, too.
_RINGS = 20_000, 5, 10
# The messages of the loader of libraries where there is no memory for them.
_NO_ROOM = ("failed to map segment", "Cannot allocate memory", "cannot allocate memory")
# So many tasks one process does, then another takes its place: OpenUSD keeps names, paths and handles of
# layers until a process ends, 5 to 10 kB for each small file that is edited. A new process takes 10 ms.
_TASKS = 500
# So often, seconds apart, a process is started before that is given up: its server may have been killed.
_STARTS, _BETWEEN = 5, 0.1
# poll(2) takes milliseconds of 31 bits; whoever waits longer, in seconds, asks it again.
_WAIT = 86_400.0
# So many files may be open at least where a process is started: standard ones, pipes, the server of children.
_FILES = 32
# Names of sockets are short: about 100 characters, 32 of them below this folder's.
_LONGEST = 70

_NO_MEMORY = "there is not enough memory for this file"
_NO_FOLDER = "the working folder was removed, and no process can be started there; change to another folder"
# How a child ends that has no memory left to report that.
_EXHAUSTED = 125
# M_TRIM_THRESHOLD, M_TOP_PAD and M_MMAP_THRESHOLD of mallopt(3), bytes each.
_KEPT = (-1, 1 << 26), (-2, 1 << 22), (-3, 1 << 24)


class CrashError(FileError):
    """A file on which the process died, hung or ran out of memory: ``kind`` is which of them."""

    kind = "crash"

    def __init__(self, text: str, kind: str = "crash") -> None:
        """kind: crash, timeout or memory."""
        super().__init__(text)
        self.kind = kind


class WorkerProcess(contextlib.AbstractContextManager["WorkerProcess"]):
    """A child process that does tasks in turn. Not for several threads at once; have one for each.

    seconds: how long a task may take. memory: how many bytes a child may take beyond
    what it has when it starts; only where /proc shows that (Linux). None: as it likes, or
    as much as this process where it is such a child itself. A child ends with its parent.
    """

    allowed: ClassVar[int | None] = None  # in a child: its own limit
    parent: ClassVar[Connection | None] = None  # in a child: where its parent listens

    def __init__(
        self, *, seconds: float | None = None, memory: int | None = None, preload: Sequence[str] = ()
    ) -> None:
        """preload: modules that tasks will need."""
        self._seconds, self._memory = seconds, self.allowed if memory is None else memory
        # A fork of this process would copy the locks that its threads hold; the server has no threads.
        method = "forkserver" if "forkserver" in multiprocessing.get_all_start_methods() else "spawn"
        self._context: Any = multiprocessing.get_context(method)
        if method == "forkserver":
            self._context.set_forkserver_preload([*PRELOADED, *preload])
        self._process: Any = None
        self._killed = False
        self._done = 0
        self._pipe: Connection | None = None

    def __call__(
        self,
        name: str,
        task: Callable[..., T],
        *arguments: Any,
        on_event: Callable[[Any], None] = lambda _: None,
    ) -> T:
        """``task(*arguments)`` in the child. ``name``: of the file, for errors.

        Task, arguments and result travel by pickle, and so does the events of the task (`send_event`), which
        ``on_event`` gets. CrashError where the child did not live to answer; a RigtriError of the task
        is raised here as it was there, any other exception as a RuntimeError with its traceback.
        """
        if self._done >= _TASKS:
            self.close()
        pipe = self._started(name)
        self._done += 1
        try:
            if self._killed:
                raise EOFError
            pipe.send((task, arguments))
            kind, value = self._answer(name, pipe, on_event)
        except (EOFError, ConnectionError):
            why, kind = self._death()
            raise CrashError(f"{name}: {why}", kind) from None
        if kind == "memory":
            self.close()
            raise CrashError(f"{name}: {_NO_MEMORY}", "memory")
        if kind == "refused":
            raise _rebuilt(*value)
        if kind == "failed":
            self.close()
            raise RuntimeError(value)
        result: T = value
        return result

    def _answer(self, name: str, pipe: Connection, on_event: Callable[[Any], None]) -> tuple[str, Any]:
        """What the child answers at the end of its task; meanwhile ``on_event`` gets its events."""
        end = None if self._seconds is None else time.monotonic() + self._seconds
        while _arrived(pipe, end):
            kind, value = pipe.recv()
            if kind != "event":
                return kind, value
            on_event(value)
            pipe.send(None)
        self.close()
        raise CrashError(f"{name}: took longer than {self._seconds:g} s and was stopped", "timeout")

    def kill(self) -> None:
        """End the child in the middle of its task, from any thread; who waits for it gets a CrashError.

        There will be no other.
        """
        self._killed = True  # first, for a child that is being started
        process = self._process  # its own thread may put another in its place
        if process is not None:
            process.kill()

    def close(self) -> None:
        """End the child, whatever it does."""
        if self._pipe is not None:
            self._pipe.close()
        if self._process is not None:
            self._process.kill()
            self._process.join()
        self._process = self._pipe = None

    def __exit__(self, *_: object) -> None:
        self.close()

    def _started(self, name: str) -> Connection:
        if self._pipe is None:
            self._process, self._pipe = self._start()
            self._done = 0
            if self._killed:  # meanwhile, when there was nothing to kill yet
                self._process.kill()
            try:
                self._pipe.recv()  # it is ready: the time of a task does not begin with imports
            except (EOFError, ConnectionError):
                raise CrashError(f"{name}: {self._death(begun=False)[0]}") from None
        return self._pipe

    def _start(self) -> tuple[Any, Connection]:
        """A new child. FileError where none comes into being."""
        try:
            os.getcwd()  # multiprocessing tells it to the child
        except FileNotFoundError as error:
            raise FileError(_NO_FOLDER) from error
        _refuse_few_files()
        place = root()
        _keep_sockets(place)
        for number in range(_STARTS):
            mine, theirs = self._context.Pipe()
            process = self._context.Process(target=_serve, args=(theirs, self._memory, place), daemon=True)
            try:
                with no_working_folder_in_children(), _sigint_blocked():
                    process.start()
            except (EOFError, OSError) as error:  # the next time the server is started anew
                mine.close()
                if number == _STARTS - 1:
                    reason = str(error) or type(error).__name__
                    raise FileError(f"no process can be started to work on files ({reason})") from error
                time.sleep(_BETWEEN)  # a server that was killed just now is not seen to be dead at once
            else:
                return process, mine
            finally:
                theirs.close()
        raise AssertionError("unreachable")

    def _death(self, *, begun: bool = True) -> tuple[str, str]:
        """What ended the child, in words, and which kind of crash that is; another will be started.

        begun: it was ready to work.
        """
        if self._killed:
            self._process.kill()
        self._process.join()
        code = self._process.exitcode
        self.close()
        if code is not None and code < 0:
            with contextlib.suppress(ValueError):
                code = signal.Signals(-code).name
        if not begun and code != "SIGKILL":
            why = f"the process for this file ended before it began (exit code {code}); it has printed why"
        elif code == "SIGKILL":
            why = "the process that read it was killed (SIGKILL), as systems do that run out of memory"
        elif code == _EXHAUSTED:
            return _NO_MEMORY, "memory"
        elif self._memory is not None:
            why = (
                f"the library that reads it crashed ({code}): it needs more memory than it may have, or the "
                "file is damaged. Allow it more, or export it again with the program that wrote it"
            )
        else:
            why = (
                f"the library that reads it crashed ({code}). The file is damaged; export it again with the "
                "program that wrote it"
            )
        return why, "crash"


def _refuse_few_files() -> None:
    """FileError where so few files may be open that multiprocessing fails, in its server or at its exit."""
    try:
        import resource
    except ImportError:  # Windows
        return
    most, _ = resource.getrlimit(resource.RLIMIT_NOFILE)
    if 0 <= most < _FILES:
        raise FileError(
            f"no process can be started to work on files: at most {most} files may be open at once, and it "
            f"takes {_FILES}. {MORE_FILES}"
        )


def _arrived(pipe: Connection, end: float | None) -> bool:
    """Wait for a message; False where there is none at a time of `time.monotonic`."""
    if end is None:
        return pipe.poll(None)
    while not pipe.poll(min(max(end - time.monotonic(), 0.0), _WAIT)):
        if time.monotonic() >= end:
            return False
    return True


def send_event(value: Any) -> None:
    """From within a task: the parent has handled the event when this returns; nothing outside a child."""
    if WorkerProcess.parent is not None:
        WorkerProcess.parent.send(("event", value))
        WorkerProcess.parent.recv()


def _rebuilt(kind: type[RigtriError], arguments: tuple[Any, ...]) -> RigtriError:
    # The constructors of some errors take other arguments than the text they make of them.
    error = kind.__new__(kind)
    error.args = arguments
    return error


@contextlib.contextmanager
def _sigint_blocked() -> Iterator[None]:
    """What is started meanwhile never gets an interrupt; they are for us.

    Not on Windows.
    """
    # The warning of multiprocessing when its tracker was killed is nothing that a user could act upon.
    warnings.filterwarnings("ignore", "resource_tracker: process died unexpectedly", UserWarning)
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    resource_tracker.ensure_running()  # to start it lets interrupts through again
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _keep_sockets(place: str) -> None:
    """Let multiprocessing have its own folder there, which stays when this process is killed."""
    if len(place) <= _LONGEST:
        before, tempfile.tempdir = tempfile.tempdir, place
        try:
            get_temp_dir()
        finally:
            tempfile.tempdir = before


def _serve(pipe: Connection, memory: int | None, place: str) -> None:
    """The life of a child: tasks until the pipe closes. place: for its temporary files."""
    adopt(place)
    # The parent handles an interrupt, and then ends us.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    # For the parent we are a daemon, which it ends at its exit; a task may have children of its own.
    multiprocessing.current_process().daemon = False
    threading.Thread(target=_end_with_parent, daemon=True).start()
    if memory is not None:
        WorkerProcess.allowed = memory
        _limit(memory)
    WorkerProcess.parent = pipe
    # Documents go as soon as nobody needs them; to look for rings after each few hundred of their parts
    # costs more than it finds, and what was imported has none that go.
    gc.freeze()
    gc.set_threshold(*_RINGS)
    _keep_memory()
    with _ending_without_memory(), contextlib.suppress(EOFError, ConnectionError):
        pipe.send("ready")
        while True:
            content = pipe.recv_bytes()
            try:
                task, arguments = pickle.loads(content)  # an import that fails there is reported, too
                answer: tuple[str, Any] = "done", task(*arguments)
            except RigtriError as error:
                answer = "refused", (type(error), error.args)
            except BaseException as error:  # noqa: BLE001 - whatever it is, the parent raises it
                if of_memory(error):
                    pipe.send(("memory", None))
                    continue
                pipe.send(("failed", traceback.format_exc()))
                raise SystemExit(1) from None
            pipe.send(answer)


@contextlib.contextmanager
def _ending_without_memory() -> Iterator[None]:
    """End this process where it has not even the memory to report that, without a traceback."""
    try:
        yield
    except Exception as error:
        if of_memory(error):
            os._exit(_EXHAUSTED)
        raise


def _keep_memory() -> None:
    """Let freed memory stay with this process, up to a limit: the next file needs it again, and to take it
    from the system page by page costs as much as the sums that are done in it. Only where the C library
    can be set so (glibc).
    """
    import ctypes

    with contextlib.suppress(OSError, AttributeError, TypeError):
        for parameter, size in _KEPT:
            ctypes.CDLL(None).mallopt(parameter, size)


def of_memory(error: BaseException) -> bool:
    """Whether an error of some library or system means that there is no memory left."""
    return (
        isinstance(error, MemoryError)
        or (isinstance(error, OSError) and error.errno == errno.ENOMEM)
        or (isinstance(error, RuntimeError) and str(error) == "can't start new thread")
        or (isinstance(error, ImportError) and any(words in str(error) for words in _NO_ROOM))
    )


def _end_with_parent() -> None:
    """Wait for the parent's end, however it comes, and end this process in the middle of its task."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def _limit(memory: int) -> None:
    """Let this process map ``memory`` bytes more than it has; nothing where that is not known."""
    statm = Path("/proc/self/statm")
    if not statm.exists():
        return
    import resource

    pages = int(statm.read_text().split()[0])
    _, most = resource.getrlimit(resource.RLIMIT_AS)
    limit = pages * resource.getpagesize() + memory
    resource.setrlimit(resource.RLIMIT_AS, (limit if most < 0 else min(limit, most), most))
