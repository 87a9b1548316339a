function (settings) {
  // Sent to each page by the server. A click on a strip, a plot or a row shows that step; in a recording
  // so do the keys of video editors: J K L, arrows, space, and M for a note.
  window.sheathSeek?.close();
  let socket = null, closed = false, pending = null, box = null;

  const here = `${location.host}${location.pathname.replace(/\/$/, "")}`;
  function connect() {
    if (closed) return;
    socket = new WebSocket(`${location.protocol === "https:" ? "wss" : "ws"}://${here}${settings.path}`);
    socket.onclose = () => setTimeout(connect, 1000);
  }
  const send = (message) => {
    if (socket?.readyState === WebSocket.OPEN) socket.send(JSON.stringify(message));
  };

  // A plot is viser's own; the text before it says which steps it spans.
  function spanOf(target) {
    const strip = target.closest("[data-sheath-span]");
    if (strip) return [strip, strip.dataset.sheathSpan];
    const plot = target.closest(".u-over");
    if (!plot) return null;
    const before = [...document.querySelectorAll("[data-sheath-plot]")].filter(
      (each) => each.compareDocumentPosition(plot) & Node.DOCUMENT_POSITION_FOLLOWING);
    return before.length ? [plot, before.at(-1).dataset.sheathPlot] : null;
  }
  function seek(event) {
    const [place, span] = pending, [first, count] = span.split(" ").map(Number);
    const share = Math.max(0, Math.min(0.99999, (event.clientX - place.left) / place.width));
    send({ step: Math.floor(first + share * count) });
  }
  function down(event) {
    if (event.button !== 0 || !(event.target instanceof Element)) return;
    const found = spanOf(event.target);
    // Its place of now: a strip is another element as soon as it is drawn again.
    pending = found && [found[0].getBoundingClientRect(), found[1]];
    if (pending) return seek(event);
    const row = event.target.closest("[data-sheath-step], [data-sheath-episode]");
    if (row?.dataset.sheathStep) send({ step: Number(row.dataset.sheathStep) });
    else if (row) send({ episode: Number(row.dataset.sheathEpisode) });
  }
  const move = (event) => { if (pending && event.buttons & 1) seek(event); };
  const up = () => { pending = null; };

  const typing = (target) =>
    target instanceof Element && target.closest("input, textarea, [contenteditable='true']");
  // A slider or a tab that has the focus goes by the arrows itself.
  const goes = (target) => target instanceof Element && target.closest("[role='slider'], [role='tab']");
  const keys = {
    " ": { key: "toggle" }, k: { key: "stop" }, j: { key: "backwards" }, l: { key: "forwards" },
    ArrowLeft: { nudge: -1 }, ArrowRight: { nudge: 1 }, ArrowUp: { key: "before" }, ArrowDown: { key: "after" },
    Home: { step: 0 }, End: { step: 1e8 },
  };
  function press(event) {
    if (!settings.keys || event.ctrlKey || event.metaKey || event.altKey || typing(event.target)) return;
    // What lies over the page has keys of its own.
    if (document.querySelector("dialog[open]")) return;
    const name = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    let message = keys[name];
    if (!message && name !== "m") return;
    if (name.length > 1 && goes(event.target)) return;
    // Neither viser's camera nor a button that has the focus gets it.
    event.preventDefault();
    event.stopImmediatePropagation();
    if (name === "m") return ask();
    if (message.nudge && event.shiftKey) message = { nudge: 10 * message.nudge };
    send(message);
  }

  function ask() {
    if (box) return;
    send({ key: "stop" });
    box = document.createElement("form");
    box.id = "sheath-note";
    box.style.cssText = "position:fixed;left:50%;top:40%;transform:translate(-50%,-50%);z-index:10002;background:white;" +
      "color:#22272e;padding:1em 1.2em;border-radius:8px;box-shadow:0 2px 18px rgba(0,0,0,.4);font:16px/1.5 sans-serif";
    const label = document.createElement("label"), field = document.createElement("input");
    label.textContent = "A note of this step (empty takes one away) ";
    field.maxLength = settings.longest;
    field.style.cssText = "display:block;width:24em;max-width:80vw;font:inherit";
    label.append(field);
    box.append(label);
    box.onsubmit = (event) => { event.preventDefault(); send({ note: field.value }); leave(); };
    field.onkeydown = (event) => { if (event.key === "Escape") leave(); };
    document.body.append(box);
    field.focus();
  }
  function leave() { box?.remove(); box = null; }

  const listening = [
    [window, "pointerdown", down], [window, "pointermove", move], [window, "pointerup", up],
    [window, "keydown", press],
  ];
  for (const [target, name, act] of listening) target.addEventListener(name, act, true);
  const style = document.createElement("style");
  style.textContent = "[data-sheath-span], [data-sheath-step], [data-sheath-episode], .u-over { cursor: pointer }";
  document.head.append(style);
  connect();

  window.sheathSeek = {
    send,
    get open() { return socket?.readyState === WebSocket.OPEN; },
    close() {
      closed = true;
      for (const [target, name, act] of listening) target.removeEventListener(name, act, true);
      style.remove();
      leave();
      socket?.close();
    },
  };
}
