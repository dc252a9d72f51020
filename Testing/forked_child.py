"""Calls in a forked child of the test's process, which may give up its rights or die."""

from __future__ import annotations

import multiprocessing


def in_child(function, *arguments):
    """Call in a forked process, which may give up its rights or die; return the result."""
    context = multiprocessing.get_context("fork")
    receiver, sender = context.Pipe(duplex=False)
    process = context.Process(target=lambda: sender.send(function(*arguments)))
    process.start()
    assert receiver.poll(120)
    result = receiver.recv()
    process.join()
    return result
