"""page.py FOLDER BROWSER PAGE PROGRAM [SVG] - drives the page in a headless browser (DevTools protocol over a pipe) and compares
its numbers with those of the native program. Prints one line of figures; the first thing that is wrong ends it. SVG: only makes the picture of examples/page/README.md."""
import base64, json, os, re, select, subprocess, sys, time

folder, browser, page, program = sys.argv[1:5]


class Browser:
    """One tab. Errors of the console gather in `errors`."""

    def __init__(self):
        to_child, self.out = os.pipe()
        self.into, from_child = os.pipe()

        def as_3_and_4():
            ends = os.dup(to_child), os.dup(from_child)  # neither is 3 or 4 where the others are put
            high = [os.dup(e) if e > 4 else os.dup2(e, e + 20) for e in ends]
            os.dup2(high[0], 3)
            os.dup2(high[1], 4)

        self.process = subprocess.Popen(
            [browser, "--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--hide-scrollbars",
             "--remote-debugging-pipe", "--user-data-dir=" + os.path.abspath(folder) + "/profile", "about:blank"],
            preexec_fn=as_3_and_4, close_fds=False, start_new_session=True, stdout=subprocess.DEVNULL, stderr=open(folder + "/browser.txt", "w"))
        os.close(to_child)
        os.close(from_child)
        self.number, self.rest, self.session, self.errors, self.loaded = 0, b"", None, [], False
        target = next(t for t in self.call("Target.getTargets")["targetInfos"] if t["type"] == "page")
        self.session = self.call("Target.attachToTarget", targetId=target["targetId"], flatten=True)["sessionId"]
        for domain in "Runtime", "Log", "Page", "Accessibility":
            self.call(domain + ".enable")

    def receive(self, seconds):
        end = time.monotonic() + seconds
        while b"\0" not in self.rest:
            ready = select.select([self.into], [], [], max(0, end - time.monotonic()))[0]
            got = os.read(self.into, 1 << 20) if ready else b""
            if not got:
                wrong("the browser does not answer")
            self.rest += got
        message, self.rest = self.rest.split(b"\0", 1)
        message = json.loads(message)
        method, params = message.get("method"), message.get("params", {})
        if method == "Runtime.exceptionThrown":
            details = params["exceptionDetails"]
            self.errors.append(details.get("exception", {}).get("description", details["text"]))
        elif method == "Runtime.consoleAPICalled" and params["type"] in ("error", "assert", "warning"):
            self.errors.append(str(params["args"]))
        elif method == "Log.entryAdded" and params["entry"]["level"] in ("error", "warning"):
            self.errors.append(params["entry"]["text"])
        elif method == "Page.loadEventFired":
            self.loaded = True
        return message

    def call(self, method, **params):
        self.number += 1
        message = {"id": self.number, "method": method, "params": params}
        if self.session:
            message["sessionId"] = self.session
        os.write(self.out, json.dumps(message).encode() + b"\0")
        while True:
            answer = self.receive(60)
            if answer.get("id") == self.number:
                if "error" in answer:
                    wrong(method + ": " + str(answer["error"]))
                return answer["result"]

    def run(self, script):
        result = self.call("Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in result:
            wrong(script + ": " + str(result["exceptionDetails"]))
        return result["result"].get("value")

    def press(self, key, code, text=None):
        for kind in "keyDown", "keyUp":
            extra = {"text": text} if text and kind == "keyDown" else {}
            self.call("Input.dispatchKeyEvent", type=kind, key=key, code=key if key != " " else "Space",
                      windowsVirtualKeyCode=code, **extra)

    def open(self, address):
        self.loaded = False
        self.call("Page.navigate", url=address)
        while not self.loaded:
            self.receive(30)
        for _ in range(300):
            if self.run("typeof run === 'object' && run.duration > 0"):
                return
            time.sleep(0.1)
        wrong("the page does not start: " + str(self.errors))

    def size(self, width, height):
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)

    def picture(self, name):
        data = self.call("Page.captureScreenshot", captureBeyondViewport=True)["data"]
        open(folder + "/" + name, "wb").write(base64.b64decode(data))


def processor_ms(session):
    """Milliseconds of processor that the processes of a session have had."""
    ticks = 0
    for entry in filter(str.isdigit, os.listdir("/proc")):
        try:
            fields = open(f"/proc/{entry}/stat").read().rsplit(")", 1)[1].split()
        except OSError:  # it has ended
            continue
        ticks += int(fields[11]) + int(fields[12]) if int(fields[3]) == session else 0
    return 1000 * ticks / os.sysconf("SC_CLK_TCK")


def wrong(what):
    print(what)
    sys.exit(1)


SETTLE = "run.timed = 37; while (busy()) work(); work(); draw(); "
OUTPUTS = ("({body: [...numbers(lib.page_output(BODY), 3 * run.body)], exact: [...numbers(lib.page_output(EXACT), 3 * exactDone())],"
           " steps: lib.page_body_steps(), error: lib.page_error(Math.min(run.body, exactDone())), shown: $('error').textContent,"
           " status: text(lib.page_status_text(run.status)), says: $('says').textContent, drive: drive(), stiffness: stiffness(),"
           " share: share(), effects: effects()})")


