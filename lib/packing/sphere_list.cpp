// sphere_list.cpp: the box around given spheres, and what no body can hold.
#include "packing/sphere_list.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/neighbours.h"
#include "io/csv.h"

namespace kiln::packing {

namespace {

constexpr double rounding = 1e-6;  // of an edge, by which a centre may lie outside: lists are often written with six digits

const io::ColumnNames radius_names{"radius", "r$", "rad$", "radii$"};
const io::ColumnNames diameter_names{"diameter", "d$", "diam", "durchmesser"};
const io::ColumnNames material_names{"material", "type", "phase"};

io::ColumnNames names_of_axis(const std::string& axis) {
    return {axis + "$",          "pos" + axis + "$",   "pos_" + axis + "$",   "position_" + axis + "$", "position " + axis + "$",
            axis + " position$", "center_" + axis + "$", "centroid_" + axis + "$", axis + "_center$",      axis + "c$"};
}

/// The names that the first line "#format x_y_z_r" of Yade gives the columns.
std::vector<std::string> names_of_yade(const std::string& bytes) {
    constexpr std::string_view begin = "#format ";
    if (!bytes.starts_with(begin)) return {};
    std::vector<std::string> names(1);
    for (std::size_t at = begin.size(); at < bytes.size() && bytes[at] != '\n' && bytes[at] != '\r'; ++at) {
        if (bytes[at] == '_')
            names.emplace_back();
        else if (bytes[at] != ' ')
            names.back() += bytes[at];
    }
    return names;
}

/// Throws Error where the file has particles of several materials: a body here has one.
void check_one_material(const io::CsvTable& table, const std::string& file) {
    const auto column = table.find(material_names, io::Dimension::none);
    for (std::size_t row = 1; column && row < table.rows(); ++row)
        if (table.cell(row, *column) != table.cell(0, *column))
            throw Error(file + ": the column " + io::excerpt(table.heading(*column)) +
                        " has several values, and a green body of spheres has one material; dem-convert reads several");
}

const char* name_of(int axis) { return axis == 0 ? "x" : axis == 1 ? "y" : "z"; }

std::string rounded(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.6g", value);
    return text;
}

Box box_of(const SphereList& spheres, const SphereOptions& options) {
    Box box;
    box.periodic = options.periodic;
    for (int axis = 0; axis < 3; ++axis) {
        if (options.lengths) {
            box.lengths[axis] = (*options.lengths)[axis];
            box.origin[axis] = options.origin ? (*options.origin)[axis] : 0.0;
            continue;
        }
        if (options.periodic[static_cast<std::size_t>(axis)])
            throw Error(std::string("the box is periodic along ") + name_of(axis) + ", and its length is not given");
        double low = HUGE_VAL, high = -HUGE_VAL;
        for (std::size_t row = 0; row < spheres.radius.size(); ++row) {
            low = std::min(low, spheres.position[row][axis] - spheres.radius[row]);
            high = std::max(high, spheres.position[row][axis] + spheres.radius[row]);
        }
        box.origin[axis] = low;
        box.lengths[axis] = high - low;
    }
    if (!(box.volume() > 0.0 && std::isfinite(box.volume()))) throw Error("the volume of the box is out of the range of numbers");
    return box;
}

void check_inside(const SphereList& spheres, const Box& box) {
    for (std::size_t row = 0; row < spheres.position.size(); ++row)
        for (int axis = 0; axis < 3; ++axis) {
            const double begin = box.origin[axis], end = begin + box.lengths[axis], at = spheres.position[row][axis];
            if (at >= begin - rounding * box.lengths[axis] && at <= end + rounding * box.lengths[axis]) continue;
            throw Error("the centre of sphere " + std::to_string(row) + " has " + name_of(axis) + " = " + rounded(at) +
                        " m, counted from 0, and the box reaches from " + rounded(begin) + " m to " + rounded(end) + " m");
        }
}

void check_apart(const State& state) {
    const Particles& particles = state.particles;
    for (const Pair& pair : find_pairs(state.box, particles.position, particles.radius)) {
        const auto first = static_cast<std::size_t>(pair.i), second = static_cast<std::size_t>(pair.j);
        const double distance = pair_vector(state.box, particles.position, pair).norm();
        const double difference = std::abs(particles.radius[first] - particles.radius[second]);
        if (distance > difference && distance > 0.0) continue;
        throw Error("sphere " + std::to_string(first) + " and sphere " + std::to_string(second) +
                    (distance == 0.0 ? " lie at one place" : " lie one inside the other") + ", counted from 0");
    }
}

}  // namespace

SphereList read_spheres(const std::string& file, const FileManner& manner) {
    const std::string bytes = io::bytes_of(file);
    const std::vector<std::string> names = manner.columns.empty() ? names_of_yade(bytes) : manner.columns;
    const io::CsvTable table = names.empty() ? io::CsvTable(file, bytes) : io::CsvTable(file, bytes, names);
    bool unit_used = false;
    const auto lengths = [&](std::size_t column) {
        if (table.unit(column).empty()) {
            if (manner.unit.empty())
                throw Error(file + ": column " + io::excerpt(table.heading(column)) + " has no unit; --length-unit names it");
            unit_used = true;
        }
        return table.values(column, io::Dimension::length, manner.unit);
    };
    SphereList spheres;
    spheres.position.resize(table.rows());
    for (int axis = 0; axis < 3; ++axis) {
        const auto column = table.find(names_of_axis(name_of(axis)), io::Dimension::length);
        if (!column)
            throw Error(file + ": has no column " + name_of(axis) + "; its headings are " + table.headings_text() +
                        ", and --columns x,y,z,r names them");
        const std::vector<double> values = lengths(*column);
        for (std::size_t row = 0; row < values.size(); ++row) spheres.position[row][axis] = values[row];
    }
    const auto radius = table.find(radius_names, io::Dimension::length);
    const auto diameter = table.find(diameter_names, io::Dimension::length);
    if (radius.has_value() == diameter.has_value())
        throw Error(file + ": has " + (radius ? "both a radius and a diameter" : "neither a radius nor a diameter") +
                    "; its headings are " + table.headings_text() + ", and --columns x,y,z,r names them");
    const std::size_t size = radius ? *radius : *diameter;
    spheres.radius = lengths(size);
    for (std::size_t row = 0; row < spheres.radius.size(); ++row) {
        if (diameter) spheres.radius[row] *= 0.5;
        if (!(spheres.radius[row] > 0.0))
            throw Error(table.place(row) + ": the " + (radius ? "radius " : "diameter ") + io::excerpt(table.cell(row, size)) +
                        " is not above zero");
    }
    check_one_material(table, file);
    if (!manner.unit.empty() && !unit_used) throw Error(file + ": all lengths have units, and --length-unit gives one more");
    return spheres;
}

State body_of(const SphereList& spheres, const SphereOptions& options) {
    if (spheres.radius.empty()) throw Error("there are no spheres");
    State state;
    state.box = box_of(spheres, options);
    check_inside(spheres, state.box);
    Particles& particles = state.particles;
    particles.radius = spheres.radius;
    particles.id.resize(particles.size());
    std::iota(particles.id.begin(), particles.id.end(), std::int64_t{0});
    particles.material.assign(particles.size(), 0);
    const double factor = 1.0 / (1.0 + options.swell);
    for (const Vec3& position : spheres.position)
        particles.position.push_back(state.box.origin + factor * (state.box.wrap(position) - state.box.origin));
    state.box.lengths *= factor;
    check_apart(state);
    return state;
}

Overlaps overlaps_of(const State& state) {
    constexpr double beyond_rounding = 1.0 + 1e-9;  // so that spheres which only touch are found too
    const Particles& particles = state.particles;
    std::vector<double> reach = particles.radius;
    for (double& each : reach) each *= beyond_rounding;
    Overlaps overlaps;
    double sum = 0.0;
    for (const Pair& pair : find_pairs(state.box, particles.position, reach)) {
        const double first = particles.radius[static_cast<std::size_t>(pair.i)];
        const double second = particles.radius[static_cast<std::size_t>(pair.j)];
        const double overlap = contact_overlap(first, second, pair_vector(state.box, particles.position, pair).norm());
        if (overlap < 0.0) continue;
        ++overlaps.contacts;
        sum += overlap / (first + second);
        overlaps.max = std::max(overlaps.max, overlap / (first + second));
    }
    if (overlaps.contacts > 0) overlaps.mean = sum / static_cast<double>(overlaps.contacts);
    return overlaps;
}

}  // namespace kiln::packing
