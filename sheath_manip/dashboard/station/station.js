// Runs again where viser's own connection was lost and is back.
const reopened = Boolean(window.sheathOperator);
window.sheathOperator?.close();
// viser's own addition to the address, which tells nothing new.
if (location.search) history.replaceState(null, "", location.pathname);

const sendEveryMs = 100, lookEveryMs = 50, retryMs = 500, sleptMs = 4000, silentMs = 2000, newMs = 5000;
const codes = new Set(settings.guide.flatMap((each) => each.codes)), held = new Map();
const link = { finished: false, otherRun: false, lost: false, savedIn: "", padSays: "" };
let socket = null, state = {}, closed = false, lastSent = "", sentMs = 0, lookedMs = Date.now();
let sawMark = 0, heardMs = Date.now(), heard = reopened, missed = 0, text = "", operated = false;

const style = document.createElement("style");
style.textContent = settings.style;
document.head.appendChild(style);

const send = (message) => {
  if (socket?.readyState === WebSocket.OPEN) socket.send(JSON.stringify(message));
};
// With the number of the newest stop that was shown: a reset clears no other one. So the episode's:
// who ends it as it ends by itself does not end the next.
// Where nothing runs any longer there is nothing to order, but for what is never refused.
const order = (name, value) => {
  if (state.over && name !== "emergency-stop") return;
  const { stops: seen, robot, episode } = state;
  send({ order: name, ...(seen != null && { seen, episode }), ...(robot && { robot }), ...(value != null && { value }) });
};
const hold = (source, name) => { held.set(source, name); look(); };
const release = (source) => { if (held.delete(source)) look(); };
const letGo = () => { held.clear(); look(); };

const here = `${location.host}${location.pathname.replace(/\/$/, "")}`;
const socketAt = (path) => `${location.protocol === "https:" ? "wss" : "ws"}://${here}${path}`;
const labels = makeLabels(() => deck.name());
const deck = makeDeck({ guide: settings.guide, labels, order, hold, release });
const robots = makeRobots({ order, path: socketAt(settings.pictures) });
const notice = makeNotice(settings.title), attention = makeAttention(deck.corner), unname = keepNamed();
const dark = matchMedia("(prefers-color-scheme: dark)"), narrow = matchMedia("(max-width: 1199px)");
const introduce = () => send({ station: settings.station, dark: dark.matches, narrow: narrow.matches });

function connect() {
  if (closed || link.otherRun || link.finished) return;
  socket = new WebSocket(socketAt(settings.path));
  socket.onopen = () => { introduce(); lastSent = ""; look(); };
  socket.onmessage = (event) => {
    state = JSON.parse(event.data);
    link.finished ||= Boolean(state.finished);
    link.savedIn ||= state.saved_in ?? "";
    heardMs = Date.now();
    heard = true;
    operated ||= Boolean(state.operated);
    missed = 0;
    show();
  };
  socket.onclose = async () => {
    held.clear();
    state = {};
    show();
    if (closed || link.finished) return;
    // Another run at this address knows neither this page's path nor its cookie.
    link.otherRun = await fetch(location.pathname).then((answer) => answer.status === 401, () => false);
    show();
    setTimeout(connect, retryMs);
  };
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
  const keys = [...new Set(held.values())].sort();
  deck.light(keys);
  show();
  // A page that nobody sees says nothing, and so the robot holds, whatever a car would do.
  if (!state.operated || document.hidden) return;
  const { pad, says } = readPad();
  link.padSays = says;
  const now = { keys, pad }, said = JSON.stringify(now);
  if (said === lastSent && performance.now() - sentMs < sendEveryMs) return;
  lastSent = said;
  sentMs = performance.now();
  send({ ...now, clock: sentMs, saw: sawMark });
}

function show() {
  // Not at the first look: what came while the page itself was busy is heard only after it.
  link.lost = missed > 1;
  const words = fleetWords(state, noticeWords(state, link, labels));
  text = words[0];
  notice.show(words);
  // STOP stays where it is also while a connection is made anew.
  deck.show(state, operated && !link.finished);
  robots.show(state, !link.finished);
}

const timers = [
  setInterval(look, lookEveryMs),
  setInterval(() => attention.call(wantsSomebody(state), text), 1000),
];
const drives = (name) => Boolean(state.operated && codes.has(name));
const listening = listenToKeys({ hotkeys: settings.hotkeys, order, hold, release, letGo, drives });
listening.push([dark, "change", introduce], [narrow, "change", introduce]);
for (const [target, name, act] of listening) target.addEventListener(name, act, true);
connect();

window.sheathOperator = {
  order,
  // Told by a mark in viser's stream, once what was sent before it is shown.
  saw(mark) { sawMark = mark; },
  get state() { return state; },
  get beeps() { return attention.beeps; },
  close() {
    closed = true;
    timers.forEach(clearInterval);
    for (const [target, name, act] of listening) target.removeEventListener(name, act, true);
    for (const each of [notice, deck, robots, style]) each.remove();
    unname();
    attention.close();
    socket?.close();
  },
};
