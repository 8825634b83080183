"""Tasks for processes, in a module that is loaded quickly."""

import os
import signal
import time


def slow_square(number: int) -> int:
    time.sleep(0.02)
    return number * number


def suicide(number: int) -> int:
    if number == 3:
        os.kill(os.getpid(), signal.SIGKILL)
    return number
