"""What is run in the page of a live session that is measured."""

NOTES = """(() => {
  const noted = { sent: new Map(), drawn: [], bytes: [], turns: [], met: [], shown: 0, moved: [0, 0] };
  let meets = false;
  window.restshapeNoted = noted;
  const moved = ({ timeStamp }) => { noted.moved = [performance.now(), timeStamp]; meets = true; };
  document.addEventListener("pointermove", moved, true);
  document.addEventListener("restshape-drawn", ({ detail }) => noted.drawn.push([detail.id, performance.now()]));
  window.WebSocket = class extends WebSocket {
    constructor(...words) {
      super(...words);
      this.addEventListener("message", ({ data }) => { if (data.byteLength) noted.bytes.push(data.byteLength); });
    }
    send(text) {
      if (text.includes('"type":"event"')) noted.sent.set(JSON.parse(text).id, noted.moved);
      super.send(text);
    }
  };
  const turn = () => {
    noted.turns.push(performance.now());
    if (meets) noted.met.push(performance.now());
    meets = false;
    requestAnimationFrame(turn);
  };
  requestAnimationFrame(turn);
  // The first answer is on screen after the drawing that follows its numbers.
  const first = new MutationObserver(() => {
    first.disconnect();
    const drawn = () => { noted.shown = performance.timeOrigin + performance.now(); };
    requestAnimationFrame(() => setTimeout(drawn));
  });
  document.addEventListener("DOMContentLoaded", () => {
    const status = document.getElementById("status");
    if (status) first.observe(status, { childList: true });
  });
})();
"""
"""Notes in `restshapeNoted` what is sent, drawn and received, before the page's own script runs; times in ms.

`turns` are those of the display, `met` those of them before which the mouse has moved.
"""

FIND = """([roles, step]) => {
  const canvas = document.getElementById("canvas"), box = canvas.getBoundingClientRect(), found = new Map();
  for (let y = box.top + step; y < box.bottom; y += step) for (let x = box.left + step; x < box.right; x += step) {
    if (document.elementFromPoint(x, y) !== canvas) continue;
    const at = { clientX: x, clientY: y, pointerType: "mouse", bubbles: true };
    canvas.dispatchEvent(new PointerEvent("pointermove", at));
    if (canvas.title) found.set(canvas.title, [...(found.get(canvas.title) ?? []), [x, y]]);
  }
  const named = [...found].filter(([title]) => roles.some((role) => title.startsWith(role)));
  return named.length ? named : [...found];
}"""
"""Names of what lights up under the pointer, and the places where it does."""
