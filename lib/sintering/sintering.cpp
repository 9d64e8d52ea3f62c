// sintering.cpp: checkpoints, the same for every method.
#include "sintering/sintering.h"

namespace kiln::sintering {

namespace {

const std::vector<double>& list_at(const Numbers& numbers, const std::string& name, std::size_t length) {
    const auto found = numbers.find(name);
    if (found == numbers.end() || found->second.size() != length)
        throw Error("the checkpoint has no " + name + " of " + std::to_string(length) + (length == 1 ? " number" : " numbers"));
    return found->second;
}

}  // namespace

std::vector<double> column_of(const std::vector<NamedArray>& arrays, const std::string& name, std::size_t rows) {
    for (const NamedArray& named : arrays)
        if (const auto* values = std::get_if<std::vector<double>>(&named.array.data);
            named.name == name && values && named.array.shape == std::vector<std::size_t>{rows, 3})
            return *values;
    throw Error("the checkpoint has no array " + name + " of " + std::to_string(rows) + " rows");
}

SinteringMethod::SinteringMethod(State state, const SinteringSettings& settings)
    : settings_(settings), body_(std::move(state), settings.faces), kinetics_(body_.working(), settings.schedule) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (settings_.fixed[axis] && !body_.box().periodic[axis])
            throw Error(std::string("the box has no faces to hold along ") + "xyz"[axis] + ", which is not periodic");
        if (settings_.confined[axis] && !body_.box().periodic[axis])
            throw Error(std::string("the box has no faces for a die along ") + "xyz"[axis] + ", which is not periodic");
        if (settings_.confined[axis] && settings_.fixed[axis])
            throw Error(std::string("the box is either fixed or confined along ") + "xyz"[axis] + ", not both");
        const bool held = settings_.fixed[axis] || settings_.confined[axis];
        if (settings_.pressure[static_cast<Eigen::Index>(axis)] != 0.0 && (held || !body_.box().periodic[axis]))
            throw Error("a pressure along an axis that is fixed, confined or not periodic moves nothing");
    }
}

double number_at(const Numbers& numbers, const std::string& name) { return list_at(numbers, name, 1).front(); }

Vec3 triple_at(const Numbers& numbers, const std::string& name) {
    return Eigen::Map<const Vec3>(list_at(numbers, name, 3).data());
}

Checkpoint SinteringMethod::checkpoint() const {
    Checkpoint checkpoint{body_.checkpoint(), numbers()};
    for (NamedArray& array : arrays()) checkpoint.state.particles.other.push_back(std::move(array));
    checkpoint.numbers["steps"] = {static_cast<double>(steps_)};
    checkpoint.numbers["strain"] = triple(body_.strain());
    return checkpoint;
}

void SinteringMethod::restore(const Checkpoint& checkpoint) {
    const State& state = checkpoint.state;
    if (state.particles.size() > body_.size() || (state.particles.size() < body_.size() && !settings_.coarsening.exchanges()))
        throw Error("the checkpoint has " + std::to_string(state.particles.size()) + " particles, the state has " +
                    std::to_string(body_.size()));
    body_.restore(state, triple_at(checkpoint.numbers, "strain"));
    steps_ = static_cast<std::size_t>(number_at(checkpoint.numbers, "steps"));
    take_up(checkpoint.numbers, state.particles.other);
}

}  // namespace kiln::sintering
