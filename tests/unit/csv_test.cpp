// csv_test.cpp: tables as laboratories write them.
#include "io/csv.h"

#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>

#include "core/types.h"
#include "tests/physics/relative.h"

using namespace kiln;
using kiln::io::CsvTable;
using kiln::io::Dimension;
using kiln::test::relative;

namespace {

/// A table from text, by way of a file that is gone afterwards.
CsvTable table_of(const std::string& text) {
    const std::filesystem::path file = std::filesystem::temp_directory_path() / "kiln_csv_test.csv";
    std::ofstream(file, std::ios::binary) << text;
    struct Gone {
        const std::filesystem::path& file;
        ~Gone() { std::filesystem::remove(file); }
    } gone{file};
    return CsvTable(file);
}

void check_column(const std::string& text, const std::string& name, Dimension dimension, const std::vector<double>& wanted) {
    CAPTURE(text);
    const std::vector<double> found = table_of(text).required({name}, dimension);
    REQUIRE(found.size() == wanted.size());
    for (std::size_t row = 0; row < wanted.size(); ++row) CHECK(found[row] == relative(wanted[row], 1e-14));
}

void check_refused(const std::string& text, const std::string& words) {
    CAPTURE(text);
    CHECK_THROWS_WITH_AS(table_of(text).required({"force"}, Dimension::force), doctest::Contains(words.c_str()), Error);
}

}  // namespace

TEST_CASE("csv: commas, semicolons and tabs, with the decimal comma where commas do not separate") {
    check_column("force (N),deflection (m)\n1.5,2\n-3e2,4\n", "force", Dimension::force, {1.5, -300.0});
    check_column("force (N);deflection (m)\n1,5;2\n-3e2;4\n", "force", Dimension::force, {1.5, -300.0});
    check_column("force (N)\tdeflection (m)\n1,5\t2\n+3.25\t4\n", "force", Dimension::force, {1.5, 3.25});
    check_column("deflection (m);force (N)\n1,5;2,25\n", "force", Dimension::force, {2.25});
}

TEST_CASE("csv: a unit stands in brackets, behind a slash or behind the last underscore") {
    for (const char* heading : {"Force (mN)", "FORCE [mN]", "force/mN", "force_mN", "\"Force (mN)\"", "force at punch (mN) "})
        check_column(std::string(heading) + "\n250\n", "force", Dimension::force, {0.25});
    for (const char* heading : {"deflection (\u00b5m)", "deflection [\u03bcm]", "deflection_um"})
        check_column(std::string(heading) + "\n2\n", "deflection", Dimension::length, {2e-6});
    check_column("temperature (C)\n0\n1200\n", "temperature", Dimension::temperature, {273.15, 1473.15});
}

TEST_CASE("csv: remarks, blank lines, line ends of other systems and a byte order mark are passed over") {
    check_column("\xef\xbb\xbf# machine 7\n\nforce (N)\r\n1\r\n# paused\n\r\n2\r\n", "force", Dimension::force, {1.0, 2.0});
    check_column("force (N)\n1\n2", "force", Dimension::force, {1.0, 2.0});
}

TEST_CASE("csv: a name may be one of several, and a column that is not there is none") {
    const CsvTable table = table_of("Kraft/kN;Weg/mm;note (N)\n2;3;4\n");
    CHECK(table.required({"force", "kraft"}, Dimension::force) == std::vector<double>{2000.0});
    CHECK(table.required({"deflection", "weg"}, Dimension::length)[0] == relative(3e-3, 1e-14));
    CHECK_FALSE(table.column({"time"}, Dimension::time).has_value());
    CHECK(table_of("porosity,young_modulus (GPa)\n0.1,300\n").required({"porosity"}, Dimension::none) == std::vector<double>{0.1});
}

TEST_CASE("csv: what is no table of numbers is refused with its file and line") {
    check_refused("force (N)\n1\nx\n", "kiln_csv_test.csv, line 3: 'x' is not a number");
    check_refused("force (N)\n1\nnan\n", "line 3: 'nan' is not a number");
    check_refused("force (N)\n1e999\n", "line 2: '1e999' is not a number");
    check_refused("force (N)\n1 2\n", "line 2: '1 2' is not a number");
    check_refused("force (N),time (s)\n1,2\n3\n", "line 3: has 1 columns, the heading has 2");
    check_refused("force (N)\n", "has no rows of numbers");
    check_refused("", "has no rows of numbers");
    check_refused("force\n1\n", "column 'force' has no unit; known here: ");
    check_refused("force (m)\n1\n", "has the unit 'm'; known here: ");
    check_refused("force (N),Force 2 (N)\n1,2\n", "the columns 'force (N)' and 'Force 2 (N)' may both be meant");
    check_refused("time (s)\n1\n", "has no column 'force'");
    CHECK_THROWS_WITH_AS(CsvTable("no such file.csv"), doctest::Contains("no such file.csv: cannot be opened"), Error);
}

TEST_CASE("csv: a name tells whether a file is such a table") {
    CHECK(io::is_csv("a.csv"));
    CHECK(io::is_csv("A.CSV"));
    CHECK_FALSE(io::is_csv("a.csv.json"));
}
