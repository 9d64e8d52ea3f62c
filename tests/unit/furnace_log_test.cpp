// furnace_log_test.cpp: schedules from tables as furnaces log them, and tables that are none.
#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>

#include "core/types.h"
#include "io/furnace_log.h"
#include "tests/physics/relative.h"

using namespace kiln;
using kiln::test::relative;

namespace {

physics::Schedule logged(const std::string& text, const io::LogColumns& columns = {}) {
    const std::filesystem::path file = std::filesystem::temp_directory_path() / "kiln_furnace_log_test.csv";
    std::ofstream(file) << text;
    return io::read_schedule(file.string(), columns);
}

std::string refused(const std::string& text) {
    try {
        logged(text);
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

}  // namespace

TEST_CASE("furnace log: units of time and temperature in the headings, or in a row below, decimal commas, other columns") {
    for (const char* text :
         {"time (s),temperature (C)\n0,25\n3600,1225\n7200,1225\n10800,625\n",
          "Time [min]\tTemp. [K]\n0\t298.15\n60\t1498.15\n120\t1498.15\n180\t898.15\n",
          "Ofen 3\n\nZeit;T Soll;T Ist;Leistung\nh;\u00b0C;\u00b0C;%\n0,0;25,0;25,0;0\n1,0;1300,0;1225,0;80\n"
          "2,0;1300;1225;60\n3,0;600;625;0\n",
          "# programme 5\nt (s) T (C)\n100 25\n3700 1225\n7300 1225\n10900 625\n",
          "Date,Time,Temperature PV (\u00b0C)\n2026-11-25,22:30:00,25\n2026-11-25,23:30:00,1225\n2026-11-26,00:30:00,1225\n"
          "2026-11-26,01:30:00,625\n",
          "Zeit;Temperatur in \u00b0C\n31.12.2026 22:30;25\n31.12.2026 23:30;1225\n01.01.2027 00:30;1225\n"
          "01.01.2027 01:30;625\n",
          "Time,Temp (degC)\n0:00:00,25\n1:00:00,1225\n2:00:00,1225\n3:00:00,625\n"}) {
        CAPTURE(text);
        const physics::Schedule schedule = logged(text);
        CHECK(schedule.begin() == 0.0);
        CHECK(schedule.end() == relative(10800.0, 1e-14));
        CHECK(schedule.highest() == relative(1498.15, 1e-14));
        CHECK(schedule.temperature(1800.0) == relative(898.15, 1e-13));
        CHECK(schedule.temperature(5000.0) == relative(1498.15, 1e-13));
        CHECK(schedule.temperature(9000.0) == relative(1198.15, 1e-13));
    }
}

TEST_CASE("furnace log: a column that is not clear is chosen by its heading") {
    const std::string two = "t (min),Temperature SP (C),Temperature PV (C)\n0,20,25\n10,1000,995\n";
    CHECK(refused(two).find("'Temperature SP (C)' and 'Temperature PV (C)' may both be meant; choose by --temperature-column") !=
          std::string::npos);
    CHECK(logged(two, {"", "Temperature PV"}).highest() == relative(1268.15, 1e-14));
    CHECK(logged(two, {"t (min)", "Temperature SP (C)"}).highest() == relative(1273.15, 1e-14));
}

TEST_CASE("furnace log: holds of thousands of rows are two corners, ramps are as they were logged") {
    std::string text = "time (s),T (C)\n";
    for (int row = 0; row <= 4000; ++row) text += std::to_string(row) + "," + std::to_string(row < 1000 ? 25 + row : 1025) + "\n";
    const physics::Schedule schedule = logged(text);
    CHECK(schedule.end() == 4000.0);
    CHECK(schedule.panels(1000.0, 4000.0).size() == 2);
    for (const double time : {0.5, 500.25, 999.5}) CHECK(schedule.temperature(time) == relative(298.15 + time, 1e-13));
}

TEST_CASE("furnace log: what is no schedule is refused with its line") {
    CHECK(refused("time (s),T (C)\n0,25\n100,900\n90,1000\n").find(", line 4: the time goes back") != std::string::npos);
    CHECK(refused("time,T (C)\n23:59:00,25\n00:01:00,30\n").find(", line 3: the time goes back") != std::string::npos);
    CHECK(refused("time (s),T\n0,25\n100,900\n").find("'T' has no unit; known here: K, C") != std::string::npos);
    CHECK(refused("time,T (C)\n0,25\n100,900\n").find("'time' has no unit; known here: s, ms, us, min, h, d") != std::string::npos);
    CHECK(refused("time (s),T (K)\n0,25\n100,900\n").find(", line 2: '25' K is colder than any furnace") != std::string::npos);
    CHECK(refused("time (s),T (C)\n0,25\n100,9000\n").find(", line 3: '9000' C is hotter than any furnace") != std::string::npos);
    CHECK(refused("time (s),T (C)\n0,25\n100,\n").find(", line 3") != std::string::npos);
    CHECK(refused("time (s),T (C)\n0,25\n").find("has one row") != std::string::npos);
    CHECK(refused("time (s),T (C)\n5,25\n5,30\n").find("same time") != std::string::npos);
    CHECK(refused("time (m),T (C)\n0,25\n5,30\n").find("'m'; known here") != std::string::npos);
    CHECK(refused("time,T (C)\n11/12/2026 10:00,25\n11/12/2026 11:00,30\n").find(", line 2: '11/12/2026 10:00' is no time") !=
          std::string::npos);
    CHECK(refused("x (um),y (um)\n0.5,0.5\n").find("its headings are 'x (um)', 'y (um)'") != std::string::npos);
}
