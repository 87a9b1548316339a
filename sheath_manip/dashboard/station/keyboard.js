// The meaning of keys: by the letter that is printed on each, wherever the layout has it. Where the
// layout has other letters (Cyrillic), by the place on an American keyboard; a sign is no letter, but
// the digits are printed in the same places everywhere, though some layouts want Shift for them.
const signs = { " ": "Space", ".": "Period", ",": "Comma" };

function meaningOf(event) {
  if (/^[a-z]$/i.test(event.key)) return `Key${event.key.toUpperCase()}`;
  if (event.code.startsWith("Digit")) return event.code;
  const byPlace = event.key.length > 1 ? event.key !== "Dead" : /^(?!\p{Script=Latin})\p{L}$/u.test(event.key);
  return signs[event.key] ?? (byPlace ? event.code : "");
}

// What is printed there: the letter itself, but in a layout without it what lies in its place.
function makeLabels(onChange) {
  let printed = null;
  navigator.keyboard?.getLayoutMap?.().then((map) => { printed = map; onChange(); }, () => {});
  return (name) => {
    const letter = { Space: "Space", Period: ".", Comma: "," }[name] ?? name.replace(/^(Key|Digit)/, "");
    const latin = !printed || [...printed.values()].includes(letter.toLowerCase());
    return latin || !name.startsWith("Key") ? letter : (printed.get(name) ?? letter).toUpperCase();
  };
}

// Listens to the keyboard. `order` gives an order, `hold` and `release` say what is held, and `drives`
// whether a key of that name drives now.
function listenToKeys({ hotkeys, order, hold, release, letGo, drives }) {
  const caught = new Set();
  const typing = (target) =>
    target instanceof Element && target.closest("input, textarea, [contenteditable='true']");
  const swallow = (event) => { event.preventDefault(); event.stopImmediatePropagation(); };

  function down(event) {
    // macOS tells of no key's release while Cmd is held.
    if (event.metaKey || event.key === "Meta") letGo();
    const name = meaningOf(event), hotkey = hotkeys[name], moves = drives(name);
    if (!hotkey && !moves) return;
    // Wherever the focus is: who wants to stop the robot does not look where that is.
    const stops = hotkey === "emergency-stop";
    const otherwise = event.ctrlKey || event.metaKey || event.altKey || typing(event.target);
    if (otherwise && !stops) return;
    // Neither viser's camera nor a button that has the focus gets it.
    swallow(event);
    caught.add(event.code);
    if (event.repeat) return;
    if (hotkey) order(hotkey);
    else hold(event.code, name);
  }
  function up(event) {
    if (event.key === "Meta") letGo();
    release(event.code);
    if (caught.delete(event.code)) swallow(event);
  }
  // Who looks elsewhere lets go: the key's release would never be heard.
  const hidden = () => { if (document.hidden) letGo(); };
  return [
    [window, "keydown", down], [window, "keyup", up],
    [window, "blur", letGo], [document, "visibilitychange", hidden],
  ];
}
