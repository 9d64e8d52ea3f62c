#!/usr/bin/env bats
# voxel.bats: the voxel model of analyze elastic and conductivity, images in and out, and how they refuse.
bats_require_minimum_version 1.5.0
load helper.bash

setup_file() {
    export FILES="$BATS_FILE_TMPDIR"
    cd "$FILES"
    "$SINTER" green -n 40 --seed 2 | "$SINTER" --temperature 1200C --to-density 0.7,0.8 -o sintered.kiln
    "$BONDIFY" -q --method necks -o necks.kiln sintered.kiln
    "$ANALYZE" select --density 0.7 -o one.kiln necks.kiln
    "$SINTER" green -n 40 --aspect 2:1:1 --seed 2 | "$SINTER" --temperature 1200C --boundary free --to-density 0.6 -o free.kiln
}

setup() { cd "$FILES"; }

# python CODE: runs it with numpy as np.
python() { "$PYTHON" -c "import numpy as np; $1"; }

@test "analyze elastic --model voxel: a document a state, with what each grid gave" {
    run -0 --separate-stderr "$ANALYZE" elastic --model voxel --voxels 6,3,4.5 necks.kiln
    assert_equal "$stderr" ""
    assert_equal "${#lines[@]}" 2
    first=${lines[0]}
    assert_equal "$(jq -r '[.format, .model, .converged, (.grids | length), (.stiffness | length)] | join(" ")' <<<"$first")" \
        "dem-elastic voxel true 3 6"
    near "$(jq .relative_density <<<"$first")" 0.7 0.001
    near "$(jq .union_fraction <<<"$first")" 0.7 0.005
    # Grids from coarse to fine; the tensor is symmetric; the averages are those of the network's document.
    assert_equal "$(jq -c '[.grids[].voxels | round]' <<<"$first")" "[3,5,6]"
    assert_equal "$(jq '.stiffness as $c | [range(6) as $i | range(6) as $j | $c[$i][$j] == $c[$j][$i]] | all' <<<"$first")" true
    for key in young_modulus poisson_ratio shear_modulus bulk_modulus anisotropy axial_moduli axial_modulus stiffness; do
        assert_equal "$("$ANALYZE" elastic necks.kiln | head -1 | jq "has(\"$key\")")" true
        assert_equal "$(jq "has(\"$key\")" <<<"$first")" true
    done
    near "$(jq '.axial_modulus / (.axial_moduli | add / 3)' <<<"$first")" 1 1e-12
    # Not far from the law of the network, and the coarsest grid is not far from the finest one.
    near "$(jq .young_modulus <<<"$first")" "$("$ANALYZE" elastic necks.kiln | head -1 | jq .young_modulus)" 0.15
    near "$(jq '.grids[0].young_modulus' <<<"$first")" "$(jq '.grids[2].young_modulus' <<<"$first")" 0.08
    assert_equal "$(jq '(.young_modulus - .grids[2].young_modulus | fabs) <= .extrapolation_error' <<<"$first")" true
}

@test "analyze elastic --model voxel: an extrapolation is within its error of that of grids twice as fine" {
    coarse=$("$ANALYZE" elastic --model voxel --voxels 4,6,8 one.kiln)
    fine=$("$ANALYZE" elastic --model voxel --voxels 8,12,16 one.kiln)
    jq -en --argjson a "$coarse" --argjson b "$fine" '($a.young_modulus - $b.young_modulus | fabs) <= $a.extrapolation_error and
        ($a.poisson_ratio - $b.poisson_ratio | fabs) <= $a.poisson_ratio_error and
        $b.extrapolation_error < $a.extrapolation_error and $a.extrapolation_error < 0.1 * $a.young_modulus' ||
        fail "$coarse is not near $fine"
}

@test "analyze conductivity --model voxel: below the bound, near the network" {
    run -0 "$ANALYZE" conductivity --model voxel --voxels 4,6 --conductivity 30W/m/K necks.kiln
    assert_equal "$(jq -s 'map(.conductivity < .bound and .conductivity > 0.5 * .bound and .converged) | all' <<<"$output")" true
    network=$("$ANALYZE" conductivity --conductivity 30W/m/K necks.kiln | head -1 | jq .conductivity)
    near "$(jq .conductivity <<<"${lines[0]}")" "$network" 0.1
    near "$(jq '.tensor | (.[0][0] + .[1][1] + .[2][2]) / 3' <<<"${lines[0]}")" "$(jq .conductivity <<<"${lines[0]}")" 1e-9
}

