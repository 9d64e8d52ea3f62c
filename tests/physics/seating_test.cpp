// seating_test.cpp: bars cut open and turned until they rest on their cylinders, and what both methods find from there.
#include "bending/seating.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "bending/dynamic_bending.h"
#include "bending/static_bending.h"
#include "tests/physics/bar_files.h"
#include "tests/physics/bonded_lattice.h"
#include "tests/physics/relative.h"
#include "bending/result_document.h"

using namespace kiln;
using namespace kiln::bending;
using test::relative;

TEST_CASE("a bar that rolls under the cylinders comes to rest whole: distances stay, and they turn it no further") {
    const State state = test::bar_of_file("dynamic_slope.kiln");
    const Result result = bend_static(state, {});
    const mechanics::BondNetwork& network = result.specimen.body.network;
    CHECK(result.specimen.turn.norm() > 0.3);
    CHECK(std::any_of(result.warnings.begin(), result.warnings.end(),
                      [](const std::string& words) { return words.find("rolls by") != std::string::npos; }));
    const mechanics::BondNetwork before = cut_specimen(state, {}).body.network;
    for (std::size_t bond = 0; bond < network.bonds(); ++bond) {
        CHECK(network.vector[bond].norm() == relative(before.vector[bond].norm(), 1e-12));
        const auto [i, j] = network.pair[bond];
        CHECK((network.position[static_cast<std::size_t>(j)] - network.position[static_cast<std::size_t>(i)] - network.vector[bond])
                  .norm() < 1e-12 * before.vector[bond].norm());
    }
    const mechanics::Seat seat = mechanics::seat_rigid(network, find_contacts(result.specimen, result.fixture).contacts, 1e-16);
    CHECK(seat.displacement.front().tail<3>().norm() / network.rotation_length < 1e-5);
    // The bent state is the one that came in, displaced.
    const State bent = bent_state(result);
    const auto displacement = std::find_if(bent.particles.other.begin(), bent.particles.other.end(),
                                           [](const NamedArray& each) { return each.name == "displacement"; });
    const auto& rows = std::get<std::vector<double>>(displacement->array.data);
    for (std::size_t node = 0; node < network.nodes(); ++node) {
        const Vec3 moved(rows[3 * node], rows[3 * node + 1], rows[3 * node + 2]);
        CHECK((bent.particles.position[node] - moved - before.position[node]).norm() < 1e-18);
    }
}

TEST_CASE("thin bars, which roll by tenths of a radian before they rest: both methods begin there and find the same forces") {
    for (const char* name : {"dynamic_seat.kiln", "dynamic_slope.kiln", "dynamic_150.kiln"}) {
        const State state = test::bar_of_file(name);
        Options still;
        still.cycles = 1;
        const Result expected = bend_static(state, still);
        CHECK(expected.specimen.turn.norm() > 0.05);
        const Point& full = expected.curve[6];
        Options slow = still;
        slow.method = Method::motion;
        const Result usual = bend_dynamic(state, slow);
        slow.punch_velocity = usual.dynamic.velocity / 4.0;
        const Result moving = bend_dynamic(state, slow);
        const Point& peak = *std::ranges::max_element(moving.curve, {}, &Point::force);
        CHECK(peak.force / peak.deflection == relative(full.force / full.deflection, 0.01));
        CHECK(peak.punch == relative(full.punch, 0.02));
        // Half unloaded.
        const auto below = std::find_if(moving.curve.begin() + (&peak - moving.curve.data()), moving.curve.end(),
                                        [&](const Point& point) { return point.force < 0.55 * peak.force; });
        CHECK(below->force / below->deflection == relative(full.force / full.deflection, 0.02));
        CHECK(moving.contacts == expected.contacts);
        CHECK(moving.energy_error < 1e-3);
    }
}

TEST_CASE("however many boxes away the bar lies: as many bonds are cut") {
    State near = test::make_rough_bar({12, 4, 4}), far = near;
    for (Vec3& position : near.particles.position) position[0] += 0.4 * near.box.lengths[0];
    for (Vec3& position : far.particles.position) position[0] += 127.4 * far.box.lengths[0];
    CHECK(cut_open(far) == cut_open(near));
}
