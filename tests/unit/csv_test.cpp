// csv_test.cpp: tables as laboratories write them.
#include "io/csv.h"

#include <doctest/doctest.h>

#include "core/types.h"
#include "tests/physics/relative.h"

using namespace kiln;
using kiln::io::CsvTable;
using kiln::io::Dimension;
using kiln::test::relative;

namespace {

CsvTable table_of(const std::string& text) { return {"bar.csv", text}; }

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
    check_column("force (N)\tdeflection (m)\n1,5\t2\n+3,25\t4\n", "force", Dimension::force, {1.5, 3.25});
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

/// As little-endian UTF-16, of characters below 256.
std::string utf16(const std::string& latin1, bool big_endian) {
    std::string bytes;
    for (const char c : latin1) bytes += big_endian ? std::string{'\0', c} : std::string{c, '\0'};
    return bytes;
}

TEST_CASE("csv: a report above the heading is passed over, with its own numbers and as many cells") {
    for (const char* report : {"\"Specimen label\",\"bar 7\"\n\"Anvil height\",3.11,\"mm\"\n\n",
                               "bar 7, of lot 3\nspan,40\nwidth,4.0\n", "name,bar 7,\nheight,3,mm\n\n\n", "# report\n"})
        check_column(std::string(report) + "Time (s),Force (N),Stroke (mm)\n0,1.5,2\n1,3,4\n2,5,6\n3,7,8\n", "force",
                     Dimension::force, {1.5, 3.0, 5.0, 7.0});
}

TEST_CASE("csv: units stand in a row of their own, with or without brackets") {
    for (const char* units : {"(s),(kN),(mm)", "s,kN,mm", "[s],[kN],[mm]", "\"(s)\",\"(kN)\",\"(mm)\"", ",kN,mm", "sec,kN,mm"})
        check_column("Time,Force,Stroke\n" + std::string(units) + "\n0,1.5,2\n1,3,4\n", "force", Dimension::force,
                     {1500.0, 3000.0});
    check_column("Force,part\nkN,\n1.5,2\n3,4\n", "force", Dimension::force, {1500.0, 3000.0});
    check_column("Force (N),Stroke\n(N),(mm)\n1,2\n", "force", Dimension::force, {1.0});
    check_refused("Force (N),Stroke\nkN,mm\n1,2\n", "column 'Force (N)' has the unit 'N and kN'");
    check_refused("Time,Force\ns,lbf\n1,2\n", "column 'Force (lbf)' has the unit 'lbf'; known here: N, kN");
    CHECK(table_of("Time,Load\n(s),(N)\n1,2\n").heading(1) == "Load (N)");
}

TEST_CASE("csv: a heading says its unit in many ways") {
    for (const char* heading : {"Force in mN", "Force, mN", "Force mN", "Force (raw) / mN", "force_mN", "Force (mN) raw",
                                "\xa0"
                                "Force [mN]"})
        check_column(std::string("t;") + heading + "\n1;250\n", "force", Dimension::force, {0.25});
}

TEST_CASE("csv: encodings") {
    const std::string latin1 = "Pr\xfc" "fzeit;Weg / \xb5m\n0,5;2,5\n";
    const std::string utf8 = "Pr\u00fcfzeit;Weg / \u00b5m\n0,5;2,5\n";
    for (const std::string& text : {utf8, "\xef\xbb\xbf" + utf8, latin1, "\xff\xfe" + utf16(latin1, false),
                                    "\xfe\xff" + utf16(latin1, true), utf16(latin1, false), utf16(latin1, true), utf8 + "\x1a"}) {
        check_column(text, "weg", Dimension::length, {2.5e-6});
        check_column("sep=;\r\n" + utf8, "weg", Dimension::length, {2.5e-6});
    }
    check_refused("\x1f\x8b\x08 and so on", "bar.csv: is compressed (gzip); unpack it first");
    check_refused("PK\x03\x04 and so on", "bar.csv: is a workbook or an archive (zip), no text");
    check_refused("force (N)\n1\n\x01\n", "bar.csv, line 3: has the control character 1, so it is no text");
    check_refused("force (N)\n1\n\x81\n", "bar.csv, line 3: is neither UTF-8 nor Latin-1 text");
    check_refused("\xff\xfe" "f\0o", "bar.csv, line 1: is not whole UTF-16 text");
}

TEST_CASE("csv: a first line 'sep=' says the separator") {
    check_column("sep=|\nforce (N)|time (s)\n1|2\n", "force", Dimension::force, {1.0});
    check_column("sep=,\nforce (N),a;b\n1,2\n", "force", Dimension::force, {1.0});
    check_refused("sep=,\nforce (N)\n1\nx\n", "line 4: 'x' is not a number");
}

TEST_CASE("csv: separators at the ends of rows, cells in quotation marks, columns of words") {
    check_column("deflection (mm),force (N),\n1,2,\n3,4,\n", "force", Dimension::force, {2.0, 4.0});
    check_column("deflection (mm),force (N)\n1,2,\n3,4,,\n,,\n", "force", Dimension::force, {2.0, 4.0});
    check_column("force (N),note\n\"1.5\",\"with, comma and \"\"marks\"\"\"\n3,\n", "force", Dimension::force, {1.5, 3.0});
    check_column("force (N),deflection (mm)\n\"1,5\",\"0,25\"\n\"3,0\",\"0,5\"\n", "force", Dimension::force, {1.5, 3.0});
    check_column("sample,force (N)\n3\" bar,1.5\nB,3\n", "force", Dimension::force, {1.5, 3.0});
    check_column("force (N),channel 2\n1,nan\n2,\n3,4\n4,5\n", "force", Dimension::force, {1.0, 2.0, 3.0, 4.0});
}

TEST_CASE("csv: a heading may begin with the sign of a remark") {
    check_column("# force (N),time (s)\n1,2\n3,4\n", "force", Dimension::force, {1.0, 3.0});
    check_column("# made on a Monday, at noon\nforce (N),time (s)\n1,2\n", "force", Dimension::force, {1.0});
}

TEST_CASE("csv: commas mark decimals only where nothing else in the file says otherwise") {
    check_refused("deflection (um);force (N)\n0.000;0\n7.407;10,000\n",
                  "line 3: '10,000' has a comma and '0.000' in line 2 a point");
    check_refused("force (N);deflection (um)\n10,000;1\n20,000;2\n", "'10,000' and all other commas stand before three digits");
    check_column("force (N);deflection (um)\n0,500;1\n10,000;2\n", "force", Dimension::force, {0.5, 10.0});
    check_refused("force (N);x\n1.234,5;1\n0,5;2\n0,25;3\n", "line 2: '1.234,5' is not a number");
    check_refused("force (N);x\n1,234,567;1\n0,5;2\n0,25;3\n", "line 2: '1,234,567' is not a number");
    check_column("force (N);date\n1,5;24.12\n2,5;24.12.2024\n3,5;1.1.2025\n", "force", Dimension::force, {1.5, 2.5, 3.5});
}

TEST_CASE("csv: which column is meant is clear, or the headings are named") {
    check_refused("Time (s),Extension (mm),Load cell (V)\n1,2,3\n",
                  "has no column 'force'; its headings are 'Time (s)', 'Extension (mm)', 'Load cell (V)'");
    check_refused("Force (N),Force (N)\n1,2\n", "the column 'Force (N)' stands twice");
    check_column("Force (V),Force 2 (N)\n1,2\n", "force", Dimension::force, {2.0});
    check_refused("Forced rate (N)\n1\n", "has no column 'force'");
    const CsvTable table = table_of("Time (s),Load 1 (N),Load 2 (N)\n1,2,3\n");
    const io::ColumnNames names{"force", "load"};
    CHECK_THROWS_WITH_AS(table.get(names, Dimension::force, {"--force-column", ""}),
                         "bar.csv: the columns 'Load 1 (N)' and 'Load 2 (N)' may both be meant; choose by --force-column", Error);
    for (const char* heading : {"Load 2 (N)", "load 2", "LOAD 2 [N]"})
        CHECK(table.get(names, Dimension::force, {"--force-column", heading}) == 2);
    CHECK_THROWS_WITH_AS(table.get(names, Dimension::force, {"--force-column", "Kraft"}),
                         doctest::Contains("bar.csv: has no column 'Kraft' of --force-column; its headings are 'Time (s)'"), Error);
    CHECK(table_of("PR\u00dcFKRAFT [N];E [GPa];Energy (GPa)\n1;2;3\n").get({"e$"}, Dimension::pressure) == 1);
    CHECK(table_of("PR\u00dcFKRAFT [N];x\n1;2\n").get({"pr\u00fcfkraft"}, Dimension::force) == 0);
}

TEST_CASE("csv: percent are a hundredth, whatever the values, and no other unit stands for a fraction") {
    check_column("porosity (%)\n0.2\n30\n", "porosity", Dimension::fraction, {0.002, 0.3});
    check_column("porosity_percent\n0.2\n", "porosity", Dimension::fraction, {0.002});
    for (const char* heading : {"porosity", "porosity [-]", "porosity (1)"})
        check_column(std::string(heading) + "\n0.2\n", "porosity", Dimension::fraction, {0.2});
    CHECK_THROWS_WITH_AS(table_of("density (g/cm3)\n0.9\n").required({"density"}, Dimension::fraction),
                         doctest::Contains("column 'density (g/cm3)' has the unit 'g/cm3'; known here: %, percent"), Error);
    CHECK_THROWS_WITH_AS(table_of("count (%)\n1\n").required({"count"}, Dimension::none),
                         doctest::Contains("column 'count (%)' has the unit '%', a plain number is required"), Error);
}

TEST_CASE("csv: temperatures stand above absolute zero") {
    check_column("T (K),t (s)\n300,1\n", "t", Dimension::temperature, {300.0});
    CHECK_THROWS_WITH_AS(table_of("temperature (\u00b0C)\n20\n-300\n").required({"temperature"}, Dimension::temperature),
                         doctest::Contains("bar.csv, line 3: '-300' "), Error);
}

TEST_CASE("csv: what is no table of numbers is refused with its file and line") {
    check_refused("force (N)\n1\nx\n", "bar.csv, line 3: 'x' is not a number");
    check_refused("force (N)\n1\nnan\n", "line 3: 'nan' is not a number");
    check_refused("force (N)\n1e999\n", "line 2: '1e999' is not a number");
    check_refused("force (kN)\n1e306\n", "line 2: column 'force (kN)' is out of the range of numbers");
    check_refused("force (N)\n1 2\n", "has no rows of numbers; line 1 is 'force (N)'");
    check_refused("force (N)\n1\n1 2\n", "line 3: '1 2' is not a number");
    check_refused("1,2\n3,4\n", "line 1: has numbers and no heading above them, such as");
    check_refused("force (N),time (s)\n1,2\n3\n", "line 3: has 1 column, the heading has 2");
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

TEST_CASE("csv: blanks separate cells where every row then has as many, with the unit in the cell of its name") {
    check_column("# force (N)   deflection (m)\n 1.5   2\n  -3e2 4\n", "force", Dimension::force, {1.5, -300.0});
    check_column("deflection (m) force (N)\n1,5 2,25\n2,5 3,5\n", "force", Dimension::force, {2.25, 3.5});
    check_refused("deflection (m) force (N)\n1 2\n3\n", "bar.csv");
}

TEST_CASE("csv: columns may be named by the user, in files with and without a heading") {
    for (const char* text :
         {"1.5 7 2\n3.5 8 4\n", "1.5;7;2\n3.5;8;4\n", "a,b,c\n1.5,7,2\n3.5,8,4\n", "# three\n\n1,5\t7\t2\n3,5\t8\t4\n"}) {
        CAPTURE(text);
        const CsvTable table("bar.csv", text, {"force (N)", "-", "way"});
        CHECK(table.required({"force"}, Dimension::force) == std::vector{1.5, 3.5});
        CHECK(table.values(table.get({"way"}, Dimension::length), Dimension::length, "m") == std::vector{2.0, 4.0});
    }
    CHECK_THROWS_WITH_AS(CsvTable("bar.csv", "1.5 7\n3.5 8\n", {"a", "b", "c"}), "bar.csv, line 1: has 2 columns, and 3 are named",
                         Error);
    CHECK_THROWS_WITH_AS(CsvTable("bar.csv", "1.5 7\n3.5 8 9\n", {"a", "b"}), doctest::Contains("line"), Error);
}

TEST_CASE("csv: names that are units too do not make a row of units of the row of names") {
    const CsvTable table("bar.csv", "d;h;T\nnm;nm;C\n1;2;3\n");
    CHECK(table.values(table.get({"d$"}, Dimension::length), Dimension::length)[0] == relative(1e-9, 1e-14));
    CHECK(table.values(table.get({"t$"}, Dimension::temperature), Dimension::temperature)[0] == relative(276.15, 1e-14));
}

TEST_CASE("csv: a heading that is nothing but the sign of a remark") {
    CHECK(table_of("#,force (N)\n1,2\n2,3\n").required({"force"}, Dimension::force) == std::vector{2.0, 3.0});
    check_refused("#\n0,\n#f\n", "bar.csv");
    check_refused("SEP= \n", "bar.csv: has no rows of numbers");
    check_refused("sep= \nforce (N)\n1 2\n", "bar.csv");
}
