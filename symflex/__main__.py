"""``python -m symflex``, and the command ``symflex``."""

import os
import signal
from types import FrameType


def main() -> None:
    """Load the command line and run it; Ctrl-C before it listens ends the process without a traceback."""
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _stop)
    from symflex.cli import main as run  # which takes a while

    run()


def _stop(number: int, frame: FrameType | None) -> None:
    os.write(2, b"stopped\n")
    os._exit(128 + number)


if __name__ == "__main__":
    main()
