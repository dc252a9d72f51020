"""Pages as on a slow, busy machine: their messages are late in both directions.

`make test SLOW=7` has every page of the tests do so (see `Testing/slow_machine`): what the watching
view has received, a page may show only later.
"""

from __future__ import annotations

import os

from playwright.sync_api import Browser, BrowserContext

_DELAY_MESSAGES = """
(() => {
  const RECEIVED = [0.4, 800];
  const SENT = [0.3, 250];
  const late = ([share, longest_ms]) => Math.random() < share ? Math.random() ** 2 * longest_ms : 0;
  const sleep = (ms) => ms > 0 ? new Promise((done) => setTimeout(done, ms)) : null;
  const Prompt = window.WebSocket;
  window.WebSocket = class WebSocket extends Prompt {
    #received = Promise.resolve();
    #sent = Promise.resolve();
    constructor(...address) {
      super(...address);
      for (const kind of ["message", "close"]) {
        this.addEventListener(kind, (event) => this.#hold(event));
      }
    }
    send(message) {
      this.#sent = this.#sent.then(() => sleep(late(SENT))).then(() => {
        if (this.readyState === Prompt.OPEN) super.send(message);
      });
    }
    #hold(event) {
      if (!event.isTrusted) return;
      event.stopImmediatePropagation();
      const { type, data, code, reason, wasClean } = event;
      // 60 states come in a second: they only wait for what came before them.
      const isState = typeof data === "string" && data.startsWith('{"type":"state"');
      const wait = isState ? 0 : late(RECEIVED);
      this.#received = this.#received.then(() => sleep(wait)).then(() => {
        this.dispatchEvent(type === "message"
          ? new MessageEvent(type, { data }) : new CloseEvent(type, { code, reason, wasClean }));
      });
    }
  };
})();
"""


def slow_pages(browser: Browser) -> Browser:
    """Delay what the pages of a browser receive and send, where tests run as on a slow machine."""
    if not os.environ.get("RASTRAINER_SLOW"):
        return browser
    new_context = browser.new_context

    def new_slow_context(**options: object) -> BrowserContext:
        context = new_context(**options)
        context.add_init_script(_DELAY_MESSAGES)
        return context

    browser.new_context = new_slow_context
    return browser
