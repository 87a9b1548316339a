// Calls a person who looks elsewhere: by a tone each second, and where the browser was allowed to by a
// notice of the system, for which it is asked once. Either can be turned off.
const askedBefore = "sheath-notices-asked", quietBefore = "sheath-quiet";

function remembered(name, value) {
  try {
    if (value !== undefined) localStorage.setItem(name, value);
    return localStorage.getItem(name);
  } catch { return null; /* A browser that keeps nothing asks again. */ }
}

function makeAttention(corner) {
  let beeps = 0, audio = null, called = false, note = null, quiet = remembered(quietBefore) === "yes";
  const button = (id) => {
    const made = document.createElement("button");
    made.id = id;
    made.className = "sheath-small";
    corner.appendChild(made);
    return made;
  };
  const sound = button("sheath-sound"), ask = button("sheath-notices");
  const maySay = () => "Notification" in window && window.isSecureContext;
  function draw() {
    sound.textContent = quiet ? "Sound off" : "Sound on";
    sound.setAttribute("aria-pressed", String(!quiet));
    ask.textContent = "Notify me when the robot asks";
    ask.hidden = !maySay() || Notification.permission !== "default" || remembered(askedBefore) === "yes";
  }
  sound.onclick = () => { quiet = !quiet; remembered(quietBefore, quiet ? "yes" : "no"); draw(); };
  ask.onclick = () => { remembered(askedBefore, "yes"); draw(); Notification.requestPermission().then(draw, draw); };
  draw();

  function tone() {
    beeps += 1;
    if (quiet) return;
    try {
      audio ??= new AudioContext();
      audio.resume();
      const wave = audio.createOscillator(), volume = audio.createGain();
      wave.frequency.value = 880;
      volume.gain.value = 0.15;
      wave.connect(volume).connect(audio.destination);
      wave.start();
      wave.stop(audio.currentTime + 0.18);
    } catch { /* A browser without sound still shows the request. */ }
  }

  return {
    get beeps() { return beeps; },
    // To be called each second.
    call(wanted, text) {
      if (wanted) tone();
      if (wanted && !called && maySay() && Notification.permission === "granted" && !document.hasFocus())
        note = new Notification("The robot asks for you", { body: text, tag: "sheath" });
      if (!wanted) note?.close();
      called = wanted;
    },
    close: () => note?.close(),
  };
}
