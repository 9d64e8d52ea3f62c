#!/usr/bin/env bats
# convert.bats: dem-convert: round trips through the neighbours' formats, files as other programs write them, and refusals.
bats_require_minimum_version 1.5.0
load helper.bash

setup_file() {
    export CONVERT="$ROOT/workflows/post/dem-convert" PYTHONPATH="$ROOT/workflows/post" PYTHONDONTWRITEBYTECODE=1
    cd "$BATS_FILE_TMPDIR"
    "$SINTER" green -n 200 --method affine --compact-to 0.6 --aspect 4:1:1 --seed 3 |
        "$SINTER" -q --temperature 1200C --to-density 0.7,0.8 | "$BONDIFY" -q -o bonded.kiln
    "$ANALYZE" select --index 2 bonded.kiln -o second.kiln
    "$BEND" -q second.kiln --states bent.kiln -o bend.json
}

setup() {
    cd "$BATS_TEST_TMPDIR"
    ln -s "$BATS_FILE_TMPDIR"/*.kiln .
}

# same A B: the states of both files have the same numbers in all arrays of B, bit by bit, but for the order of unknown arrays.
same() {
    "$PYTHON" - "$@" <<'END'
import sys
import numpy
import kiln
first, second = (kiln.read(path) for path in sys.argv[1:3])
assert len(first) == len(second) > 0, (len(first), len(second))
for a, b in zip(first, second):
    assert a["time"] == b["time"], (a["time"], b["time"])
    numpy.testing.assert_array_equal(a["box"]["vectors"], b["box"]["vectors"])
    assert a["box"]["periodic"] == b["box"]["periodic"]
    assert set(a["particles"]) >= {"position", "radius", "id"}
    for group in sys.argv[3].split(","):
        shift = a[group]["id"][0] - b[group]["id"][0] if group == "particles" else 0  # LAMMPS counts from 1
        assert set(a[group]) == set(b[group]), (set(a[group]), set(b[group]))
        for name, values in b[group].items():
            numpy.testing.assert_array_equal(a[group][name] - (shift if name == "id" else 0), values, err_msg=name)
END
}

@test "LAMMPS data: a bonded state comes back bit by bit and bends to the same modulus" {
    "$CONVERT" second.kiln second.data
    "$CONVERT" --like second.kiln second.data back.kiln
    same back.kiln second.kiln particles,bonds
    run -0 bash -c '"$BEND" -q back.kiln | "$ANALYZE" modulus | jq .young_modulus'
    assert_equal "$output" "$("$ANALYZE" modulus "$BATS_FILE_TMPDIR/bend.json" | jq .young_modulus)"
    # As LAMMPS itself writes it: without remarks. Images are the nearest ones, radii come from the option.
    sed 's/#.*//; 1s/.*/LAMMPS data file via write_data/; s/^Atoms.*/Atoms # bpm\/sphere/' second.data >bare.data
    "$CONVERT" -q --bond-radius 28nm bare.data bare.kiln
    run -0 "$PYTHON" -c '
import numpy
import kiln
(a,), (b,) = kiln.read("bare.kiln"), kiln.read("second.kiln")
print((a["bonds"]["pair"] == b["bonds"]["pair"]).all(), (a["bonds"]["image"] == b["bonds"]["image"]).all(), set(a["bonds"]["radius"].tolist()))'
    assert_output "True True {2.8e-08}"
    run -1 "$CONVERT" -q bare.data -
    assert_output "dem-convert: bare.data: its bonds have no radius; give --bond-radius, or --like with a state of the same bonds"
    # With --like they have the radii, lengths and volumes that they had, and bend to the same modulus.
    "$CONVERT" -q --like second.kiln bare.data lent.kiln
    run -0 bash -c '"$BEND" -q lent.kiln | "$ANALYZE" modulus | jq .young_modulus'
    assert_equal "$output" "$("$ANALYZE" modulus "$BATS_FILE_TMPDIR/bend.json" | jq .young_modulus)"
}

@test "necks stay necks through every format that holds bonds: density of the mass, law solid" {
    "$SINTER" green -n 200 --density 0.43 --seed 3 | "$SINTER" -q --temperature 1200C --to-density 0.7 | "$BONDIFY" -q --method necks -o necks.kiln
    wanted=$("$ANALYZE" elastic necks.kiln | jq -c '[.relative_density, .bond_law, .young_modulus]')
    near "$(jq '.[0]' <<<"$wanted")" 0.7 1e-6
    for file in necks.data necks.dump necks.csv necks.jsonl; do
        "$CONVERT" necks.kiln $file
        "$CONVERT" --like necks.kiln $file back.kiln
        same back.kiln necks.kiln bonds
        found=$("$ANALYZE" elastic back.kiln | jq -c '[.relative_density, .bond_law, .young_modulus]')
        assert_equal "$(jq -c '.[1]' <<<"$found")" '"solid"'
        for k in 0 2; do near "$(jq ".[$k]" <<<"$found")" "$(jq ".[$k]" <<<"$wanted")" 1e-9; done
    done
}

