"""Scripts that are added to the page, because viser has no option for what they do."""

from __future__ import annotations

import gzip
from functools import lru_cache

# The boxes beside sliders report each digit: who types 150 would set 1 and 15 on the way, on a rig
# too. This holds the browser's events back until the Enter key, or until the box is left.
_NUMBER_BOXES = """
(() => {
  const typed = new WeakSet();  // boxes with a number that is not reported yet
  const own = new WeakSet();  // events of this script
  const isBox = box => box instanceof HTMLInputElement && box.matches(".mantine-NumberInput-input");
  const put = Object.getOwnPropertyDescriptor(HTMLInputElement.prototype, "value").set;
  const report = box => {
    const event = new Event("input", {bubbles: true});
    typed.delete(box);
    own.add(event);
    box.dispatchEvent(event);
  };
  addEventListener("input", event => {
    if (!isBox(event.target) || own.has(event)) return;
    event.stopImmediatePropagation();
    typed.add(event.target);
  }, true);
  addEventListener("keydown", event => {
    if (event.key === "Enter" && typed.has(event.target)) report(event.target);
  }, true);
  addEventListener("focusout", event => {
    const box = event.target, text = box.value;
    if (!typed.has(box)) return;
    // After the box itself has dealt with being left: it would limit the number to the slider.
    setTimeout(() => { put.call(box, text); report(box); });
  }, true);
})();
"""

# Without graphics hardware the browser would take more than a core to draw 60 frames per second,
# which the loop needs too.
_FRAMES = """
(() => {
  const period = 1000 / 20;  // [ms]
  const gl = document.createElement("canvas").getContext("webgl2");
  const info = gl?.getExtension("WEBGL_debug_renderer_info");
  const renderer = info ? gl.getParameter(info.UNMASKED_RENDERER_WEBGL) : "";
  gl?.getExtension("WEBGL_lose_context")?.loseContext();
  if (!/swiftshader|llvmpipe|software|basic render/i.test(renderer)) return;
  const nextFrame = window.requestAnimationFrame.bind(window);
  const waiting = new Map();
  let number = 0, last = 0, isScheduled = false;
  const draw = now => {
    last = now;
    isScheduled = false;
    for (const [id, call] of [...waiting]) {
      if (!waiting.delete(id)) continue;  // cancelled by an earlier one
      try { call(now); } catch (error) { reportError(error); }
    }
  };
  window.requestAnimationFrame = call => {
    waiting.set(++number, call);
    if (!isScheduled) {
      isScheduled = true;
      setTimeout(() => nextFrame(draw), Math.max(0, last + period - performance.now()));
    }
    return number;
  };
  window.cancelAnimationFrame = id => { waiting.delete(id); };
})();
"""

_HEAD = b"<head>"
SCRIPT = f"<script>{_NUMBER_BOXES}{_FRAMES}</script>".encode()


@lru_cache(1)
def with_scripts(page: bytes, is_gzipped: bool) -> bytes:
    """The page with the scripts, compressed as it was."""
    plain = gzip.decompress(page) if is_gzipped else page
    changed = plain.replace(_HEAD, _HEAD + SCRIPT, 1)
    return gzip.compress(changed) if is_gzipped else changed
