function (settings) {
  // Sent to each page by the server. Runs again where viser's own connection was lost and is back.
  window.sheathOperator?.close();

  const sendEveryMs = 100, lookEveryMs = 50, retryMs = 500, sleptMs = 4000;
  const codes = new Set(settings.codes), held = new Set(), caught = new Set();
  let socket = null, state = {}, closed = false, lastSent = "", sentMs = 0, lookedMs = Date.now(), beeps = 0, audio = null, sawMark = 0;

  const banner = document.createElement("div");
  banner.id = "sheath-operator";
  banner.setAttribute("role", "status");
  banner.style.cssText =
    "position:fixed;top:14px;left:calc(50vw - 190px);transform:translateX(-50%);z-index:10000;" +
    "display:none;pointer-events:none;padding:.6em 1.4em;border-radius:8px;color:white;text-align:center;" +
    "font:600 18px/1.35 sans-serif;box-shadow:0 2px 14px rgba(0,0,0,.35);max-width:38vw";
  document.body.appendChild(banner);

  const send = (message) => {
    if (socket?.readyState === WebSocket.OPEN) socket.send(JSON.stringify(message));
  };
  // With the number of the newest stop that was shown: a reset clears no other one.
  const order = (name) => send({ order: name, ...(state.stops != null && { seen: state.stops }) });

  function connect() {
    if (closed) return;
    const scheme = location.protocol === "https:" ? "wss" : "ws";
    socket = new WebSocket(`${scheme}://${location.host}${location.pathname.replace(/\/$/, "")}${settings.path}`);
    socket.onopen = () => { send({ station: settings.station }); lastSent = ""; look(); };
    socket.onmessage = (event) => { state = JSON.parse(event.data); show(); };
    socket.onclose = () => { state = {}; show(); if (!closed) setTimeout(connect, retryMs); };
  }

  function pad() {
    const found = [...(navigator.getGamepads?.() ?? [])].find((each) => each?.connected);
    if (!found) return null;
    const axis = (n) => Math.max(-1, Math.min(1, Math.round(1000 * (found.axes[n] ?? 0)) / 1000));
    const buttons = found.buttons.flatMap((each, n) => (each.pressed && n < 32 ? [n] : []));
    return { axes: [0, 1, 2, 3].map(axis), buttons };
  }

  // What is held is sent on change and again and again: the server takes silence for letting go.
  // The clock goes along, so that what was long under way counts as silence, too.
  function look() {
    const slept = Date.now() - lookedMs > sleptMs;
    lookedMs = Date.now();
    // The clock that is sent may have stood still meanwhile, and a new connection compares it anew;
    // the right to drive is lost by then in any case.
    if (slept) { held.clear(); socket?.close(); return; }
    if (!state.operated) return;
    const now = { keys: [...held].sort(), pad: pad() }, said = JSON.stringify(now);
    if (said === lastSent && performance.now() - sentMs < sendEveryMs) return;
    lastSent = said;
    sentMs = performance.now();
    send({ ...now, clock: sentMs, saw: sawMark });
  }

  const typing = (target) =>
    target instanceof Element && target.closest("input, textarea, [contenteditable='true']");

  function down(event) {
    const hotkey = settings.hotkeys[event.code], moves = state.operated && codes.has(event.code);
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
    else { held.add(event.code); look(); }
  }
  function up(event) {
    if (held.delete(event.code)) look();
    if (!caught.delete(event.code)) return;
    event.preventDefault();
    event.stopImmediatePropagation();
  }
  // Who looks elsewhere lets go: the key's release would never be heard.
  function letGo() { held.clear(); look(); }
  const hidden = () => { if (document.hidden) letGo(); };

  function show() {
    const say = (text, colour) => {
      banner.style.display = text ? "block" : "none";
      banner.style.background = colour;
      banner.textContent = text;
    };
    const wait = state.left_s == null ? "" : ` The ${state.fallback} acts in ${state.left_s} s.`;
    const alone = state.asking && !state.mine && !state.others;
    const paused = state.paused ? " Paused: P resumes." : "";
    if (state.stopped) say("EMERGENCY STOP. R resets it.", "#be1e2d");
    else if (state.abandoned)
      say(`The robot holds, since nobody drives any longer. T takes over, H lets the policy go on.${paused}`, "#d55e00");
    else if (alone && state.turn === "fallback")
      say(`Nobody came, so the ${state.fallback} acts. Take over with T.${paused}`, "#d55e00");
    else if (alone) say(`The robot holds and asks for you: take over with T.${wait}${paused}`, "#d55e00");
    else if (state.others) say(`Another page drives; you watch. Space stops the robot.${paused}`, "#6e747c");
    else if (state.mine && state.turn !== "operator")
      say(`You have taken over; the robot holds until you move it. H hands back.${paused}`, "#008764");
    else if (state.mine) say(`You drive. H hands back, Space stops.${paused}`, "#008764");
    else say(paused.trim(), "#6e747c");
  }

  function beep() {
    if (!state.asking || state.mine || state.stopped) return;
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
      banner.remove();
      socket?.close();
    },
  };
}
