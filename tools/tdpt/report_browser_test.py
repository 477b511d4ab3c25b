"""report_browser_test.py FOLDER PAGE...: opens reports in a headless Chromium, at three widths, light and dark.

Nothing may be wider than the window, the console stays empty, nothing is fetched, headings do not skip a level and words
stand out from their ground. Screenshots and a PDF, as printed, are left in FOLDER to be looked at. It speaks the DevTools
protocol over the pipe of --remote-debugging-pipe, so Python's standard library is enough. Exit 77 without Chromium.
"""

import base64
import json
import os
import shutil
import subprocess
import sys
import tempfile

CHECK = """(() => {
  const wrong = [];
  if (!document.querySelector('main section')) wrong.push('is no report');
  const wide = document.documentElement.scrollWidth;
  if (wide > innerWidth) {
    const widest = [...document.querySelectorAll('body *')].filter(e => e.getBoundingClientRect().right > innerWidth + 1 &&
      !e.parentElement.closest('.scroll')).slice(0, 3).map(e => e.tagName + '.' + e.className.baseVal + e.className);
    wrong.push('is ' + wide + ' pixels wide in a window of ' + innerWidth + ': ' + widest.join(', '));
  }
  let level = 0;
  for (const h of document.querySelectorAll('h1,h2,h3,h4')) {
    const now = +h.tagName[1];
    if (now > level + 1) wrong.push('heading "' + h.textContent + '" skips a level');
    level = now;
  }
  for (const i of document.images) if (!i.complete || !i.naturalWidth) wrong.push('a picture is broken: ' + i.alt);
  // Contrast as WCAG 2 has it, of all words on the nearest ground that is painted.
  const parse = c => { const m = c.match(/[\\d.]+/g).map(Number); return m.length < 4 ? [...m, 1] : m; };
  const light = c => { const [r, g, b] = c.map(v => { v /= 255; return v <= .03928 ? v / 12.92 : ((v + .055) / 1.055) ** 2.4; });
    return .2126 * r + .7152 * g + .0722 * b; };
  const seen = new Set();
  const walk = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  for (let n; n = walk.nextNode();) {
    const e = n.parentElement;
    if (!n.data.trim() || !e.checkVisibility() || e.closest('title')) continue;
    const s = getComputedStyle(e), words = parse(e.closest('svg') ? s.fill : s.color);
    let ground = null;
    for (let p = e; p && !ground; p = p.parentElement) { const b = parse(getComputedStyle(p).backgroundColor); if (b[3] > 0) ground = b; }
    if (!ground) { wrong.push('no ground is painted'); break; }
    const a = light(words), b = light(ground), ratio = (Math.max(a, b) + .05) / (Math.min(a, b) + .05);
    const key = s.color + ground;
    if (ratio < 4.5 && !seen.has(key)) { seen.add(key); wrong.push('contrast ' + ratio.toFixed(2) + ' of "' + n.data.trim().slice(0, 30) + '"'); }
    if (parseFloat(s.fontSize) * (e.closest('svg') ? e.closest('svg').getBoundingClientRect().width / e.closest('svg').viewBox.baseVal.width : 1) < 10)
      wrong.push('small words: ' + n.data.trim().slice(0, 30));
  }
  return JSON.stringify({wrong, height: document.documentElement.scrollHeight});
})()"""