@test "analyze elastic: the same bytes on one thread and on two" {
    for command in "elastic" "conductivity --conductivity 1W/m/K"; do
        run -0 "$ANALYZE" $command --model voxel --voxels 3,5 --threads 1 necks.kiln
        one=$output
        run -0 "$ANALYZE" $command --model voxel --voxels 3,5 --threads 2 necks.kiln
        assert_equal "$output" "$one"
    done
    run -0 "$ANALYZE" voxel --threads 1 -o one.npy one.kiln
    run -0 "$ANALYZE" voxel --threads 2 -o two.npy one.kiln
    cmp one.npy two.npy
}

@test "analyze voxel: NumPy reads what is written, and the image has the tensor of its grid" {
    run -0 --separate-stderr "$ANALYZE" voxel --voxels 5 -o body.npy one.kiln
    assert_equal "$output$stderr" ""
    grid=$("$ANALYZE" elastic --model voxel --voxels 5 necks.kiln | head -1)
    assert_equal "$(python "a = np.load('body.npy'); print(list(a.shape), a.dtype, a.max())")" "$(jq -r '"\(.grids[0].count | join(", ") | "[\(.)]") uint8 1"' <<<"$grid")"
    assert_equal "$(jq .extrapolation_error <<<"$grid")" null
    # In either order of storage, as bytes or booleans.
    python "a = np.load('body.npy'); np.save('c.npy', np.ascontiguousarray(a).astype(bool)); np.save('f.npy', np.asfortranarray(a).astype('i1'))"
    for file in body.npy c.npy f.npy; do
        run -0 "$ANALYZE" elastic --model voxel --image "$file" --young-modulus 400GPa --poisson-ratio 0.23
        near "$(value .young_modulus)" "$(jq .young_modulus <<<"$grid")" 1e-3
        assert_equal "$(value '.extrapolation_error, .grids[0].voxels' | paste -sd' ')" "null null"
        near "$(value '.relative_density')" "$(python "print(np.load('body.npy').mean())")" 1e-12
    done
    run -0 "$ANALYZE" conductivity --model voxel --image body.npy --conductivity 30W/m/K
    near "$(value .conductivity)" "$("$ANALYZE" conductivity --model voxel --voxels 5 --conductivity 30W/m/K necks.kiln | head -1 | jq .conductivity)" 1e-3
}

@test "analyze voxel: VTK reads what is written" {
    "$PYTHON" -c "import vtk" 2>/dev/null || skip "python3-vtk9 is not installed"
    run -0 "$ANALYZE" voxel --voxels 5 -o body.vti one.kiln
    "$ANALYZE" voxel --voxels 5 -o body.npy one.kiln
    run -0 "$PYTHON" -c "
import numpy, vtk
from vtk.util.numpy_support import vtk_to_numpy
reader = vtk.vtkXMLImageDataReader(); reader.SetFileName('body.vti'); reader.Update(); image = reader.GetOutput()
cells = vtk_to_numpy(image.GetCellData().GetArray('phase')); body = numpy.load('body.npy')
print((cells == body.ravel(order='F')).all(), [round(s * n * 1e9) for s, n in zip(image.GetSpacing(), body.shape)])"
    assert_output "True [$("$ANALYZE" info one.kiln | jq -r '[range(3) as $i | .box.vectors[$i][$i] * 1e9 | round] | join(", ")')]"
}

