#!/usr/bin/env bats
# paper.bats: the study of the paper by Make: what it makes, that it goes on where it stopped, that it may run in parallel.
bats_require_minimum_version 1.5.0
load helper.bash

CASES=(0.67 0.71 0.79 0.88)

# A dense start keeps this quick; the loose one of the paper takes most of the time of a run.
study() {
    make -C "$ROOT/workflows/paper" N=600 SEED=5 OUT="$BATS_FILE_TMPDIR/study" \
        GREEN='-n $(N) --method affine --compact-to 0.6 --aspect 4:1:1 --seed $(SEED)' "$@"
}

setup_file() {
    study >"$BATS_FILE_TMPDIR/said"
}

setup() {
    cd "$BATS_FILE_TMPDIR/study"
}

@test "the study says Table 2 with its deviations, moduli, the fit and where the figures are" {
    run -0 cat "$BATS_FILE_TMPDIR/said"
    assert_line --partial "relative density"
    assert_line --regexp "deviation( +[-+][0-9.]+ %){4}"
    assert_line --partial "Largest deviation of the 12 numbers"
    assert_line --partial "E0 exp(-b P)"
    assert_line --partial "study/figures/density.png"
}

@test "the table holds twelve numbers beside the paper's" {
    run -0 jq -c '[length, ([.[].paper] | add), (all(.[]; .run > 0 and (.deviation | fabs) < 0.25))]' table2.json
    assert_output "[12,1234701.28,true]"
    run -0 wc -l <table2.csv
    assert_output 13
}

@test "every case has its states, its test and its modulus" {
    for case in "${CASES[@]}"; do
        near "$("$ANALYZE" density "$case/sintered.kiln" | jq .relative_density)" "$case" 1e-5
        jq -e '.count > 1000' "$case/bonds.json"
        jq -e '.young_modulus > 1e9 and .standard_error == null and .material == "alumina" and .slenderness > 3' "$case/modulus.json"
        # The same states with the necks of the sintering law, which are stiffer and fill what the mass fills.
        jq -e --slurpfile bonds "$case/modulus.json" '.young_modulus > 1.2 * $bonds[0].young_modulus and .bond_law == "solid"' \
            "$case/necks_modulus.json"
    done
    jq -e '.points | length == 4 and all(.[]; .bond_law == "series")' fit.json
    jq -e '.points | length == 4 and all(.[]; .bond_law == "solid")' necks_fit.json
}

