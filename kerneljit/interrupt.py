"""Ctrl-C during a solve."""

import signal
import threading
from types import FrameType, TracebackType


class Interrupt:
    """Delays Ctrl-C until `check_interrupt` is called or the block ends; blocks may be nested.

    A kernel that hands back a named tuple runs Python code to build it; an exception raised just
    there crashes the interpreter.
    """

    wanted = False

    def __enter__(self) -> "Interrupt":
        # Only the main thread has signals; another handler, as the program's, raises nothing.
        self.mine = (
            threading.current_thread() is threading.main_thread()
            and signal.getsignal(signal.SIGINT) is signal.default_int_handler
        )
        if self.mine:
            signal.signal(signal.SIGINT, self._note)
        return self

    def _note(self, number: int, frame: FrameType | None) -> None:
        self.wanted = True

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self.mine:
            signal.signal(signal.SIGINT, signal.default_int_handler)
            if kind is None and self.wanted:
                raise KeyboardInterrupt


def check_interrupt() -> None:
    """Raise KeyboardInterrupt after a Ctrl-C in a block of `Interrupt`, where that is safe."""
    block = getattr(signal.getsignal(signal.SIGINT), "__self__", None)
    is_main = threading.current_thread() is threading.main_thread()
    if isinstance(block, Interrupt) and block.wanted and is_main:
        raise KeyboardInterrupt