def native(scene, got, modes, integrator):
    out = subprocess.run([program, "--compare", "no" if scene else "yes", "--scene", str(scene), "--drive", repr(got["drive"]), "--stiffness", repr(got["stiffness"]),
                          "--modes", str(modes), "--effects", str(got["effects"]), "--integrator", integrator,
                          "--step", repr(got["share"])], stdout=subprocess.PIPE)
    if out.returncode:
        wrong(f"the program, scene {scene}: exit status {out.returncode}")
    return json.loads(out.stdout)


def difference(a, b):
    """Largest, of the largest of b; 0: the same numbers."""
    if len(a) != len(b):
        wrong(f"{len(a)} numbers of the page, {len(b)} of the program")
    return max(abs(x - y) for x, y in zip(a, b)) / max(map(abs, b)) if a != b else 0


def change(tab, control, value):
    tab.run(f"$('{control}').value = '{value}'; $('{control}').dispatchEvent(new Event('input', {{bubbles: true}}));"
            f"$('{control}').dispatchEvent(new Event('change', {{bubbles: true}}))")


def portrait(tab, name):
    """The upper part of the page, some settings tried, as a picture in an SVG: text, as all files are."""
    size = 1280, 1130
    settle = SETTLE.replace("run.timed = 37; ", "")
    time.sleep(10)  # the browser's compiler takes its time
    for modes, box in (1, None), (2, None), (3, None), (6, None), (3, 5), (3, 5), (3, 2), (3, 3), (3, 4), (3, 1):
        change(tab, "modes", modes)
        tab.run((f"$('effect{box}').click();" if box else "") + settle)
    for k in range(1, 5):
        tab.run(f"$('effect{k}').checked || $('effect{k}').click()")
    tab.run(settle + "play(false); view.time = 7; draw()")
    data = tab.call("Page.captureScreenshot", format="webp", quality=60, clip={"x": 0, "y": 0, "width": size[0], "height": size[1], "scale": 0.75})
    with open(name, "w") as file:
        file.write('<svg xmlns="http://www.w3.org/2000/svg" width="960" viewBox="0 0 %d %d"><title>the page</title><image width="%d" height="%d" '
                   'href="data:image/webp;base64,\n' % (*size, *size))
        text = data["data"]
        file.write("\n".join(text[k:k + 120] for k in range(0, len(text), 120)) + '"/></svg>\n')


