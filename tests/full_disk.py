"""A disk that is full."""

import contextlib
import resource
import signal


@contextlib.contextmanager
def small_files(room):
    """Let no file grow beyond so many bytes; None: no limit."""
    old = resource.getrlimit(resource.RLIMIT_FSIZE)
    before = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    if room is not None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (room, old[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, old)
        signal.signal(signal.SIGXFSZ, before)