@test "analyze: images that are none are refused in one sentence" {
    options=(elastic --model voxel --young-modulus 1GPa --poisson-ratio 0.2 --image)
    refuse() {
        run -1 --separate-stderr "$ANALYZE" "${options[@]}" "$1"
        assert_equal "${#stderr_lines[@]}" 1
        assert_regex "$stderr" "$2"
    }
    python "
np.save('float.npy', np.ones((3, 3, 3))); np.save('flat.npy', np.ones((3, 3), 'u1')); np.save('two.npy', 2 * np.ones((3, 3, 3), 'u1'))
np.save('empty.npy', np.ones((3, 0, 3), 'u1')); np.save('void.npy', np.zeros((3, 3, 3), 'u1'))
a = np.ones((4, 4, 4), 'u1'); a[:, 2:] = 0; np.save('layers.npy', a)
whole = open('layers.npy', 'rb').read(); open('short.npy', 'wb').write(whole[:-1]); open('long.npy', 'wb').write(whole + b'x')
open('huge.npy', 'wb').write(whole[:128].replace(b'(4, 4, 4)', b'(4000000000, 4000000000, 4000000000)')[:128] + whole[128:]); open('text.npy', 'w').write('nothing')"
    refuse absent.npy "absent.npy cannot be read"
    refuse text.npy "text.npy: this is not a .npy file"
    refuse float.npy "the array's type is '<f8'; an image has bytes or booleans"
    refuse flat.npy "the array has 2 dimensions; an image has 3"
    refuse two.npy "value 0 of the array is 2; voxels are 0, void, or 1, solid"
    refuse empty.npy "empty.npy: the image is empty"
    refuse void.npy "void.npy: nothing in the image is solid"
    refuse short.npy "the file ends before its array does"
    refuse long.npy "1 bytes stand behind the array"
    refuse huge.npy "huge.npy: "
    refuse layers.npy "layers.npy: .*the solid does not reach round the box along y"
}

@test "analyze: what the voxel model cannot do, or does not use, is refused" {
    run -1 --separate-stderr "$ANALYZE" elastic --model voxel free.kiln
    assert_equal "$stderr" "analyze elastic: free.kiln, document 1: the box is not periodic along all axes, and voxels fill a periodic cell only; bend tests bodies with free faces"
    run -1 --separate-stderr "$ANALYZE" elastic --model voxel --voxels 900 necks.kiln
    assert_regex "$stderr" "voxels take [0-9.]+ GB of memory, and this machine has [0-9.]+ GB; ask for fewer voxels"
    run -1 --separate-stderr "$ANALYZE" elastic --model voxel --voxels 6,6.01 necks.kiln
    assert_regex "$stderr" "two of the grids are the same"
    refuse() { run -2 --separate-stderr "$ANALYZE" "${@:2}"; assert_regex "$stderr" "^analyze $2: $1"; }
    run -1 --separate-stderr "$ANALYZE" voxel -o two.npy necks.kiln
    assert_equal "$stderr" "analyze voxel: necks.kiln, document 2: a file holds one image, and this is a second state; analyze select picks one"
    refuse "--voxels: needs --model voxel" elastic --voxels 6 necks.kiln
    refuse "--image: needs --model voxel" elastic --image body.npy
    refuse "--bond-law: has no meaning with --model voxel" elastic --model voxel --bond-law series necks.kiln
    refuse "--boundary-resistance: has no meaning" conductivity --model voxel --conductivity 1W/m/K --boundary-resistance 1e-8m2K/W necks.kiln
    refuse "--young-modulus: needs --image" elastic --model voxel --young-modulus 1GPa necks.kiln
    refuse "--poisson-ratio: is required" elastic --model voxel --young-modulus 1GPa --image body.npy
    refuse "--voxels: has no meaning with --image" elastic --model voxel --voxels 6 --young-modulus 1GPa --poisson-ratio 0 --image body.npy
    refuse "--image: is read in the place of states" elastic --model voxel --young-modulus 1GPa --poisson-ratio 0 --image body.npy necks.kiln
    refuse "--voxels: -1 is not between" elastic --model voxel --voxels -1 necks.kiln
    refuse "--tolerance: 1e-9 is not between 1e-6 and 0.01" elastic --model voxel --tolerance 1e-9 necks.kiln
    refuse "--output: names a file that ends in .npy or .vti" voxel necks.kiln
    refuse "--output: names a file that ends in .npy or .vti" voxel -o body.png necks.kiln
}

@test "analyze elastic --model voxel: memory is said with -v, SIGTERM ends a run without output" {
    run -0 --separate-stderr "$ANALYZE" elastic -v --model voxel --voxels 3 necks.kiln
    assert_regex "$stderr" "^analyze elastic: [0-9]+x[0-9]+x[0-9]+ voxels take [0-9]+ MB of memory"
    "$ANALYZE" elastic --model voxel --voxels 40 -o slow.json necks.kiln &
    sleep 1
    kill -TERM $!
    status=0
    wait $! || status=$?
    assert_equal "$status" 143
    [ ! -e slow.json ] || fail "a result was written"
}
