function (settings) {
  // Sent to each page by the server. Runs again where viser's own connection was lost and is back.
  const reopened = Boolean(window.sheathOperator);
  window.sheathOperator?.close();
  // viser's own addition to the address, which tells nothing new.
  if (location.search) history.replaceState(null, "", location.pathname);

  const sendEveryMs = 100, lookEveryMs = 50, retryMs = 500, sleptMs = 4000, silentMs = 2000, newMs = 5000, frozenMs = 3000;
  const codes = new Set(settings.codes), held = new Map(), caught = new Set();
  let socket = null, state = {}, closed = false, lastSent = "", sentMs = 0, lookedMs = Date.now(), beeps = 0, audio = null;
  let sawMark = 0, heardMs = Date.now(), heard = reopened, missed = 0, otherRun = false, finished = false, savedIn = "", padSays = "";

  const banner = document.createElement("div");
  banner.id = "sheath-operator";
  banner.setAttribute("role", "status");
  const stop = document.createElement("button");
  stop.id = "sheath-stop";
  stop.textContent = "STOP";
  stop.setAttribute("aria-label", "Emergency stop");
  stop.title = "Stops the robot, as Space does";
  stop.onclick = () => order("emergency-stop");
  const style = document.createElement("style");
  // Left of viser's panel; where that lies at the bottom, on a phone, as wide as the screen.
  style.textContent = `
    #sheath-operator { position: fixed; top: 14px; left: calc(50vw - 190px); transform: translateX(-50%);
      z-index: 10000; display: none; pointer-events: none; padding: .6em 1.4em; border-radius: 8px;
      color: white; text-align: center; font: 600 18px/1.35 sans-serif; max-width: 38vw;
      box-shadow: 0 2px 14px rgba(0, 0, 0, .35) }
    #sheath-stop { position: fixed; left: 18px; bottom: 18px; z-index: 10001; display: none; width: 132px;
      height: 76px; border: 3px solid white; border-radius: 12px; background: #be1e2d; color: white;
      font: 800 30px/1 sans-serif; letter-spacing: .04em; cursor: pointer;
      box-shadow: 0 2px 14px rgba(0, 0, 0, .45) }
    #sheath-stop:focus-visible { outline: 4px solid #1c1f24; outline-offset: 2px }
    @media (max-width: 800px) {
      #sheath-operator { left: 50vw; max-width: 96vw; width: max-content; font-size: 15px; padding: .5em .9em }
      #sheath-stop { top: 124px; bottom: auto; left: 10px; width: 104px; height: 60px; font-size: 24px }
    }`;
  document.head.appendChild(style);
  document.body.appendChild(banner);
  // First of all that Tab reaches.
  document.body.prepend(stop);

  const send = (message) => {
    if (socket?.readyState === WebSocket.OPEN) socket.send(JSON.stringify(message));
  };
  // With the number of the newest stop that was shown: a reset clears no other one.
  // Where nothing runs any longer there is nothing to order, but for what is never refused.
  const order = (name) => {
    if (state.over && name !== "emergency-stop") return;
    send({ order: name, ...(state.stops != null && { seen: state.stops }) });
  };

  const here = `${location.host}${location.pathname.replace(/\/$/, "")}`;

  function connect() {
    if (closed || otherRun || finished) return;
    const scheme = location.protocol === "https:" ? "wss" : "ws";
    socket = new WebSocket(`${scheme}://${here}${settings.path}`);
    socket.onopen = () => { send({ station: settings.station }); lastSent = ""; look(); };
    socket.onmessage = (event) => {
      state = JSON.parse(event.data);
      finished ||= Boolean(state.finished);
      savedIn ||= state.saved_in ?? "";
      heardMs = Date.now();
      heard = true;
      missed = 0;
      show();
    };
    socket.onclose = async () => {
      held.clear();
      state = {};
      show();
      if (closed || finished) return;
      // Another run at this address knows neither this page's path nor its cookie.
      otherRun = await fetch(location.pathname).then((answer) => answer.status === 401, () => false);
      show();
      setTimeout(connect, retryMs);
    };
  }

  // A pad whose buttons lie elsewhere would drive by itself; one that says nothing new has frozen.
  function pad() {
    const there = [...(navigator.getGamepads?.() ?? [])].filter((each) => each?.connected);
    const known = there.filter((each) => each.mapping === "standard");
    const found = known.sort((one, other) => other.timestamp - one.timestamp)[0];
    const strange = there.filter((each) => each.mapping !== "standard");
    const unheard = strange.length && (!found || strange.some((each) => each.buttons.some((it) => it.pressed)));
    padSays = unheard ? "This gamepad's layout is unknown, so it does not drive." : "";
    if (!found) return null;
    const axis = (n) => Math.max(-1, Math.min(1, Math.round(1000 * (found.axes[n] ?? 0)) / 1000));
    const axes = [0, 1, 2, 3].map(axis);
    const buttons = found.buttons.flatMap((each, n) => (each.pressed && n < 32 ? [n] : []));
    const moved = buttons.length || axes.some((each) => Math.abs(each) > 0.2);
    if (moved && performance.now() - found.timestamp > frozenMs) {
      padSays = "The gamepad says nothing new, so it does not drive: move it.";
      return null;
    }
    return { axes, buttons };
  }

  // What is held is sent on change and again and again: the server takes silence for letting go.
  // The clock goes along, so that what was long under way counts as silence, too.
  function look() {
    const slept = Date.now() - lookedMs > sleptMs;
    lookedMs = Date.now();
    // The clock that is sent may have stood still meanwhile, and a new connection compares it anew;
    // the right to drive is lost by then in any case.
    if (slept) {
      held.clear();
      socket?.close();
      // A page that builds its first scene is busy, and has lost nothing yet.
      if (!heard) heardMs = lookedMs;
      return;
    }
    missed = lookedMs - heardMs > (heard ? silentMs : newMs) ? missed + 1 : 0;
    show();
    // A page that nobody sees says nothing, and so the robot holds, whatever a car would do.
    if (!state.operated || document.hidden) return;
    const now = { keys: [...new Set(held.values())].sort(), pad: pad() }, said = JSON.stringify(now);
    if (said === lastSent && performance.now() - sentMs < sendEveryMs) return;
    lastSent = said;
    sentMs = performance.now();
    send({ ...now, clock: sentMs, saw: sawMark });
  }

  const typing = (target) =>
    target instanceof Element && target.closest("input, textarea, [contenteditable='true']");

  // By the letter that is printed on the key, as the labels say it, wherever the layout has it. Where
  // the layout has other letters (Cyrillic), by the place on an American keyboard; a sign is no letter,
  // but the digits are printed in the same places everywhere, though some layouts want Shift for them.
  const names = { " ": "Space", ".": "Period", ",": "Comma" };
  function meaning(event) {
    if (/^[a-z]$/i.test(event.key)) return `Key${event.key.toUpperCase()}`;
    if (event.code.startsWith("Digit")) return event.code;
    const byPlace = event.key.length > 1 ? event.key !== "Dead" : /^(?!\p{Script=Latin})\p{L}$/u.test(event.key);
    return names[event.key] ?? (byPlace ? event.code : "");
  }

  function down(event) {
    // macOS tells of no key's release while Cmd is held.
    if (event.metaKey || event.key === "Meta") letGo();
    const name = meaning(event), hotkey = settings.hotkeys[name], moves = state.operated && codes.has(name);
    if (!hotkey && !moves) return;
    // Wherever the focus is: who wants to stop the robot does not look where that is.
    const stops = hotkey === "emergency-stop";
    const otherwise = event.ctrlKey || event.metaKey || event.altKey || typing(event.target);
    if (otherwise && !stops) return;
    // Neither viser's camera nor a button that has the focus gets it.
    event.preventDefault();
    event.stopImmediatePropagation();
    caught.add(event.code);
    if (event.repeat) return;
    if (hotkey) order(hotkey);
    else { held.set(event.code, name); look(); }
  }
  function up(event) {
    if (event.key === "Meta") letGo();
    if (held.delete(event.code)) look();
    if (!caught.delete(event.code)) return;
    event.preventDefault();
    event.stopImmediatePropagation();
  }
  // Who looks elsewhere lets go: the key's release would never be heard.
  function letGo() { held.clear(); look(); }
  const hidden = () => { if (document.hidden) letGo(); };

  const RED = "#be1e2d", AMBER = "#b34f00", GREEN = "#007a5a", GREY = "#5c626a";
  function words() {
    if (finished)
      return [`FINISHED. The run has ended${savedIn && `, recorded in ${savedIn}`}; you see its last moment.`, GREY];
    if (otherRun) return ["ANOTHER RUN is at this address now. Open the address that it printed.", RED];
    // Not at the first look: what came while the page itself was busy is heard only after it.
    if (missed > 1)
      return ["CONNECTION LOST. What you see is the past, and nothing that you press is heard. Trying again.", RED];
    const wait = state.left_s == null || state.paused ? "" : ` The ${state.fallback} acts in ${state.left_s} s.`;
    const alone = state.asking && !state.mine && !state.others;
    const old = state.picture_s ? ` The picture is ${state.picture_s} s old.` : "";
    const paused = state.paused ? " Paused: P resumes." : "", more = paused + old;
    const device = padSays && state.mine ? ` ${padSays}` : "";
    if (state.stopped) return [`EMERGENCY STOP. R resets it.${old}`, RED];
    if (state.mine && state.too_old)
      return [`THE PICTURE IS ${state.picture_s} s OLD, so the robot holds until it is young again.${paused}`, AMBER];
    if (state.unready)
      return [`WAITING FOR YOU. H lets the policy begin, T begins with you at the wheel.${more}`, AMBER];
    if (state.abandoned)
      return [`The robot holds, since nobody drives any longer. T takes over, H lets the policy go on.${more}`, AMBER];
    if (alone && state.turn === "fallback")
      return [`Nobody came, so the ${state.fallback} acts. Take over with T.${more}`, AMBER];
    if (alone) return [`The robot holds and asks for you: take over with T.${wait}${more}`, AMBER];
    if (state.others) return [`Another page drives; you watch. Space stops the robot.${more}`, GREY];
    if (state.mine && state.turn !== "operator")
      return [`You have taken over; the robot holds until you move it. H hands back.${more}${device}`, GREEN];
    const ready = state.may_go_on ? "The gate would let the policy go on: H hands back" : "H hands back";
    if (state.mine) return [`You drive. ${ready}, Space stops.${more}${device}`, GREEN];
    if (state.paused) return [`PAUSED. P resumes, . does one step.${old}`, GREY];
    if (state.idle_s > 1)
      return [`BETWEEN EPISODES for ${state.idle_s} s: the program fits or measures, and the robot stands.`, GREY];
    return [state.too_old ? old.trim() : "", AMBER];
  }

  const flags = [["STOP", "■"], ["asks", "▲"], ["WAITING", "▲"], ["LOST", "✕"], ["PAUSED", "‖"], ["FINISHED", "✓"]];
  let shown = "";
  function show() {
    const [text, colour] = words();
    const now = `${state.operated && !finished} ${colour} ${text}`;
    if (now === shown) return;
    shown = now;
    stop.style.display = state.operated && !finished ? "block" : "none";
    banner.style.display = text ? "block" : "none";
    banner.style.background = colour;
    banner.textContent = text;
    const flag = flags.find(([word]) => text.includes(word));
    document.title = `${flag ? `${flag[1]} ` : ""}${settings.title}`;
  }

  function beep() {
    if (!state.asking || state.mine || state.stopped || state.paused) return;
    beeps += 1;
    try {
      audio ??= new AudioContext();
      const tone = audio.createOscillator(), volume = audio.createGain();
      tone.frequency.value = 880;
      volume.gain.value = 0.15;
      tone.connect(volume).connect(audio.destination);
      tone.start();
      tone.stop(audio.currentTime + 0.18);
    } catch { /* A browser without sound still shows the request. */ }
  }

  const timers = [setInterval(look, lookEveryMs), setInterval(beep, 1000)];
  const listening = [
    [window, "keydown", down], [window, "keyup", up],
    [window, "blur", letGo], [document, "visibilitychange", hidden],
  ];
  for (const [target, name, act] of listening) target.addEventListener(name, act, true);
  connect();

  window.sheathOperator = {
    order,
    // Told by a mark in viser's stream, once what was sent before it is shown.
    saw(mark) { sawMark = mark; },
    get state() { return state; },
    get beeps() { return beeps; },
    close() {
      closed = true;
      timers.forEach(clearInterval);
      for (const [target, name, act] of listening) target.removeEventListener(name, act, true);
      for (const each of [banner, stop, style]) each.remove();
      socket?.close();
    },
  };
}
