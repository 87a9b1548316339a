// Reads the gamepad that spoke last, and says in words why another one does not drive. A pad whose
// buttons lie elsewhere would drive by itself; one that says nothing new has frozen.
const frozenMs = 3000;

function readPad() {
  const there = [...(navigator.getGamepads?.() ?? [])].filter((each) => each?.connected);
  const known = there.filter((each) => each.mapping === "standard");
  const found = known.sort((one, other) => other.timestamp - one.timestamp)[0];
  const strange = there.filter((each) => each.mapping !== "standard");
  const unheard = strange.length && (!found || strange.some((each) => each.buttons.some((it) => it.pressed)));
  const says = unheard ? "This gamepad's layout is unknown, so it does not drive." : "";
  if (!found) return { pad: null, says };
  const axis = (n) => Math.max(-1, Math.min(1, Math.round(1000 * (found.axes[n] ?? 0)) / 1000));
  const axes = [0, 1, 2, 3].map(axis);
  const buttons = found.buttons.flatMap((each, n) => (each.pressed && n < 32 ? [n] : []));
  const moved = buttons.length || axes.some((each) => Math.abs(each) > 0.2);
  if (moved && performance.now() - found.timestamp > frozenMs)
    return { pad: null, says: "The gamepad says nothing new, so it does not drive: move it." };
  return { pad: { axes, buttons }, says };
}