@test "LAMMPS data: the length of its bonds is that of Eq. 4 when nothing is said" {
    "$CONVERT" second.kiln second.data
    sed -E 's/length [^ ]+ //' second.data >without.data
    "$CONVERT" without.data without.kiln
    run -0 "$PYTHON" -c '
import kiln
(a,), (b,) = kiln.read("without.kiln"), kiln.read("second.kiln")
print(abs(a["bonds"]["length"] - b["bonds"]["length"]).max() < 1e-15)'
    assert_output True
}

@test "LAMMPS data: other units, image flags, several states" {
    "$CONVERT" --units micro second.kiln micro.data
    run -0 bash -c '"$CONVERT" -q micro.data - | "$ANALYZE" density'
    near "$(jq .relative_density <<<"$output")" 0.8 1e-6
    "$CONVERT" bonded.kiln series.data
    run -0 ls -1
    assert_line series-0001.data
    assert_line series-0002.data
    cat >sphere.data <<'END'
LAMMPS data file via write_data, units nano

2 atoms
1 atom types
0 300 xlo xhi
0 300 ylo yhi
0 300 zlo zhi

Atoms # sphere

2 1 100 3.95 150 150 150 0 0 1
1 1 80 3.95 50 150 150 0 0 0
END
    run -0 bash -c '"$CONVERT" -q --units nano --boundary pff --text sphere.data - | jq -c "[.particles.id.data, (.particles.radius.data | map(. * 1e9 | round)), .box.periodic]"'
    assert_output "[[2,1],[50,40],[true,false,false]]"
}

@test "LAMMPS dump: states with bonds and all their arrays come back bit by bit" {
    for states in bonded bent; do
        "$CONVERT" $states.kiln $states.dump
        "$CONVERT" $states.dump back.kiln
        same back.kiln $states.kiln particles,bonds
    done
    run -0 cat bent.bonds.dump
    assert_line --regexp "^ITEM: ENTRIES batom1 batom2 ix iy iz radius length volume force\[0\].* normal_force"
}

@test "LAMMPS dump: scaled places, symbols, no radius, time steps; as a trajectory it is interpolated" {
    frame() { printf 'ITEM: TIMESTEP\n%s\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS pp pp ff\n0 4e-7\n0 4e-7\n0 4e-7\nITEM: ATOMS id element xs ys zs\n%s' "$1" "$2"; }
    { frame 0 $'7 Al 0.25 0.5 0.5\n3 Al 0.5 0.5 0.5\n'; frame 100 $'3 Al 0.5 0.5 0.5\n7 Al 0.30 0.5 0.5\n'; } >packing.dump
    run -0 bash -c '"$CONVERT" -q --radius 50nm --time-step 10ms packing.dump - | "$ANALYZE" select --interpolate --time 0.5s --text'
    assert_equal "$(jq -c '[.time, .particles.id.data, .box.periodic]' <<<"$output")" "[0.5,[7,3],[true,true,false]]"
    near "$(jq '.particles.position.data[0]' <<<"$output")" 1.1e-7 1e-12
    run -1 "$CONVERT" -q packing.dump -
    assert_output "dem-convert: packing.dump, line 1: the particles have no radius and no diameter; give --radius"
}

@test "extended XYZ: particles come back bit by bit, the bonds are left out with a warning" {
    run -0 "$CONVERT" bonded.kiln bonded.xyz
    assert_output --partial "extended XYZ does not hold the constants of materials, temperature, bonds; --like"
    "$CONVERT" --like bonded.kiln bonded.xyz back.kiln
    same back.kiln bonded.kiln particles
    run -0 head -2 bonded.xyz
    assert_line --index 1 --regexp '^Lattice="[^"]+" Origin="0.0 0.0 0.0" pbc="T T T" Time=[0-9.]+ Units=si Properties=species:S:1:pos:R:3:id:I:1:radius:R:1$'
}

