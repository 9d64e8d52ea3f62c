// kinetics.cpp: tables over pairs of materials, and equivalent time and its inverse.
#include "sintering/kinetics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "physics/diffusion.h"
#include "physics/materials.h"
#include "physics/neck.h"

namespace kiln::sintering {

namespace {

constexpr double same = 1e-15;  // relative, of equivalent times
constexpr int max_halvings = 200;
constexpr double warm = 3000.0;  // K, at which everything that diffuses at all does so visibly

}  // namespace

Kinetics::Kinetics(const State& state, const physics::Schedule& schedule)
    : schedule_(schedule), materials_(state.materials.size()), material_(state.materials) {
    const std::size_t rows = materials_ * materials_;
    given_.resize(rows);
    for (const Material& a : material_)
        for (const Material& b : material_) {
            energy_.push_back(physics::mixed_surface_energy(physics::required(a.surface_energy, a, "surface_energy"),
                                                            physics::required(b.surface_energy, b, "surface_energy")));
            neck_limit_.push_back(std::min(physics::neck_limit(a), physics::neck_limit(b)));
        }
    for (const MaterialPair& pair : state.contacts)
        for (const auto& [a, b] :
             {std::pair(pair.materials[0], pair.materials[1]), std::pair(pair.materials[1], pair.materials[0])}) {
            if (pair.diffusion_parameter) given_[row(a, b)] = *pair.diffusion_parameter;
            if (pair.surface_energy) energy_[row(a, b)] = *pair.surface_energy;
        }
    if (std::isfinite(schedule_.end())) times_ = schedule_.panels(schedule_.begin(), schedule_.end());
    find_rigid(state.particles);
}

void Kinetics::find_rigid(const Particles& particles) {
    std::vector<bool> used(materials_, false);
    for (const std::int32_t material : particles.material) used[static_cast<std::size_t>(material)] = true;
    for (std::size_t pair = 0; pair < energy_.size(); ++pair)
        present_.push_back(used[pair / materials_] && used[pair % materials_]);
    std::vector<double> all(energy_.size(), 0.0);  // what each pair diffuses over the schedule
    bool any = false;
    for (std::size_t pair = 0; pair < all.size(); ++pair) {
        if (!present_[pair]) continue;
        all[pair] = times_.size() < 2 ? diffusion(pair, schedule_.highest())
                                      : schedule_.integral(times_.front(), times_.back(),
                                                           [&](double temperature) { return diffusion(pair, temperature); });
        any = any || diffuses(pair);
    }
    if (!any) throw Error("no pair of materials diffuses, so nothing can sinter");
    fastest_row_ = static_cast<std::size_t>(std::ranges::max_element(all) - all.begin());
    fastest_ = diffusion(fastest_row_, schedule_.highest());
    for (std::size_t pair = 0; pair < all.size(); ++pair) {
        const std::size_t a = pair / materials_, b = pair % materials_;
        rigid_.push_back(!diffuses(pair) || all[pair] < rigid_fraction * all[fastest_row_]);
        if (!present_[pair]) continue;
        any_rigid_ = any_rigid_ || rigid_.back();
        if (rigid_.back() && diffuses(pair) && a <= b)
            taken_as_rigid_.push_back({material_[a].name, material_[b].name, all[pair] / all[fastest_row_]});
    }
}

bool Kinetics::diffuses(std::size_t pair) const {
    if (given_[pair]) return *given_[pair] > 0.0;
    const auto moves = [](const Material& material) {  // at some temperature, even where the number for a cold one underflows
        return material.diffusion_parameter ? *material.diffusion_parameter > 0.0
                                            : physics::diffusion_parameter_of(material, warm) > 0.0;
    };
    return moves(material_[pair / materials_]) && moves(material_[pair % materials_]);
}

double Kinetics::diffusion(std::size_t pair, double temperature) const {
    if (given_[pair]) return *given_[pair];
    return physics::mixed_diffusion_parameter(physics::diffusion_parameter_of(material_[pair / materials_], temperature),
                                              physics::diffusion_parameter_of(material_[pair % materials_], temperature));
}

std::vector<double> Kinetics::diffusion_at(double temperature) const {
    std::vector<double> table;
    for (std::size_t pair = 0; pair < energy_.size(); ++pair)
        table.push_back(present_[pair] ? diffusion(pair, temperature) : 0.0);
    return table;
}

std::vector<double> Kinetics::slowness_at(double temperature) const {
    std::vector<double> table = diffusion_at(temperature);
    const double fastest = *std::ranges::max_element(table);
    for (double& value : table) value = value == fastest ? 1.0 : fastest / value;
    return table;
}

std::vector<double> Kinetics::diffusion_over(double from, double until) const {
    std::vector<double> table;
    for (std::size_t pair = 0; pair < energy_.size(); ++pair)
        table.push_back(present_[pair]
                            ? schedule_.integral(from, until, [&](double temperature) { return diffusion(pair, temperature); })
                            : 0.0);
    const double least = rigid_fraction * *std::ranges::max_element(table);
    for (std::size_t pair = 0; pair < table.size(); ++pair)
        if (present_[pair] && !rigid_[pair]) table[pair] = std::max(table[pair], least);
    return table;
}

double Kinetics::equivalent(double from, double until) const {
    if (!(fastest_ > 0.0)) return 0.0;  // so cold that the number for it underflows
    if (std::isinf(until)) return until;
    return schedule_.integral(from, until, [&](double temperature) { return diffusion(fastest_row_, temperature) / fastest_; });
}

double Kinetics::after(double from, double required) const {
    if (times_.empty()) return from + required;
    double low = from, left = required;  // what is left of the required equivalent time at `low`
    for (auto next = std::upper_bound(times_.begin(), times_.end(), from); next != times_.end(); ++next) {
        const double passes = equivalent(low, *next);
        if (passes < left) {
            left -= passes;
            low = *next;
            continue;
        }
        double high = *next;  // the time lies between: Newton, kept inside the bracket
        const double begin = low;
        double time = begin + left / passes * (high - begin);
        for (int halving = 0; halving < max_halvings && high > low; ++halving) {
            const double miss = equivalent(begin, time) - left;
            if (std::abs(miss) <= same * left) break;
            (miss > 0.0 ? high : low) = time;
            const double better = time - miss * fastest_ / diffusion(fastest_row_, schedule_.temperature(time));
            const double before = time;
            time = better > low && better < high ? better : 0.5 * (low + high);
            if (time == before) break;
        }
        return time;
    }
    const double rate = diffusion(fastest_row_, schedule_.temperature(low)) / fastest_;  // the last temperature stays
    return rate > 0.0 ? low + left / rate : std::numeric_limits<double>::infinity();
}

}  // namespace kiln::sintering
