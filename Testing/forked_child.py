"""A test's own process in two: what is done without rights, or dies, is done by a child."""

from __future__ import annotations

import multiprocessing


def in_child(function, *arguments):
    """Run in a forked process, which may give up its rights or die, and return what it returns."""
    context = multiprocessing.get_context("fork")
    receiver, sender = context.Pipe(duplex=False)
    process = context.Process(target=lambda: sender.send(function(*arguments)))
    process.start()
    assert receiver.poll(120)
    result = receiver.recv()
    process.join()
    return result
