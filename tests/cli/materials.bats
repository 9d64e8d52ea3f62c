#!/usr/bin/env bats
# materials.bats: the built-in materials with their sources, and what every program says of a material that lacks or mistakes something.
bats_require_minimum_version 1.5.0
load helper.bash

setup_file() {
    cd "$BATS_FILE_TMPDIR"
    "$SINTER" green -n 60 --compact-to 0.6 -o alumina.kiln
    "$SINTER" --temperature 1200C --to-density 0.62 alumina.kiln | "$BONDIFY" -q -o bonded.kiln
    printf '{"name":"zr","surface_enrgy":1.0,"young_modulus":210,"source":"mine"}\n' >wrong.json
    printf '{"name":"zr","surface_energy":1.0,"atomic_volume":3.4e-29,"grain_boundary_diffusion":{"prefactor":0.01,"activation_energy":580}}\n' >fast.json
}

setup() { cd "$BATS_FILE_TMPDIR"; }

@test "the list has every material with what it can be used for, and each of them whole with its sources" {
    run -0 "$ANALYZE" materials --table
    assert_line --regexp "^ +name +density, kg/m3 .* sinters +coarsens +bends$"
    for row in "alumina +3950 .* yes +no +yes" "alumina-dihedral .* yes +yes +yes" "copper .* yes +no +yes" "nickel .* yes +no +yes" \
        "silver .* yes +no +no" "zirconia-3y .* no +no +yes"; do assert_line --regexp "^ *$row$"; done
    run -0 jq -s -e 'all(.format == "dem-material" and .built_in and (.remarks == []) and (.constants | all(.source != "" and .meaning != "" and .unit != "")))' \
        <("$ANALYZE" materials)
    run -0 "$ANALYZE" materials --table zirconia-3y
    assert_line --partial "Mazaheri"
    assert_line "  sintering needs grain_boundary_diffusion"
    refute_line --regexp '^.{101}'
}

@test "a built-in material is a file for --material, and the same as by its name" {
    "$ANALYZE" materials nickel | jq .material >nickel.json
    "$SINTER" green -n 60 --material nickel.json --text | jq -c .materials >file.json
    "$SINTER" green -n 60 --material nickel --text | jq -c .materials >name.json
    cmp file.json name.json
    run -0 "$ANALYZE" materials nickel.json
    assert_equal "$(value '[.built_in, .material.name, .remarks] | tostring')" '[false,"nickel",[]]'
}

@test "sinter green says at once what is wrong with a material, and what each later stage will lack" {
    run -0 --separate-stderr "$SINTER" green -n 60 --material wrong.json -o wrong.kiln
    assert_equal "$stderr" "sinter green: warning: material 'zr' has a key 'surface_enrgy' that nothing reads; is surface_energy meant?
sinter green: warning: material 'zr': a young_modulus of 210.0 Pa is that of no solid; Pa are meant, not MPa or GPa
sinter green: warning: material 'zr' has no surface_energy, atomic_volume, grain_boundary_diffusion, which sintering needs, and no \
surface_diffusion, which coarsening by surface diffusion needs, and no boundary_mobility, dihedral_angle, which coarsening by boundaries \
needs, and no poisson_ratio, which elasticity needs, and no density, which inertia needs; its 'surface_enrgy' may be meant for surface_energy"
    run -0 --separate-stderr "$SINTER" green -q -n 60 --material wrong.json -o quiet.kiln
    assert_equal "$stderr" ""
    run -0 --separate-stderr "$SINTER" green -n 60 -o quiet.kiln
    assert_equal "$stderr" ""
}

@test "every program names all constants that it lacks before it computes anything" {
    missing="has no surface_energy, atomic_volume, grain_boundary_diffusion, which sintering needs"
    run -1 "$SINTER" --temperature 1200C --to-density 0.7 --coarsening surface,boundary --material wrong.json alumina.kiln
    assert_line --partial "$missing, and no surface_diffusion, which coarsening by surface diffusion needs, and no boundary_mobility, dihedral_angle, which"
    run -1 "$SINTER" --temperature 1200C --at-time 1s --method explicit --material wrong.json alumina.kiln
    assert_line --partial "$missing, and no density, which inertia needs"
    for command in "$BEND" "$ANALYZE elastic" "$ANALYZE elastic --model voxel"; do
        run -1 $command --material fast.json bonded.kiln
        assert_output --regexp "^(bend|analyze elastic): bonded.kiln, document 1: material 'zr' has no young_modulus, poisson_ratio, which elasticity needs; --material"
    done
    run -1 "$BEND" --method dynamic --material fast.json bonded.kiln
    assert_output --partial "which elasticity needs, and no density, which inertia needs"
    # What was carried in from elsewhere is asked for as well.
    run -1 "$SINTER" --temperature 1200C --to-density 0.7 wrong.kiln
    assert_line --partial "wrong.kiln, document 1: material 'zr' $missing; its 'surface_enrgy' may be meant for surface_energy; --material NAME"
}

@test "constants in a wrong unit are doubted where they are used, and so is a powder that sinters in no time" {
    run -0 --separate-stderr "$SINTER" --temperature 1200C --to-density 0.7 --material fast.json -o fast.kiln alumina.kiln
    assert_regex "$stderr" "an? grain_boundary_diffusion.activation_energy of 580.0 J/mol is that of no solid; J/mol are meant, not kJ/mol or eV"
    assert_regex "$stderr" "alumina.kiln, document 1: at 1473.15 K the relative density is 0.6[0-9]* after [0-9.]+e-[12][0-9] s: no powder sinters so fast"
    run -0 --separate-stderr "$SINTER" --temperature 1200C --to-density 0.7 -o slow.kiln alumina.kiln
    assert_equal "$stderr" ""
    # The activation energy is no matter of bending.
    printf '{"name":"zr","young_modulus":210,"poisson_ratio":0.3,"grain_boundary_diffusion":{"prefactor":0.01,"activation_energy":580}}\n' >soft.json
    run -0 --separate-stderr "$ANALYZE" elastic --material soft.json bonded.kiln
    assert_equal "$stderr" "analyze elastic: warning: material 'zr': a young_modulus of 210.0 Pa is that of no solid; Pa are meant, not MPa or GPa"
}
