"""A kernel, and what happens when it has to be compiled."""

import atexit
import contextlib
import fcntl
import functools
import hashlib
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from pathlib import Path

from numba import types
from numba.core.caching import CompileResultCacheImpl, FunctionCache, _CacheLocator
from numba.core.compiler_lock import global_compiler_lock
from numba.core.registry import CPUDispatcher
from numba.core.runtime import rtsys
from numba.core.sigutils import normalize_signature

from kerneljit.code import Callee, entries
from kerneljit.interrupt import Interrupt
from kerneljit.project import Project
from kerneljit.records import PACKAGES

_INTERRUPTED = 130  # exit status of a process ended by Ctrl-C
_STACK = 2**26  # bytes, enough for LLVM on any system


@functools.cache
def _start_without_scipy() -> None:
    """Let numba load its NumPy functions without looking for SciPy's BLAS, which takes 0.15 s.

    It only notes that there is one, as SciPy is required; `np.dot` in a kernel still looks for it.
    """
    from numba.np import linalg

    before, linalg.ensure_blas = linalg.ensure_blas, lambda: None
    try:
        from numba.np import arraymath

        arraymath.ensure_blas = before
    finally:
        linalg.ensure_blas = before


class _ByContents(_CacheLocator):
    """Compiled code by the contents of the kernels, wherever and however old their files are.

    numba itself asks for the path and date of a source, and compiles anew in each copy of it.
    """

    project: Project

    def __init__(self, function, source):
        self._line, self._source = function.__code__.co_firstlineno, source

    from_function = classmethod(lambda cls, function, source: cls(function, source))

    def get_cache_path(self):
        return self.project.code_folder

    def get_source_stamp(self):
        source = Path(self._source)  # none of a function that is typed in
        return hashlib.sha256(source.read_bytes() if source.is_file() else b"").hexdigest()

    def get_disambiguator(self):
        return str(self._line)


class _Cache(FunctionCache):
    """numba's disk cache, from a disk that may be full or have lost what it held."""

    project: Project

    def load_overload(self, sig, target_context):
        # What numba knows of Python's and NumPy's functions is for who compiles, and takes 0.1 s to
        # load: here only the memory of arrays is made ready.
        rtsys.initialize(target_context)
        try:
            return self._load_overload(sig, target_context)
        except Exception:  # whatever a truncated file unpickles to: it can be compiled again
            with contextlib.suppress(OSError):
                self.flush()
            return None

    def save_overload(self, sig, data):
        if not self.project.code_folder.endswith(self.project.kernels_hash()):
            return  # edited since: what was compiled may be of either source
        with contextlib.suppress(OSError):  # compiled code also runs where it cannot be kept
            super().save_overload(sig, data)

    @contextlib.contextmanager
    def locked(self) -> Iterator[None]:
        """Held by one process at a time, as far as the disk knows locks.

        A process holds no other such lock meanwhile, and loses it when it ends.
        """
        with contextlib.ExitStack() as stack:
            with contextlib.suppress(OSError):
                os.makedirs(self.cache_path, exist_ok=True)
                file = stack.enter_context(open(f"{self._cache_file._index_path}.lock", "w"))
                try:
                    fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
                except BlockingIOError:
                    self.project.tell_of_compiling()
                    fcntl.flock(file, fcntl.LOCK_EX)
            yield


@functools.cache
def _cache_of(project: Project) -> type[_Cache]:
    """The disk cache in the folder of a project: numba asks for classes, not for instances."""
    locator = type("_Locator", (_ByContents,), {"project": project})
    kept = type("_Kept", (CompileResultCacheImpl,), {"_locator_classes": [locator]})
    return type("_ProjectCache", (_Cache,), {"_impl_class": kept, "project": project})


def interruptible(work: Callable):
    """What `work()` returns; Ctrl-C is answered at once, though LLVM goes on for seconds.

    In a thread of its own, which ends what it began: nothing is left half compiled.
    """
    if (
        threading.current_thread() is not threading.main_thread()
        or global_compiler_lock.is_locked()
    ):
        return work()
    future: Future = Future()

    def run() -> None:
        try:
            future.set_result(work())
        except BaseException as error:
            future.set_exception(error)

    size, before = threading.stack_size(_STACK), signal.getsignal(signal.SIGINT)
    try:
        if callable(before):  # it is not ignored
            signal.signal(signal.SIGINT, signal.default_int_handler)
        threading.Thread(target=run, daemon=True).start()
        threading.stack_size(size)
        return future.result()
    except KeyboardInterrupt:
        atexit.register(_leave, future)
        raise
    finally:
        if callable(before):
            signal.signal(signal.SIGINT, before)


def _leave(future: Future) -> None:
    """End the process here if LLVM still works: it crashes when it is taken down meanwhile."""
    if not future.done():
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(_INTERRUPTED)


class Kernel(CPUDispatcher):
    """A compiled function. Python and other kernels may call it."""

    def __init__(self, project, function, options, level):
        super().__init__(function, targetoptions={"nopython": True} | options)
        PACKAGES.add(f"{project.name}.")
        self.project = project
        self.level = level
        self.companions: list[tuple[Kernel, Callable]] = []

    @functools.cached_property
    def disk(self) -> _Cache:
        """Compiled code on disk, for calls from Python; other kernels bring it along in theirs."""
        return _cache_of(self.project)(self.py_func)

    @functools.cached_property
    def callee(self) -> Callee:
        """As other kernels call it."""
        return Callee(self.py_func, self.targetoptions)

    def _compilation_chain_init_hook(self):
        pass  # other packages' extensions of numba are for who compiles

    def get_call_template(self, args, kws):
        # One version for all constants; LLVM puts them in where that pays.
        args = tuple(types.unliteral(arg) for arg in args)
        return self.callee.get_call_template(args, kws)

    def get_overload(self, sig):
        return self.callee.get_overload(sig)

    def compile(self, sig):
        args, _ = normalize_signature(sig)
        found = self._known(args)
        return (found or interruptible(lambda: self._compiled(args))).entry_point

    def _known(self, args):
        """Compiled by this process or another one before, or None."""
        with global_compiler_lock:
            found = self.overloads.get(args)
            if found is None:
                with Interrupt():  # LLVM calls back, and an exception raised there is lost
                    found = self.disk.load_overload(args, self.targetctx)
                    if found is not None:
                        self.add_overload(found)
            return found

    def _compiled(self, args):
        with self.disk.locked():
            found = self._known(args)  # by another process, meanwhile
            if found is None:
                self.project.tell_of_compiling()
                with global_compiler_lock:
                    _start_without_scipy()
                    group = [(self, args)]
                    group += ((other, types_of(*args)) for other, types_of in self.companions)
                    made = entries([(kernel.callee, its) for kernel, its in group], self.level)
                    for (kernel, its), one in zip(group, made, strict=True):
                        kernel.add_overload(one)
                        kernel.disk.save_overload(its, one)
                    found = made[0]
        return found
