"""browser.py: Chromium without a screen, driven through its pipe for debugging: opens a page, runs scripts, moves the pointer."""
import base64
import json
import os
import subprocess
import tempfile

FLAGS = ("--headless=new", "--no-sandbox", "--disable-gpu-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
         "--hide-scrollbars", "--no-first-run", "--disable-extensions", "--remote-debugging-pipe", "--mute-audio")


class Browser:
    """One page. `said` gathers what its console says, warnings and errors, and exceptions that nothing caught."""

    def __init__(self, url, width=1200, height=1000, flags=()):
        self.said, self.loaded, self.last = [], False, 0
        self.folder = tempfile.TemporaryDirectory(prefix="browser-", ignore_cleanup_errors=True)
        read_end, commands = os.pipe()
        answers, write_end = os.pipe()
        places = (f"--user-data-dir={self.folder.name}", f"--window-size={width},{height}")
        # The browser reads commands from descriptor 3 and writes answers to 4.
        wrap = ("bash", "-c", f'exec 3<&{read_end} 4>&{write_end}; exec "$@"', "-")
        self.process = subprocess.Popen([*wrap, "chromium", *FLAGS, *flags, *places, "about:blank"],
                                        pass_fds=(read_end, write_end),
                                        stderr=subprocess.DEVNULL,
                                        stdout=subprocess.DEVNULL)
        os.close(read_end)
        os.close(write_end)
        self.commands, self.answers = os.fdopen(commands, "wb", 0), os.fdopen(answers, "rb")
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for part in ("Page", "Runtime", "Log"):
            self.page(f"{part}.enable")
        self.page("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)
        self.page("Page.navigate", url=url)
        while not self.loaded:
            self.hear()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.kill()
        self.process.wait()
        self.folder.cleanup()

    def hear(self):
        """The next message; events are noted."""
        text = bytearray()
        while not text.endswith(b"\0"):
            byte = self.answers.peek(1)
            if not byte:
                raise EOFError("the browser has gone")
            end = byte.find(b"\0")
            text += self.answers.read(len(byte) if end < 0 else end + 1)
        message = json.loads(text[:-1])
        values, method = message.get("params", {}), message.get("method")
        if method == "Page.loadEventFired":
            self.loaded = True
        elif method == "Runtime.exceptionThrown":
            self.said.append(values["exceptionDetails"].get("exception", {}).get("description", "exception"))
        elif method == "Runtime.consoleAPICalled" and values["type"] in ("error", "warning", "assert"):
            self.said.append(" ".join(str(each.get("value", each.get("description"))) for each in values["args"]))
        elif method == "Log.entryAdded" and values["entry"]["level"] in ("error", "warning"):
            self.said.append(values["entry"]["text"])
        return message

    def call(self, method, session=None, **values):
        self.last += 1
        message = {"id": self.last, "method": method, "params": values, **({"sessionId": session} if session else {})}
        self.commands.write(json.dumps(message).encode() + b"\0")
        while (answer := self.hear()).get("id") != message["id"]:
            pass
        if "error" in answer:
            raise RuntimeError(f"{method}: {answer['error']['message']}")
        return answer["result"]

    def page(self, method, **values):
        return self.call(method, self.session, **values)

    def run(self, script):
        """The value of an expression of JavaScript, awaited."""
        answer = self.page("Runtime.evaluate", expression=script, awaitPromise=True, returnByValue=True)
        if "exceptionDetails" in answer:
            raise RuntimeError(answer["exceptionDetails"]["exception"]["description"])
        return answer["result"].get("value")

    def wait(self, condition, seconds=30):
        """Until an expression is true."""
        script = f"""new Promise((done, failed) => {{
            const end = performance.now() + {1000 * seconds};
            const look = () => {condition} ? done(true)
                : performance.now() > end ? failed(new Error("waited in vain")) : setTimeout(look, 30);
            look(); }})"""
        return self.run(script)

    def pointer(self, kind, x, y, **values):
        self.page("Input.dispatchMouseEvent", type=kind, x=x, y=y, **values)

    def picture(self, path):
        """The page as it looks, as a PNG."""
        with open(path, "wb") as file:
            file.write(base64.b64decode(self.page("Page.captureScreenshot")["data"]))