class Browser:
    def __init__(self, program, profile):
        to_read, self.to = os.pipe()
        self.back, back_write = os.pipe()
        # Chromium reads from 3 and writes to 4.
        self.child = subprocess.Popen(
            ["sh", "-c", f'exec "$@" 3<&{to_read} 4>&{back_write}' if to_read > 9 or back_write > 9 else
             f'exec 8<&{to_read} 9>&{back_write}; exec "$@" 3<&8 4>&9', "sh", program, "--headless=new", "--remote-debugging-pipe",
             "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--no-first-run", "--disable-dev-shm-usage",
             "--disable-background-networking", f"--user-data-dir={profile}", "about:blank"],
            pass_fds=(to_read, back_write), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(to_read)
        os.close(back_write)
        self.last, self.kept, self.events, self.session = 0, b"", [], None

    def message(self):
        while b"\0" not in self.kept:
            data = os.read(self.back, 1 << 20)
            if not data:
                raise RuntimeError("Chromium has ended")
            self.kept += data
        one, self.kept = self.kept.split(b"\0", 1)
        return json.loads(one)

    def ask(self, method, **parameters):
        self.last += 1
        request = {"id": self.last, "method": method, "params": parameters}
        if self.session:
            request["sessionId"] = self.session
        data = json.dumps(request).encode() + b"\0"
        while data:
            data = data[os.write(self.to, data):]
        while True:
            answer = self.message()
            if answer.get("id") == self.last:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']}")
                return answer["result"]
            self.events.append(answer)

    def wait(self, method):
        while True:
            for event in self.events:
                if event.get("method") == method:
                    return
            self.events.append(self.message())

    def evaluate(self, expression):
        return self.ask("Runtime.evaluate", expression=expression, returnByValue=True)["result"].get("value")


def look(browser, page, folder):
    wrong, stem = [], os.path.join(folder, os.path.basename(page).replace(".report.html", ""))
    address = "file://" + os.path.abspath(page)
    for width in (400, 1000, 1600):
        for scheme in ("light", "dark"):
            where = f"{os.path.basename(page)}, {width} pixels, {scheme}"
            browser.events = []
            browser.ask("Emulation.setDeviceMetricsOverride", width=width, height=900, deviceScaleFactor=1, mobile=False)
            browser.ask("Emulation.setEmulatedMedia", media="screen", features=[{"name": "prefers-color-scheme", "value": scheme}])
            answer = browser.ask("Page.navigate", url=address)
            if answer.get("errorText"):
                return [f"{page}: {answer['errorText']}"]
            browser.wait("Page.loadEventFired")
            # As it opens, and with all that can be unfolded.
            for state in ("closed", "open"):
                if state == "open":
                    browser.evaluate("document.querySelectorAll('details').forEach(d => d.open = true)")
                told = json.loads(browser.evaluate(CHECK))
                wrong += [f"{where}, {state}: {words}" for words in told["wrong"]]
                shot = browser.ask("Page.captureScreenshot", captureBeyondViewport=True, clip={
                    "x": 0, "y": 0, "width": width, "height": min(told["height"], 16000), "scale": 1})
                with open(f"{stem}.{width}.{scheme}{'.open' if state == 'open' else ''}.png", "wb") as stream:
                    stream.write(base64.b64decode(shot["data"]))
            for event in browser.events:
                method, what = event.get("method"), event.get("params", {})
                if method == "Log.entryAdded":
                    wrong.append(f"{where}: the console has {what['entry']['text']}")
                elif method in ("Runtime.consoleAPICalled", "Runtime.exceptionThrown"):
                    wrong.append(f"{where}: a script ran")
                elif method == "Network.requestWillBeSent":
                    url = what["request"]["url"]
                    if not url.startswith("data:") and url != address:
                        wrong.append(f"{where}: {url[:80]} is fetched")
    printed = browser.ask("Page.printToPDF", printBackground=False, paperWidth=8.27, paperHeight=11.69)
    with open(f"{stem}.pdf", "wb") as stream:
        stream.write(base64.b64decode(printed["data"]))
    return wrong


def main():
    if len(sys.argv) < 3:
        print("usage: report_browser_test.py FOLDER PAGE...", file=sys.stderr)
        return 2
    program = shutil.which("chromium") or shutil.which("chromium-browser")
    if not program:
        print("skipped: chromium is missing (cmake/packages-report.txt)")
        return 77
    folder = sys.argv[1]
    os.makedirs(folder, exist_ok=True)
    wrong = []
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        browser = Browser(program, profile)
        try:
            target = browser.ask("Target.createTarget", url="about:blank")["targetId"]
            browser.session = browser.ask("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
            for domain in ("Page", "Runtime", "Log", "Network"):
                browser.ask(domain + ".enable")
            for page in sys.argv[2:]:
                wrong += look(browser, page, folder)
        finally:
            browser.child.terminate()
            browser.child.wait()
    # A page has the same fault at several widths.
    for words in dict.fromkeys(wrong):
        print(words)
    if not wrong:
        print(f"{len(sys.argv) - 2} pages, 3 widths, light and dark: as they should be; screenshots in {folder}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
