// bondify.cpp: overlaps are found, particles shrink or stay, bonds get their radii and lengths.
#include "bonding/bondify.h"

#include <cmath>
#include <numeric>
#include <sstream>

#include "bonding/event_queue.h"
#include "bonding/sweep.h"
#include "core/neighbours.h"
#include "physics/neck.h"

namespace kiln::bonding {

namespace {

/// Room to shrink: twice what the smallest radii would fill.
constexpr double closest_share = 2.0 * min_share;

std::vector<Overlap> overlaps_of(const State& state, const std::vector<Pair>& pairs) {
    const Particles& particles = state.particles;
    std::vector<Overlap> overlaps;
    overlaps.reserve(pairs.size());
    for (const Pair& pair : pairs) {
        const auto i = static_cast<std::size_t>(pair.i);
        const auto j = static_cast<std::size_t>(pair.j);
        const double distance = pair_vector(state.box, particles.position, pair).norm();
        if (distance < closest_share * (particles.radius[i] + particles.radius[j])) {
            std::ostringstream words;
            words << "particles " << particles.id[i] << " and " << particles.id[j] << ": their centres are " << distance
                  << " m apart, too close for a bond between spheres of radius " << particles.radius[i] << " m and "
                  << particles.radius[j] << " m";
            throw Error(words.str());
        }
        overlaps.push_back({pair.i, pair.j, distance});
    }
    return overlaps;
}

/// Solid volume, m3, summed in long double: the error that is reported is not to be that of the sum.
long double solid_volume(std::span<const double> radius, std::span<const double> bond_volume) {
    constexpr long double pi = 3.14159265358979323846264338327950288L;
    long double cubes = 0.0L;
    long double bonds = 0.0L;
    for (const long double r : radius) cubes += r * r * r;
    for (const double volume : bond_volume) bonds += volume;
    return 4.0L / 3.0L * pi * cubes + bonds;
}

/// The bonds, thin ones included, with what there is to count about them.
Bonds make_bonds(const std::vector<Pair>& pairs, const std::vector<Overlap>& overlaps, const ShrunkSpheres& shrunk,
                 const Options& options, Summary& summary) {
    Bonds bonds;
    bonds.volume = shrunk.volume;
    summary.bond_volume = std::accumulate(shrunk.volume.begin(), shrunk.volume.end(), 0.0);
    for (std::size_t bond = 0; bond < overlaps.size(); ++bond) {
        const auto [first, second, distance] = overlaps[bond];
        const double radius1 = shrunk.radius[static_cast<std::size_t>(first)];
        const double radius2 = shrunk.radius[static_cast<std::size_t>(second)];
        const double radius = physics::bond_radius(shrunk.volume[bond], distance, radius1, radius2, options.volume);
        bonds.pair.push_back({first, second});
        bonds.image.push_back(pairs[bond].image);
        bonds.radius.push_back(radius);
        bonds.length.push_back(physics::bond_length(distance, radius1, radius2, radius));

        if (radius < std::min(radius1, radius2)) continue;
        ++summary.clamped;
        summary.lost_volume += shrunk.volume[bond] - physics::bond_volume(distance, radius1, radius2, radius, options.volume);
    }
    return bonds;
}

/// Counts the thin bonds and leaves them out if the options say so.
void treat_thin(Bonds& bonds, std::span<const double> radius, const Options& options, Summary& summary) {
    std::vector<std::int32_t> thick;
    for (std::size_t bond = 0; bond < bonds.size(); ++bond) {
        const auto [first, second] = bonds.pair[bond];
        const double smaller = std::min(radius[static_cast<std::size_t>(first)], radius[static_cast<std::size_t>(second)]);
        if (bonds.radius[bond] >= options.thin_ratio * smaller) {
            thick.push_back(static_cast<std::int32_t>(bond));
            continue;
        }
        ++summary.thin;
        if (options.drop_thin) summary.dropped_volume += bonds.volume[bond];
    }
    if (options.drop_thin && summary.thin > 0) bonds = take_rows(bonds, thick);
}

double mean(std::span<const double> values) {
    double sum = 0.0;
    for (const double value : values) sum += value;
    return values.empty() ? 0.0 : sum / static_cast<double>(values.size());
}

/// The particles shrink; their bonds, thin ones included.
Bonds shrink(State& state, const std::vector<Pair>& pairs, const std::vector<Overlap>& overlaps, const Options& options,
             Summary& summary, const Watch& watch) {
    Particles& particles = state.particles;
    ShrunkSpheres shrunk = options.method == Method::exact
                               ? shrink_exactly(particles.radius, overlaps, options.sharing, watch)
                               : shrink_by_sweeps(particles.radius, overlaps, options.sharing, options.decrement, watch);
    summary.stopped = shrunk.stopped;
    const long double before = solid_volume(particles.radius, {});
    const long double after = solid_volume(shrunk.radius, shrunk.volume);
    if (before > 0.0L) summary.volume_error = static_cast<double>(after / before - 1.0L);

    Bonds bonds = make_bonds(pairs, overlaps, shrunk, options, summary);
    particles.radius = std::move(shrunk.radius);
    return bonds;
}

/// The necks between particles that stay as they are, thin ones included.
Bonds keep(const State& state, const physics::RecordedContacts& contacts, const std::vector<Overlap>& overlaps,
           const Options& options, Summary& summary, const Watch& watch) {
    const std::vector<double>& radius = state.particles.radius;
    NeckSizes sizes = neck_sizes(state, contacts, options.necks, watch);
    const double box = state.box.volume();
    summary.neck_factor = sizes.factor;
    summary.limited = sizes.limited;
    summary.solid_fraction = particle_volume(state.particles) / box;
    summary.union_fraction = sizes.union_volume / box;
    summary.union_error = sizes.union_error / box;
    summary.fills = sizes.fills;
    Bonds bonds;
    for (std::size_t bond = 0; bond < overlaps.size(); ++bond) {
        const auto [first, second, distance] = overlaps[bond];
        bonds.pair.push_back({first, second});
        bonds.image.push_back(contacts.pairs[bond].image);
        bonds.length.push_back(physics::neck_length(distance, radius[static_cast<std::size_t>(first)],
                                                    radius[static_cast<std::size_t>(second)], sizes.radius[bond]));
    }
    bonds.radius = std::move(sizes.radius);
    bonds.volume.assign(overlaps.size(), 0.0);
    return bonds;
}

}  // namespace

Summary bondify(State& state, const Options& options, const Watch& watch) {
    const Particles& particles = state.particles;
    const bool necks = options.method == Method::necks;
    physics::RecordedContacts contacts;
    if (necks)
        contacts = physics::recorded_contacts(state);
    else
        contacts.pairs = find_pairs(state.box, particles.position, particles.radius);
    const std::vector<Overlap> overlaps = overlaps_of(state, contacts.pairs);
    Summary summary{.pairs = overlaps.size()};
    Bonds bonds = necks ? keep(state, contacts, overlaps, options, summary, watch)
                        : shrink(state, contacts.pairs, overlaps, options, summary, watch);
    treat_thin(bonds, particles.radius, options, summary);
    summary.bonds = bonds.size();
    summary.mean_diameter = 2.0 * mean(bonds.radius);
    summary.mean_length = mean(bonds.length);
    if (particles.size() > 0)
        summary.coordination_number = 2.0 * static_cast<double>(bonds.size()) / static_cast<double>(particles.size());
    state.bonds = std::move(bonds);
    state.necks.reset();
    return summary;
}

}  // namespace kiln::bonding
