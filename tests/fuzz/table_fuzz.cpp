// table_fuzz.cpp: libFuzzer target: any bytes are read as a table of sizes, a list of spheres, a furnace's log and a bending test;
// what is taken must be sound. The first byte says how.
#include <sys/mman.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "io/csv.h"
#include "io/furnace_log.h"
#include "packing/size_table.h"
#include "packing/sphere_list.h"

namespace {

using namespace kiln;
using namespace kiln::packing;

constexpr std::size_t few = 64;  // spheres that are quick to pair
constexpr double closest = 1e3;  // largest radius over smallest, and box over smallest radius, of the same

void require(bool sound, const char* what) {
    if (sound) return;
    std::fprintf(stderr, "not sound: %s\n", what);
    std::abort();
}

/// Bytes as a file that has a name.
class NamedBytes {
   public:
    NamedBytes(const std::uint8_t* data, std::size_t size) : file_(memfd_create("fuzz", 0)) {
        require(file_ >= 0 && write(file_, data, size) == static_cast<ssize_t>(size), "file in memory");
    }
    NamedBytes(const NamedBytes&) = delete;
    NamedBytes& operator=(const NamedBytes&) = delete;
    ~NamedBytes() { close(file_); }

    std::string name() const { return "/proc/self/fd/" + std::to_string(file_); }

   private:
    int file_;
};

void check_sizes(const std::string& file, unsigned manner) {
    const FileManner given = manner & 8U ? FileManner{{"size", "share"}, "um"} : FileManner{};
    const auto weighting = manner & 16U ? std::optional(Weighting::volume) : std::nullopt;
    const auto shares = manner & 32U ? std::optional(Shares::undersize) : std::nullopt;
    const SizeDistribution sizes = read_sizes(file, weighting, shares, given);
    for (const Weighting by : {Weighting::number, Weighting::volume}) {
        double before = 0.0;
        for (const double fraction : {0.0, 0.1, 0.5, 0.9, 1.0}) {
            const double diameter = size_quantile(sizes, fraction, by);
            require(std::isfinite(diameter) && diameter > 0.0 && diameter >= before * (1.0 - 1e-9), "percentile");
            before = diameter;
        }
    }
    Random random(1);
    for (const double radius : draw_radii(sizes, 20, random)) require(std::isfinite(radius) && radius > 0.0, "radius");
}

void check_spheres(const std::string& file, unsigned manner) {
    const SphereList spheres = read_spheres(file, manner & 8U ? FileManner{{"x", "y", "z", "r"}, "um"} : FileManner{});
    require(!spheres.radius.empty() && spheres.position.size() == spheres.radius.size(), "rows");
    double least = HUGE_VAL, most = 0.0;
    for (std::size_t row = 0; row < spheres.radius.size(); ++row) {
        require(spheres.position[row].allFinite() && std::isfinite(spheres.radius[row]) && spheres.radius[row] > 0.0, "sphere");
        least = std::min(least, spheres.radius[row]);
        most = std::max({most, spheres.radius[row], spheres.position[row].cwiseAbs().maxCoeff()});
    }
    if (spheres.radius.size() > few || most > closest * least) return;
    const State state = body_of(spheres, {});
    require(state.box.lengths.allFinite() && (state.box.lengths.array() > 0.0).all(), "box");
    const Overlaps overlaps = overlaps_of(state);
    require(overlaps.mean >= 0.0 && overlaps.max <= 1.0, "overlaps");
}

void check_log(const std::string& file) {
    const physics::Schedule schedule = io::read_schedule(file);
    require(std::isfinite(schedule.end()) && schedule.end() > 0.0 && schedule.begin() == 0.0, "span");
    for (const double part : {0.0, 0.3, 0.5, 1.0}) {
        const double temperature = schedule.temperature(part * schedule.end());
        require(temperature > 0.0 && temperature <= schedule.highest() * (1.0 + 1e-12), "temperature");
    }
}

/// Columns as analyze asks for them.
void check_test(const std::string& file) {
    const io::CsvTable table(file);
    require(table.rows() > 0, "rows");
    const auto check = [&](const io::ColumnNames& names, io::Dimension dimension) {
        const std::vector<double> values = table.required(names, dimension);
        require(values.size() == table.rows(), "a value for each row");
        for (const double value : values) require(std::isfinite(value), "value");
    };
    check({"force", "load", "kraft", "standardkraft"}, io::Dimension::force);
    check({"deflection", "extension", "verformung", "weg"}, io::Dimension::length);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) return 0;
    const NamedBytes file(data + 1, size - 1);
    const unsigned manner = data[0];
    try {
        if (manner % 8 == 4)
            check_test(file.name());
        else if (manner % 4 == 0)
            check_log(file.name());
        else if (manner % 4 == 1)
            check_spheres(file.name(), manner);
        else
            check_sizes(file.name(), manner);
    } catch (const Error& error) {
        require(std::string(error.what()).size() < 1000, "a sentence, not a page");
    }
    return 0;
}
