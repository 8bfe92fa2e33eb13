"""The program `divideropt`, and `python -m divideropt`."""

import os
import signal

_SIGNALS = (signal.SIGINT, signal.SIGTERM)


def _leave(number: int, frame: object) -> None:
    """End at once: an exception in the middle of an import would end in a traceback."""
    os.write(2, f"divideropt: stopped by {signal.Signals(number).name}; nothing that was logged is lost\n".encode())
    os._exit(128 + number)


for _signal in _SIGNALS:  # before anything is imported that takes its time
    signal.signal(_signal, _leave)

from divideropt.cli import main  # noqa: E402 (see above)

if __name__ == "__main__":
    main()
