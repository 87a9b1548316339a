// The controls that lie over the scene: STOP, on a small or touched screen the orders, and while one
// drives its keys, which light up as they are held and drive as well where they are touched.
function makeDeck({ guide, labels, order, hold, release }) {
  const make = (tag, id, parent = document.body) => {
    const made = document.createElement(tag);
    made.id = id;
    parent.append(made);
    return made;
  };
  const stop = make("button", "sheath-stop");
  stop.textContent = "STOP";
  stop.setAttribute("aria-label", "Emergency stop");
  stop.title = "Stops the robot, as Space does";
  stop.onclick = () => order("emergency-stop");
  // First of all that Tab reaches.
  document.body.prepend(stop);

  const corner = make("div", "sheath-corner"), orders = make("div", "sheath-orders"), keys = make("div", "sheath-keys");
  orders.setAttribute("role", "group");
  orders.setAttribute("aria-label", "Orders");
  keys.setAttribute("role", "group");
  keys.setAttribute("aria-label", "Keys that drive");
  const offered = [
    ["reset-stop", "Reset the stop", (it) => it.stopped],
    ["call-off-discard", "Keep the episode", (it) => it.discard_s != null],
    ["take-over", "Take over", (it) => !it.mine && !it.others && !it.stopped],
    ["hand-back", "Hand back", (it) => it.mine],
    ["hand-back", "Let the policy go on", (it) => it.abandoned && !it.stopped],
    ["pause", "Pause", (it) => !it.paused && !it.stopped && !it.unready],
    ["pause", "Resume", (it) => it.paused && !it.stopped],
  ].map(([name, text, when]) => {
    const button = document.createElement("button");
    button.textContent = text;
    button.onclick = () => order(name);
    orders.append(button);
    return { button, when };
  });

  const caps = new Map();
  for (const { codes, says } of guide) {
    const words = says.split(", ");
    codes.forEach((code, n) => {
      const cap = document.createElement("button"), letter = document.createElement("kbd");
      const word = document.createElement("span");
      // The keyboard drives by itself: Tab need not go through all of them.
      cap.tabIndex = -1;
      word.textContent = words.length === codes.length ? words[n] : says;
      cap.append(letter, word);
      keys.append(cap);
      caps.set(code, { cap, letter, word: word.textContent });
      // A finger that slides off, or that the system takes away, has let go.
      cap.onpointerdown = (event) => {
        event.preventDefault();
        hold(`touch ${code}`, code);
        cap.setPointerCapture(event.pointerId);
      };
      for (const ends of ["pointerup", "pointercancel", "pointerleave", "lostpointercapture"])
        cap.addEventListener(ends, () => release(`touch ${code}`));
      cap.oncontextmenu = (event) => event.preventDefault();
    });
  }
  function name() {
    for (const [code, { cap, letter, word }] of caps) {
      letter.textContent = labels(code);
      cap.setAttribute("aria-label", `${labels(code)}: ${word}`);
    }
  }
  name();

  return {
    corner,
    name,
    show(state, live) {
      stop.style.display = live ? "block" : "none";
      orders.style.display = corner.style.display = live && !state.over ? "" : "none";
      for (const { button, when } of offered) button.hidden = !when(state);
      keys.style.display = live && state.mine ? "" : "none";
    },
    light(held) {
      const now = new Set(held);
      for (const [code, { cap }] of caps) cap.classList.toggle("held", now.has(code));
    },
    remove() { for (const each of [stop, corner, orders, keys]) each.remove(); },
  };
}
