#!/usr/bin/env bats
# view.bats: dem-view: what a page holds, that a browser shows it and follows pointer and sliders, and refusals.
bats_require_minimum_version 1.5.0
load helper.bash

setup_file() {
    export VIEW="$ROOT/workflows/post/dem-view" PYTHONPATH="$ROOT/workflows/post:$ROOT/tests" PYTHONDONTWRITEBYTECODE=1
    cd "$BATS_FILE_TMPDIR"
    "$SINTER" green -n 400 --method affine --compact-to 0.6 --aspect 4:1:1 --seed 3 |
        "$SINTER" -q --temperature 1200C --to-density 0.7,0.8 -o sintered.kiln
    "$BONDIFY" -q -o bonded.kiln sintered.kiln
    "$ANALYZE" select --index 2 bonded.kiln | "$BEND" -q --states bent.kiln -o bend.json
    [ ! -d /usr/share/javascript/three ] || "$VIEW" sintered.kiln bonded.kiln bent.kiln -o view.html
}

setup() {
    cd "$BATS_TEST_TMPDIR"
    ln -s "$BATS_FILE_TMPDIR"/*.{kiln,json} .
}

needs_three() { [ -d /usr/share/javascript/three ] || skip "there is no three.js"; }

@test "contacts are those of every pair with every image, for unlike sizes, small boxes and walls" {
    run -0 "$PYTHON" - <<'END'
import itertools
import numpy
from dem_view import contacts
random = numpy.random.default_rng(5)
found = 0
for periodic in ((True, True, True), (True, False, True), (False, False, False)):
    for count, widest in ((60, 1.2), (60, 9.0), (5, 1.2)):
        size, low = numpy.array([1.0, 0.8, 1.3]), numpy.array([-0.2, 0.0, 5.0])
        position = low + random.random((count, 3)) * size
        radius = 0.3 / count ** (1 / 3) * widest ** random.random(count) / widest ** 0.5
        expected = []
        for i, j in itertools.combinations(range(count), 2):
            for image in itertools.product(*((-1, 0, 1) if axis else (0, ) for axis in periodic)):
                overlap = radius[i] + radius[j] - numpy.linalg.norm(position[j] + image * size - position[i])
                if overlap > 0:
                    expected.append((i, j, round(overlap, 12), any(image)))
        pair, overlap, crossing = contacts(position, radius, low, size, numpy.array(periodic))
        pair = numpy.sort(pair, axis=1)
        got = sorted((int(i), int(j), round(h, 12), bool(c)) for (i, j), h, c in zip(pair, overlap, crossing))
        assert got == sorted(expected), (periodic, count, widest, len(got), len(expected))
        found += len(got)
print(found > 300)
END
    assert_output True
}

@test "coordination, overlap and number of necks are those of analyze and bondify" {
    run -0 "$PYTHON" - <<'END'
import json, subprocess, os
import numpy
import kiln
from dem_view import Body
densities = subprocess.run([os.environ["ANALYZE"], "density", "sintered.kiln"], capture_output=True, check=True, text=True).stdout
for line, state, bonded in zip(densities.splitlines(), kiln.read("sintered.kiln"), kiln.read("bonded.kiln")):
    said, body, bonds = json.loads(line), Body(state, {}), Body(bonded, {})
    numpy.testing.assert_allclose(body.particles["coordination"].mean(), said["coordination_number"], rtol=1e-12)
    numpy.testing.assert_array_equal(body.particles["coordination"], bonds.particles["coordination"])
    assert len(body.pair) + body.crossing == len(bonded["bonds"]["pair"]) and 0 < body.crossing == bonds.crossing
    numpy.testing.assert_array_equal(body.pair, bonds.pair)
    assert "overlap" not in bonds.particles and 0.02 < body.particles["overlap"].mean() < 0.3
print("same")
END
    assert_output same
}

@test "necks that a state gives are those shown, whether their grains overlap or not" {
    run -0 "$PYTHON" - <<'END'
import numpy
from dem_view import Body
# A row along x in a box of ten: 0 and 1 overlap and have a neck of their own, 1 and 2 overlap, 2 and 0 have a neck through the face.
state = {"box": {"vectors": [[10.0, 0, 0], [0, 4.0, 0], [0, 0, 4.0]]},
         "particles": {"position": numpy.array([[1.0, 2, 2], [2.8, 2, 2], [4.7, 2, 2]]), "radius": numpy.array([1.0, 1.0, 1.0])},
         "necks": {"pair": numpy.array([[1, 0], [2, 0]], numpy.int32), "radius": numpy.array([0.3, 0.4]),
                   "image": numpy.array([[0, 0, 0], [1, 0, 0]], numpy.int8)}}
body = Body(state, {})
place = body.place_of
shown = {tuple(sorted(numpy.flatnonzero(place == end)[0] for end in pair)): radius for pair, radius in zip(body.pair, body.bonds["radius"])}
print(sorted(shown), [round(float(shown[pair]), 9) for pair in sorted(shown)], body.crossing)
print(body.particles["coordination"][place].tolist(), numpy.round(body.particles["overlap"][place], 9).tolist())
END
    # a^2 = 4 R* h = 2 h: h of 0.045, 0.1 and 0.08, over R1 + R2.
    assert_output "[(0, 1), (1, 2)] [0.3, 0.447213595] 1
[2, 2, 2] [0.03125, 0.03625, 0.045]"
}

@test "a page needs nothing else" {
    needs_three
    run -0 "$PYTHON" - "$BATS_FILE_TMPDIR/view.html" <<'END'
import html.parser, os, sys
class Page(html.parser.HTMLParser):
    def handle_starttag(self, tag, attributes):
        assert not {"src", "href"} & set(dict(attributes)) and tag not in ("link", "iframe", "img"), (tag, attributes)
Page().feed(open(sys.argv[1], encoding="utf-8").read())
print(os.path.getsize(sys.argv[1]) < 1.3e6)
END
    assert_output True
    "$VIEW" <sintered.kiln >piped.html
    "$VIEW" sintered.kiln --title States -o named.html
    cmp piped.html named.html
}

@test "a browser shows it: states by the slider, values under the pointer, forces, cuts, turning; and has nothing to complain of" {
    needs_three
    type -P chromium >/dev/null || skip "there is no chromium"
    run -0 "$PYTHON" - "file://$BATS_FILE_TMPDIR/view.html" <<'END'
import sys
import numpy
from browser import Browser
import kiln
TOOLS = """
  const view = document.querySelector(".dem-view").view;
  const settled = async () => { do await new Promise(done => setTimeout(done, 40));
                                while (!view.fine || view.dirty || view.state !== view.header.states[view.number]); };
  const set = async (name, value) => { view.at(name).value = value; view.at(name).dispatchEvent(new Event("input"));
                                       await new Promise(done => setTimeout(done, 150)); await settled(); };
  const pixels = () => { view.draw(1); const copy = document.createElement("canvas").getContext("2d");
    Object.assign(copy.canvas, { width: view.canvas.width, height: view.canvas.height });
    copy.drawImage(view.canvas, 0, 0); return copy.getImageData(0, 0, copy.canvas.width, copy.canvas.height).data; };
  const ink = () => { const data = pixels(); let count = 0; for (let k = 0; k < data.length; k += 4) count += data[k] < 240 || data[k + 2] < 240;
                      return count / (data.length / 4); };
  const change = before => { const now = pixels(); let count = 0; for (let k = 0; k < now.length; ++k) count += Math.abs(now[k] - before[k]) > 20;
                             return count / now.length; };
"""
with Browser(sys.argv[1]) as page:
    page.wait("document.querySelector('.dem-view').view?.fine")
    page.run("(() => {" + TOOLS + "Object.assign(window, { view, settled, set, pixels, ink, change }); })()")
    states = [state for name in ("sintered", "bonded", "bent") for state in kiln.read(f"{name}.kiln")]
    # A choice before the first state has been unpacked waits for it.
    page.run("(async () => { const state = view.state; view.state = undefined; await view.recolour(); view.state = state; })()")
    print("states", page.run("view.header.states.length") == len(states))
    print("drawn", 0.1 < page.run("ink()") < 0.7, "fallback hidden", page.run("document.querySelector('.fallback').hidden"))

    # Every particle stands where the stream says, to the 65535th part of the box, and is found by its name.
    for number in (0, 4):
        page.run(f"set('state', {number})")
        place, ids = page.run("(async () => [Array.from(view.arrays.places), Array.from(await view.block(view.state.ids, Int32Array))])()")
        low, high = (numpy.array(page.run(f"view.state.{end}")) for end in ("low", "high"))
        box = states[number]["box"]
        size = numpy.diag(box["vectors"])
        row = numpy.argsort(states[number]["particles"]["id"])[numpy.searchsorted(numpy.sort(states[number]["particles"]["id"]), ids)]
        shown = (low + numpy.array(place).reshape(-1, 3) / 65535 * (high - low)) * 1e-9 + size / 2
        off = shown - states[number]["particles"]["position"][row]
        if number == 0:
            off -= numpy.round(off / size) * size
            print("placed", bool(numpy.abs(off).max() < size.max() / 65535))
        else:
            print("bent", page.run("view.state.enlarged") > 1, bool(numpy.abs(off[:, 2]).max() > 0.02 * size[2]))

    page.run("set('state', 0).then(() => { window.before = pixels(); })")
    page.run("set('state', 1)")
    print("slider", page.run("change(before)") > 0.02, "0.800" in page.run("view.at('said').textContent"))

    left, top, width, height = page.run("(() => { const r = view.canvas.getBoundingClientRect(); return [r.left, r.top, r.width, r.height]; })()")
    page.pointer("mouseMoved", left + width / 2, top + height / 2)
    page.wait("!view.tip.hidden && view.tip.textContent")
    print(*(word in page.run("view.tip.textContent") for word in ("Particle ", "Coordination number: ", "Radius of particle or grain: 50.0 nm", "Overlap")))

    page.run("set('state', 4)")
    page.run("set('colour', 'bonds.normal_force')")
    print("bonds", page.run("view.at('show').value"), 0.02 < page.run("ink()") < 0.6)
    colours = page.run("(() => { const d = pixels(); let red = 0, blue = 0; for (let k = 0; k < d.length; k += 4) {"
                       "red += d[k] > d[k + 2] + 60; blue += d[k + 2] > d[k] + 60; } return [red, blue]; })()")
    print("tension and compression", min(colours) > 50)
    page.run("set('show', 'particles').then(() => { window.before = ink(); })")
    page.run("set('axis', '0')")
    print("cut", page.run("ink() / before") < 0.85)
    page.run("set('thick', 0.05)")
    print("slice", page.run("ink() / before") < 0.4)
    page.run("view.reset(); settled().then(() => { window.before = pixels(); })")
    page.pointer("mousePressed", left + width / 2, top + height / 2, button="left", clickCount=1)
    page.pointer("mouseMoved", left + width / 2 + 150, top + height / 2 + 40, button="left", buttons=1)
    page.pointer("mouseReleased", left + width / 2 + 150, top + height / 2 + 40, button="left", clickCount=1)
    page.run("settled()")
    print("turned", page.run("change(before)") > 0.05)

    x, y = page.run("(() => { const r = document.querySelector('[data-plot=states] circle').getBoundingClientRect();"
                    "return [r.left + r.width / 2, r.top + r.height / 2]; })()")
    page.pointer("mouseMoved", x, y)
    print("plot", "relative density 0.700" in page.run("document.querySelector('[data-plot=states] .tip').textContent"))
    print("said", page.said)
END
    assert_output "states True
drawn True fallback hidden True
placed True
bent True True
slider True True
True True True True
bonds bonds True
tension and compression True
cut True
slice True
turned True
plot True
said []"
}

@test "without WebGL the states stand in a table" {
    needs_three
    type -P chromium >/dev/null || skip "there is no chromium"
    run -0 "$PYTHON" - "file://$BATS_FILE_TMPDIR/view.html" <<'END'
import sys
from browser import Browser
with Browser(sys.argv[1], flags=("--disable-3d-apis", )) as page:
    print(page.run("[document.querySelector('.screen').hidden, document.querySelector('.fallback').offsetHeight > 50,"
                   "document.querySelectorAll('.fallback td').length, document.querySelector('.fallback').innerText.includes('0.800')].join()"))
END
    assert_output "true,true,25,true"
}

@test "what does not fit is left out and said: states, evenly, then bonds" {
    needs_three
    run -0 --separate-stderr "$VIEW" --size 1003kB sintered.kiln bonded.kiln bent.kiln -o small.html
    assert_equal "$stderr" "dem-view: warning: the page holds 3 of 5 states, to stay below --size"
    run -0 "$PYTHON" - <<'END'
import json, re
data = json.loads(re.search('<script type="application/json">(.*?)</script>', open("small.html", encoding="utf-8").read(), re.S)[1])
print(*(f"{state['time']:.0f} {state['bonds']['word']}" for state in data["states"]), len(data["blocks"]))
END
    assert_regex "$output" "^[0-9]+ neck [0-9]+ bond [0-9]+ bond"
    run -0 --separate-stderr "$VIEW" --size 985kB bent.kiln -o least.html
    assert_equal "$stderr" "dem-view: warning: the page holds no bonds, to stay below --size"
    run -1 --separate-stderr "$VIEW" --size 950kB sintered.kiln -o none.html
    assert_equal "$stderr" "dem-view: 400 particles do not fit; give a larger --size"
    [ ! -e none.html ]
}

@test "refusals are one sentence and leave no file" {
    run -1 --separate-stderr "$VIEW" absent.kiln -o out.html
    assert_equal "$stderr" "dem-view: absent.kiln: No such file or directory"
    run -1 --separate-stderr "$VIEW" --three nowhere sintered.kiln -o out.html
    assert_equal "$stderr" "dem-view: nowhere/build/three.min.js cannot be read; install Debian's libjs-three, or say by --three where it is"
    run -2 --separate-stderr "$VIEW" --size 15 sintered.kiln -o out.html
    assert_regex "$stderr" "'15' is not a size greater than zero, such as 15MB"
    needs_three
    run -1 --separate-stderr "$VIEW" bend.json -o out.html
    assert_equal "$stderr" "dem-view: bend.json, document 1: is dem-bend, expected a state"
    run -1 --separate-stderr "$VIEW" /dev/null -o out.html
    assert_equal "$stderr" "dem-view: there is no state to show"
    head -c 3000 sintered.kiln >cut.kiln
    run -1 --separate-stderr "$VIEW" cut.kiln -o out.html
    assert_regex "$stderr" "^dem-view: cut.kiln, document 1: [0-9]+ bytes belong behind the header, [0-9]+ are there$"
    [ ! -e out.html ]
}