def main():
    tab = Browser()
    tab.size(1280, 1000)
    tab.open("file://" + os.path.abspath(page))

    if len(sys.argv) > 5:
        portrait(tab, sys.argv[5])
        return

    # Frames while both models compute, of some tries the best. Where other programs keep the processors busy: by the
    # processor's time that a frame takes, of which there are two times 33 ms at 30 frames a second.
    frames, cost = 0, 1e9
    for _ in range(5):
        change(tab, "scene", 4)
        before = processor_ms(tab.process.pid)
        n, seconds = tab.run("new Promise(done => { let n = 0; const begin = performance.now(); const count = now => now - begin > "
                             "1000 ? done([n, (now - begin) / 1000]) : (n++, requestAnimationFrame(count)); requestAnimationFrame(count); })")
        frames, cost = max(frames, n / seconds), min(cost, (processor_ms(tab.process.pid) - before) / n)
        if frames > 40:
            break
    if not tab.run("run.judge > 0 && view.playing"):
        wrong("nothing is computed between the frames")
    if frames < 30 and cost > 33:
        wrong(f"{frames:.0f} frames a second, each {cost:.0f} ms of processor time")

    # Every scene, the page's numbers beside the program's.
    scenes = tab.run("lib.page_scenes()")
    same, worst, drawn = 0, 0, set()
    cases = [(k, 3, "rk4", None) for k in range(scenes)]
    cases += [(0, 2, "exponential", None), (0, 3, "midpoint", ("stiffness", -0.2)), (3, 1, "sdirk", ("drive", 1)),
              (5, 3, "rk4", ("large", 1))]
    for scene, modes, integrator, more in cases:
        change(tab, "scene", scene)
        change(tab, "modes", modes)
        change(tab, "integrator", ["rk4", "midpoint", "sdirk", "exponential"].index(integrator))
        if more and more[0] != "large":
            change(tab, *more)
        elif more:
            tab.run("$('effect5').click()")
        got = tab.run(SETTLE + OUTPUTS)
        want = native(scene, got, modes, integrator)
        if got["status"] != want["body"] or got["steps"] != want["steps"]:
            wrong(f"scene {scene}: {got['status']}, {got['steps']} steps; the program {want['body']}, {want['steps']}")
        apart = difference(got["body"], want["body_output"]), difference(got["exact"], want["exact_output"])
        same += sum(a == 0 for a in apart)
        worst = max(worst, *apart)
        if worst > 1e-12:
            wrong(f"scene {scene}, {modes} modes, {integrator}: the page is {apart} from the program")
        if not abs(float(got["shown"].split()[0]) / 100 / want["error"] - 1) < 5e-3:
            wrong(f"scene {scene}: the page shows {got['shown']}, the program {want['error']}")
        if "error" not in got["says"] or "per step" not in got["says"]:
            wrong(f"scene {scene}: the page says {got['says']!r}")
        drawn.add(tab.run("$('picture').toDataURL()"))
    if len(drawn) != len(cases):
        wrong("pictures of different settings are alike")
    tab.run("$('effect5').click()")

    # By keyboard alone: each slider acts, switches and the button, too.
    change(tab, "scene", 0)
    before = tab.run(SETTLE + OUTPUTS)
    for control in "drive", "stiffness", "modes", "share":
        tab.run(f"$('{control}').focus()")
        for _ in range(4 if control == "share" else 1):  # whole steps between samples
            tab.press("ArrowLeft", 37)
        after = tab.run(SETTLE + OUTPUTS)
        if after["body"] == before["body"]:
            wrong(f"the slider {control} does nothing by the keyboard")
        before = after
    for k in range(5):
        tab.run(f"$('effect{4 - k}').focus()")
        tab.press(" ", 32, " ")
        after = tab.run(SETTLE + OUTPUTS)
        if after["effects"] == before["effects"]:
            wrong(f"switch {4 - k} does nothing by the keyboard")
        if after["effects"] == 7 and not tab.run("$('half').textContent"):
            wrong("half an effect is not told")
        before = after
    if before["effects"] or abs(before["error"] - 1) > 1e-9:
        wrong(f"without effects the error is {before['error']}, not that of a rigid body")
    for k in range(5):
        tab.run(f"$('effect{k}').click()")
    tab.run("$('play').focus()")
    for playing in False, True:
        tab.press("Enter", 13, "\r")
        if tab.run("view.playing") != playing:
            wrong("the button does nothing by the keyboard")
    order = tab.run("[...document.querySelectorAll('input, select, button, pre, summary')].filter(e => e.tabIndex < 0).length")
    if order:
        wrong("controls that the tabulator does not reach")

    # A setting that diverges is told.
    change(tab, "integrator", 0)
    change(tab, "modes", 6)
    change(tab, "share", 3)
    got = tab.run(SETTLE + OUTPUTS)
    if got["status"] == "ok" or "stops after" not in got["says"]:
        wrong(f"an unstable step: {got['status']}: {got['says']!r}")
    change(tab, "share", 0)
    tab.run(SETTLE)
    if tab.run("tried.length && $('tried').tBodies[0].rows.length") < 3:
        wrong("settings tried leave no points")

    # Names for screen readers.
    roles = {"slider": 5, "combobox": 4, "checkbox": 6, "button": 1, "image": 3, "progressbar": 1, "table": 1, "status": 1}
    for node in tab.call("Accessibility.getFullAXTree")["nodes"]:
        role, name = node.get("role", {}).get("value"), node.get("name", {}).get("value", "")
        role = "image" if role == "img" else role
        if not node.get("ignored") and role in roles:
            roles[role] -= 1
            if not name and role not in ("table", "status"):
                wrong(f"a {role} has no name")
    if any(left > 0 for left in roles.values()):
        wrong(f"screen readers do not find all of it: {roles}")

    # Widths, light and dark.
    for width in 400, 800, 1280:
        tab.size(width, 900)
        tab.run("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")
        wide = tab.run("document.documentElement.scrollWidth")
        if wide > width:
            wrong(f"{wide} pixels at a width of {width}")
        for scheme in "light", "dark":
            tab.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": scheme}])
            tab.run("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")
            tab.picture(f"{scheme}{width}.png")

    # Who wants less motion gets none until it is asked for.
    tab.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-reduced-motion", "value": "reduce"}])
    tab.open("file://" + os.path.abspath(page))
    if tab.run("view.playing"):
        wrong("it moves in spite of prefers-reduced-motion")

    # The C that it shows compiles.
    programs = []
    for scene, integrator in (0, 0), (3, 1), (6, 3), (1, 2):
        change(tab, "scene", scene)
        change(tab, "integrator", integrator)
        programs.append(tab.run("$('code').textContent"))
    for k, code in enumerate(programs):
        open(f"{folder}/shown{k}.c", "w").write(code + "\n")
        done = subprocess.run(["cc", "-std=c99", "-Wall", "-Wextra", "-Werror", "-I.", "-fsyntax-only", f"{folder}/shown{k}.c"],
                              stderr=subprocess.PIPE, text=True)
        if done.returncode:
            wrong(done.stderr)

    if tab.errors:
        wrong("the console has errors: " + "; ".join(tab.errors))
    if re.search(r"(src|href)=\"(?!data:)|https?://|url\(", re.sub(r"<script type=.*?</script>", "", open(page).read(), flags=re.S)):
        wrong("the page wants other files")
    try:
        tab.call("Browser.close")
    except SystemExit:
        pass
    tab.process.wait(20)
    print(f"{scenes} scenes, {len(cases)} settings: {same} of {2 * len(cases)} histories have the program's bits, the others are "
          f"within {worst:.0e}; {frames:.0f} frames a second while it computes, {cost:.0f} ms of a processor each; {os.path.getsize(page) // 1024} kB")


main()
