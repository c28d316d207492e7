"""Makes the number boxes of the page report a number when it is complete, not every digit.

The boxes beside viser's sliders report each digit, and viser has no option for it: who types 150
would set 1 and 15 on the way, on a rig too. A script in the page holds the browser's events back
until the Enter key, or until the box is left.
"""

from __future__ import annotations

import gzip
from functools import lru_cache

HEAD = b"<head>"
SCRIPT = b"""<script>
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
</script>"""


@lru_cache(1)
def with_number_boxes(page: bytes, is_gzipped: bool) -> bytes:
    """The page with the script, compressed as it was."""
    plain = gzip.decompress(page) if is_gzipped else page
    changed = plain.replace(HEAD, HEAD + SCRIPT, 1)
    return gzip.compress(changed) if is_gzipped else changed