@test "no figure is blank" {
    run -0 "$PYTHON" - figures/*.png <<'END'
import sys
from matplotlib import image
for path in sys.argv[1:]:
    pixels = image.imread(path)[..., :3]
    ink = (pixels.min(axis=2) < 0.9).mean()
    print(path.split("/")[-1], "drawn" if min(pixels.shape[:2]) > 300 and 0.005 < ink < 0.6 else f"ink {ink}, size {pixels.shape}")
END
    assert_output $'bend.png drawn\nbonds.png drawn\ndensity.png drawn\nmodulus.png drawn\nstates.png drawn'
}

@test "the report is one page that needs nothing else, with the figures, both columns of Table 2, and every command" {
    run -0 "$PYTHON" - <<'END'
import html.parser, json, os
class Page(html.parser.HTMLParser):
    images, links, text = [], [], ""
    def handle_starttag(self, tag, attributes):
        given = dict(attributes)
        self.images += [given["src"]] if tag == "img" else []
        self.links += [given["href"]] if "href" in given else []
        assert tag not in ("link", "iframe") and not (tag == "script" and "src" in given), tag
    def handle_data(self, data):
        self.text += data + "\n"
page = Page()
page.feed(open("report.html", encoding="utf-8").read())
print(os.path.getsize("report.html") < 5e6, len(page.images), all(image.startswith("data:image/png;base64,") for image in page.images))
print(all(os.path.exists(link) for link in page.links), {"green.kiln", "0.79/bend.json", "fit.json"} <= set(page.links))
entries = json.load(open("table2.json"))
print(all(f"{entry[key]:,.{entry['decimals']}f}\n" in page.text for entry in entries for key in ("run", "paper")))
print([word for word in ("sinter green --particles 600 --method affine --compact-to 0.6 --aspect 4:1:1 --seed 5", "bondify\n", "bondify --method necks\n", "bend\n", "Kiln 0.1.0")
       if word not in page.text])
END
    assert_output $'True 5 True\nTrue True\nTrue\n[]'
}

@test "a browser shows the report, with pictures only where it has no WebGL" {
    type -P chromium >/dev/null || skip "there is no chromium"
    chromium --headless --no-sandbox --disable-gpu --disable-3d-apis --hide-scrollbars --user-data-dir="$BATS_TEST_TMPDIR/profile" --window-size=1200,3000 \
        --screenshot="$BATS_TEST_TMPDIR/page.png" "file://$PWD/report.html" 2>/dev/null
    run -0 "$PYTHON" - "$BATS_TEST_TMPDIR/page.png" <<'END'
import sys
from matplotlib import image
pixels = image.imread(sys.argv[1])[..., :3]
ink = [(part.min(axis=2) < 0.9).mean() for part in (pixels[:400], pixels[400:1600], pixels[1600:3000])]  # headings, packing, plots
print(pixels.shape[:2], all(0.005 < share < 0.5 for share in ink) or ink)
END
    assert_output "(3000, 1200) True"
}

@test "the report holds the packing to turn, with bonds and forces, and plots with values under the pointer" {
    type -P chromium >/dev/null || skip "there is no chromium"
    [ -d /usr/share/javascript/three ] || skip "there is no three.js"
    PYTHONPATH="$ROOT/tests" PYTHONDONTWRITEBYTECODE=1 run -0 "$PYTHON" - "file://$PWD/report.html" <<'END'
import sys
from browser import Browser
with Browser(sys.argv[1]) as page:
    page.wait("document.querySelector('.dem-view').view?.fine && document.querySelectorAll('figure .dem-plot').length == 2")
    page.run("void (window.view = document.querySelector('.dem-view').view)")
    print(page.run("view.header.states.map(state => [state.density && state.density.toFixed(2), state.enlarged > 1]).join(' ')"))
    print("normal_force" in page.run("Object.keys(view.header.states[5].bonds.colours)"))
    print(page.run("[...document.images].map(image => [image.dataset.picture, image.offsetHeight > 0]).join(' ')"))
    for picture, word in (("density", "coordination number"), ("modulus", "GPa")):
        x, y = page.run(f"(() => {{ const circle = document.querySelector('[data-picture={picture}] ~ .dem-plot circle'); circle.scrollIntoView();"
                        "const r = circle.getBoundingClientRect(); return [r.left + r.width / 2, r.top + r.height / 2]; })()")
        page.pointer("mouseMoved", x, y)
        print(word in page.run(f"document.querySelector('[data-picture={picture}] ~ .dem-plot .tip').textContent"))
    print(page.said)
END
    assert_output "0.60,false 0.67,false 0.71,false 0.79,false 0.88,false ,true
True
states,false density,false bonds,true bend,true modulus,false
True
True
[]"
}

@test "a second call makes nothing" {
    study SINTER=false BONDIFY=false BEND=false MEASURE=false
}

@test "what is missing is made, and only that" {
    rm 0.71/bend.json
    run -2 study BEND=false
    study SINTER=false BONDIFY=false
    jq -e .span 0.71/bend.json
}

@test "other options make the run anew" {
    cp -a . "$BATS_TEST_TMPDIR/copy"
    run -2 study OUT="$BATS_TEST_TMPDIR/copy" NECKS="--necks law" BONDIFY=false
    assert_output --partial "necks.kiln] Error 1"
    run -2 study OUT="$BATS_TEST_TMPDIR/copy" BONDING="--volume cap-corrected" BONDIFY=false
    assert_output --partial "bonded.kiln] Error 1"
    run -2 study OUT="$BATS_TEST_TMPDIR/copy" SEED=6 SINTER=false
    assert_output --partial "green.kiln] Error 1"
}

@test "a stage that fails leaves no file under its final name" {
    out="$BATS_TEST_TMPDIR/failed"
    run -2 study OUT="$out" SINTER="$(type -P false)"
    [ ! -e "$out/green.kiln" ]
}

@test "parallel makes give the same numbers" {
    study -j4 OUT="$BATS_TEST_TMPDIR/parallel" table fit >/dev/null
    cmp table2.json "$BATS_TEST_TMPDIR/parallel/table2.json"
    cmp fit.json "$BATS_TEST_TMPDIR/parallel/fit.json"
}

@test "times lists every stage with its time and memory" {
    run -0 study times
    for made in green.kiln sintered.kiln 0.67/bonded.kiln 0.88/bend.json 0.67/necks.kiln necks_fit.json "in all"; do
        assert_line --regexp "^$made( +[0-9.]+){3}$"
    done
}

@test "a relative OUT is refused with a hint" {
    run -2 make -C "$ROOT/workflows/paper" OUT=somewhere
    assert_output --partial 'OUT=somewhere is not an absolute path; try OUT=$PWD/somewhere'
}
