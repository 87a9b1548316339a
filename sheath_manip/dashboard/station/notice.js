// What is the case, in a sentence or two over the scene, and in the tab's title and sign.
const RED = "#be1e2d", AMBER = "#b34f00", GREEN = "#007a5a", GREY = "#5c626a";
const flags = [
  ["STOP", "■"], ["DISCARDING", "▲"], ["asks", "▲"], ["WAITING", "▲"], ["LOST", "✕"], ["PAUSED", "‖"],
  ["FINISHED", "✓"], ["FITTING", "◔"], ["TRYING", "◔"],
];

// Whether the robot wants a person, so that one who looks elsewhere must be called.
function wantsSomebody(state) {
  return Boolean((state.asking || state.unready) && !state.mine && !state.others && !state.stopped
    && !state.paused && !state.between);
}

function workWords({ idle_s, work, percent, left_s }) {
  if (!work) return `BETWEEN EPISODES for ${idle_s} s: the robot stands.`;
  const how = percent == null ? ` for ${idle_s} s` : `: ${percent} %${left_s == null ? "" : `, about ${left_s} s left`}`;
  return `${work.replace(/^\w+/, (verb) => verb.toUpperCase())}${how}. The robot stands.`;
}

// `link` is what the page knows of its own connection.
function noticeWords(state, link, key) {
  if (link.finished)
    return [`FINISHED. The run has ended${link.savedIn && `, recorded in ${link.savedIn}`}; you see its last moment.`, GREY];
  if (link.otherRun) return ["ANOTHER RUN is at this address now. Open the address that it printed.", RED];
  if (link.lost)
    return ["CONNECTION LOST. What you see is the past, and nothing that you press is heard. Trying again.", RED];
  const [take, back, pause] = ["KeyT", "KeyH", "KeyP"].map(key), { between } = state;
  const wait = state.left_s == null || state.paused ? "" : ` The ${state.fallback} acts in ${state.left_s} s.`;
  const alone = state.asking && !state.mine && !state.others;
  const old = state.picture_s ? ` The picture is ${state.picture_s} s old.` : "";
  const paused = state.paused ? ` Paused: ${pause} resumes.` : "", more = paused + old;
  const device = link.padSays && state.mine ? ` ${link.padSays}` : "";
  if (state.stopped) return [`EMERGENCY STOP. ${key("KeyR")} resets it.${old}`, RED];
  if (state.discard_s != null)
    return [`DISCARDING this episode in ${state.discard_s} s. ${key("KeyC")} keeps it.${old}`, AMBER];
  if (state.mine && state.too_old)
    return [`THE PICTURE IS ${state.picture_s} s OLD, so the robot holds until it is young again.${paused}`, AMBER];
  if (state.unready)
    return [`WAITING FOR YOU. ${back} lets the policy begin, ${take} begins with you at the wheel.${more}`, AMBER];
  if (between && (between.work || between.idle_s > 1)) return [`${workWords(between)}${paused}`, GREY, between.percent];
  if (state.abandoned)
    return [`The robot holds, since nobody drives any longer. ${take} takes over, ${back} lets the policy go on.${more}`, AMBER];
  if (alone && state.turn === "fallback")
    return [`Nobody came, so the ${state.fallback} acts. Take over with ${take}.${more}`, AMBER];
  if (alone) return [`The robot holds and asks for you: take over with ${take}.${wait}${more}`, AMBER];
  if (state.others) return [`Another page drives; you watch. Space stops the robot.${more}`, GREY];
  if (state.mine && state.turn !== "operator")
    return [`You have taken over; the robot holds until you move it. ${back} hands back.${more}${device}`, GREEN];
  const ready = state.may_go_on ? "The gate would let the policy go on: " : "";
  if (state.mine) return [`You drive. ${ready}${back} hands back, Space stops.${more}${device}`, GREEN];
  if (state.paused) return [`PAUSED. ${pause} resumes, . does one step.${old}`, GREY];
  return [state.too_old ? old.trim() : "", AMBER];
}

function makeNotice(title) {
  const banner = document.createElement("div");
  banner.id = "sheath-operator";
  banner.setAttribute("role", "status");
  document.body.appendChild(banner);
  const icon = document.querySelector("link[rel~=icon]") ?? document.head.appendChild(document.createElement("link"));
  icon.rel = "icon";
  icon.removeAttribute("type");
  let shown = "";
  return {
    remove: () => banner.remove(),
    show([text, colour, percent]) {
      const now = `${colour} ${percent} ${text}`;
      if (now === shown) return;
      shown = now;
      banner.style.display = text ? "block" : "none";
      banner.style.background = colour;
      banner.style.setProperty("--done", `${percent ?? 0}%`);
      banner.textContent = text;
      const flag = flags.find(([word]) => text.includes(word))?.[1] ?? "";
      document.title = `${flag && `${flag} `}${title}`;
      icon.href = `data:image/svg+xml,${encodeURIComponent(
        `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 32 32"><rect width="32" height="32" rx="7" fill="${
          text ? colour : "#0072b2"}"/><text x="16" y="23" font-size="20" text-anchor="middle" fill="white">${
          flag || "s"}</text></svg>`)}`;
    },
  };
}
