// The strip of robots, where there are several: how each is, in words, and a small picture of what it sees.
// A click chooses the one that is shown, and so served.
function makeRobots({ order, path }) {
  const strip = document.createElement("div"), tiles = new Map();
  strip.id = "sheath-robots";
  strip.setAttribute("role", "group");
  strip.setAttribute("aria-label", "Robots");
  document.body.append(strip);
  let socket = null, closed = false;

  function tileOf(number) {
    if (tiles.has(number)) return tiles.get(number);
    const button = document.createElement("button"), picture = document.createElement("img");
    const name = document.createElement("b"), words = document.createElement("span");
    name.textContent = `Robot ${number}`;
    picture.alt = `What robot ${number} sees`;
    picture.hidden = true;
    // Keys go to the robot, not to the tile that was clicked.
    button.onclick = () => { order("choose-robot", number); button.blur(); };
    button.append(picture, name, words);
    strip.append(button);
    const tile = { button, picture, words };
    tiles.set(number, tile);
    return tile;
  }

  // Opened only where there are several; the next pictures come once these were shown.
  function connect() {
    if (closed) return;
    socket = new WebSocket(path);
    socket.onmessage = (event) => {
      for (const [number, address] of Object.entries(JSON.parse(event.data))) {
        const { picture } = tileOf(Number(number));
        picture.src = address;
        picture.hidden = false;
      }
      socket.send("seen");
    };
    socket.onclose = () => setTimeout(connect, 1000);
  }

  return {
    show(state, live) {
      const robots = (live && state.robots) || [];
      strip.style.display = robots.length ? "" : "none";
      document.body.classList.toggle("sheath-fleet", robots.length > 0);
      if (robots.length && !socket) connect();
      for (const { number, does, words } of robots) {
        const tile = tileOf(number), shown = number === state.robot, said = words.replace(/(\d) s$/, "$1\u00a0s");
        if (tile.words.textContent !== said) tile.words.textContent = said;
        tile.button.dataset.does = does;
        tile.button.setAttribute("aria-pressed", String(shown));
        tile.button.title = shown ? "This robot is shown" : `Show robot ${number}`;
      }
    },
    remove() { closed = true; socket?.close(); strip.remove(); },
  };
}

// The notice of the robot that is shown, by its name, and how many others wait for the person.
function fleetWords(state, [text, colour, percent]) {
  if (!state.robot || !text || state.finished) return [text, colour, percent];
  const others = state.robots.filter((it) => it.does === "asks" && it.number !== state.robot).length;
  const more = others && !state.stopped ? ` ${others === 1 ? "One more waits" : `${others} more wait`}.` : "";
  if (state.stopped) return [text.replace("EMERGENCY STOP", "EMERGENCY STOP of all robots"), colour, percent];
  const said = text.replace(/^The robot /, "").replace("lets the policy begin", "lets all robots begin");
  return [`Robot ${state.robot}${text.startsWith("The robot ") ? " " : ": "}${said}${more}`, colour, percent];
}