@test "CSV: a state with bonds comes back bit by bit; millimetres and a free body are understood" {
    "$CONVERT" second.kiln second.csv
    "$CONVERT" --like second.kiln second.csv back.kiln
    same back.kiln second.kiln particles,bonds
    printf 'x (mm),y (mm),z (mm),diameter (um),charge\n1,2,3,500,-1\n1.4,2,3,500,1\n' >hand.csv
    run -0 bash -c '"$CONVERT" -q --text hand.csv - | jq -c "[.box.periodic[0], .particles.radius.data, .particles.charge.data, .box.vectors[0][0]]"'
    assert_output "[false,[0.00025,0.00025],[-1,1],0.0009]"
    sed 's/ (mm)//' hand.csv >bare.csv
    run -1 "$CONVERT" bare.csv -
    assert_output --partial "bare.csv: column 'x' has no unit of length; known here: m, cm, mm, um, nm"
}

# The lines are as MUSEN's exporter writes them: commands and values (see convert_musen.py).
@test "MUSEN: spheres, bonds through a periodic face and times of a text export" {
    cat >musen.txt <<'END'
0 7 1 14 5  23 E5F3 24 0 1e+15 2 0 12 1e-07 1e-07 0
0 0 1 1 5 5e-08 5e-08 23 E5F3 24 0 1e+15 2 0 12 2e-08 1e-07 1e-07 15 0 0 0 37 300 2 0.5 12 3e-08 1e-07 1e-07 15 1 0 0 37 300
0 1 1 1 5 5e-08 5e-08 23 E5F3 24 0 1e+15 2 0 12 1.8e-07 1e-07 1e-07 15 0 0 0 37 300 2 0.5 12 1.8e-07 1e-07 1e-07 15 0 0 0 37 300
0 2 1 9 5 0 1 4e-08 4e-08 23 E5F3 24 0.2 1e+15 2 0 18 0 2 0.5 18 1.5
22 0 0 0 1 1 1
28 1 1 0 0 0 0 0 2e-07 2e-07 2e-07
29 0
32 E5F3 Alumina 0 3950 7 4e+11 10 0.23
END
    run -0 "$CONVERT" -q --text musen.txt -
    assert_equal "$(jq -sc '[.[].time]' <<<"$output")" "[0,0.5]"
    assert_equal "$(jq -sc '[.[].bonds.pair.data]' <<<"$output")" "[null,[0,1]]"  # the bond is there from 0.2 s on
    assert_equal "$(jq -sc '.[1] | [.bonds.image.data, (.bonds.radius.data[0] * 1e9 | round), .box.periodic, (.particles.radius.data[0] * 1e9 | round)]' <<<"$output")" \
        "[[-1,0,0],20,[true,false,false],50]"
    near "$(jq -s '.[1].particles.velocity.data[0]' <<<"$output")" 1 0
    assert_equal "$(jq -sc '.[0].materials' <<<"$output")" '[{"name":"Alumina","density":3950,"young_modulus":400000000000,"poisson_ratio":0.23}]'
    run -0 bash -c '"$CONVERT" musen.txt - | "$ANALYZE" density'
    printf '0 0 1 1 5 5e-08 5e-08 2 0 12 1 2\n' >short.txt
    run -1 "$CONVERT" short.txt -
    assert_output "dem-convert: short.txt, line 1: the command 12 requires 3 values, 2 are there"
}

@test "VTU: meshio and VTK read the series, its spheres, bonds and arrays" {
    "$CONVERT" bent.kiln bent.pvd
    "$CONVERT" bonded.kiln bonded.pvd
    run -0 cat bonded.pvd
    assert_line --regexp '<DataSet timestep="[0-9.]+" part="0" file="bonded-0002.vtu"/>'
    run -0 "$PYTHON" - <<'END'
import numpy
from meshio.vtu import _vtu
import kiln
(state,) = kiln.read("bent.kiln")
mesh = _vtu.read("bent-0001.vtu")
print({block.type: len(block.data) for block in mesh.cells} == {"vertex": len(state["particles"]["radius"]), "line": len(state["bonds"]["radius"])})
print(numpy.array_equal(mesh.points, state["particles"]["position"]), numpy.array_equal(mesh.point_data["displacement"], state["particles"]["displacement"]))
print(numpy.array_equal(mesh.cell_data["normal_force"][1], state["bonds"]["normal_force"]), sorted(mesh.cell_data))
END
    assert_line --index 0 True
    assert_line --index 1 "True True"
    assert_line --index 2 "True ['bond_radius', 'force', 'length', 'moment', 'normal_force', 'shear_stress', 'tensile_stress', 'volume']"
    "$PYTHON" -c 'import vtk' 2>/dev/null || skip "VTK for Python is not installed"
    run -0 "$PYTHON" - <<'END'
import xml.etree.ElementTree
import vtk
for part in xml.etree.ElementTree.parse("bonded.pvd").iter("DataSet"):
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(part.get("file"))
    reader.Update()
    grid = reader.GetOutput()
    kinds = [grid.GetCellType(cell) for cell in range(grid.GetNumberOfCells())]
    print(kinds.count(vtk.VTK_VERTEX), kinds.count(vtk.VTK_LINE) > 200, grid.GetPointData().GetArray("radius").GetRange()[0] > 0)
END
    assert_output $'200 True True\n200 True True'
}

@test "VTU: bonds through periodic faces are drawn to ghosts or cut" {
    for mode in ghosts cut; do "$CONVERT" --bonds $mode second.kiln $mode.vtu; done
    run -0 "$PYTHON" - <<'END'
import numpy
from meshio.vtu import _vtu
import kiln
(state,) = kiln.read("second.kiln")
bonds, through = state["bonds"], state["bonds"]["image"].any(axis=1)
for mode in ("ghosts", "cut"):
    mesh = _vtu.read(f"{mode}.vtu")
    lines = mesh.cells[1].data
    drawn = numpy.linalg.norm(mesh.points[lines[:, 1]] - mesh.points[lines[:, 0]], axis=1)
    print(len(lines) == (len(through) if mode == "ghosts" else (~through).sum()), through.any(), drawn.max() < 1.2e-7,
          int(mesh.point_data["ghost"].sum()) > 0)
END
    assert_output $'True True True True\nTrue True True False'
}

@test "refusals: one sentence, nothing written" {
    run -1 "$CONVERT" second.kiln second.abc
    assert_output --partial "second.abc: its name does not say its format; give --to"
    run -1 "$CONVERT" second.kiln second.txt
    assert_output --partial "musen is not a format for this side"
    run -1 "$CONVERT" none.kiln out.csv
    assert_output "dem-convert: none.kiln: No such file or directory"
    run -1 "$CONVERT" bonded.kiln bonded.vtu
    assert_output --partial "there are 2 states, a VTU holds one"
    "$CONVERT" second.kiln second.data
    sed 's/^5 1 .*/5 1 1 wide/' second.data >wrong.data
    run -1 "$CONVERT" wrong.data out.kiln
    assert_output --regexp "^dem-convert: wrong.data, line [0-9]+: has 4 columns, atom style bpm/sphere has 8"
    sed '/^[0-9]* 1 1 2 #/d; s/^200 atoms/199 atoms/' second.data >count.data
    run -1 "$CONVERT" count.data out.kiln
    assert_output "dem-convert: count.data: 199 atoms are announced, 200 are there"
    head -c 3000 second.kiln >cut.kiln
    run -1 "$CONVERT" cut.kiln out.csv
    assert_output --partial "dem-convert: cut.kiln"
    run -1 "$CONVERT" --from csv - out.kiln <<<$'x (m),y (m),z (m),r (m)\n1,1,1,wide'
    assert_output "dem-convert: standard input, line 2: 'wide' is not a number"
    run -2 "$CONVERT" --radius 50 second.kiln out.csv
    assert_output --partial "'50' is not a number with a unit"
    while IFS='|' read -r option wanted; do
        run -2 "$CONVERT" $option second.kiln out.csv
        assert_line --partial "error: ${option% *} has an effect only $wanted, and this is from dem to csv"
    done <<'END'
--text|to dem
--bonds cut|to vtu
--units micro|from data or dump or xyz or csv or vtu or to data or dump or xyz
--atom-style sphere|from data
--boundary ppp|from another format than dem
--radius 50nm|from another format than dem
--bond-radius 28nm|from data or dump or csv or vtu
--columns x,y,z,r|from csv
--bond-columns batom1,batom2|from dump or csv
--time-step 10ns|from data or dump
END
    run -2 "$CONVERT" --like second.kiln --material alumina second.data out.kiln
    assert_line --partial "--like and --material both say of what the particles are"
    run -2 "$CONVERT" --units nano second.data out.xyz
    assert_line --partial "--units is for one side, and both data and xyz have units"
    run -0 ls
    refute_line --regexp "^out|partial"
}

@test "the command works through a link, as installed, and has the version of the programs" {
    ln -s "$CONVERT" linked
    run -0 env -u PYTHONPATH ./linked --version
    assert_output "$("$ANALYZE" info --version | sed 's/^analyze info/dem-convert/')"
    run -0 env -u PYTHONPATH ./linked --help
    assert_output --partial "--bonds {cut,ghosts}"
}
