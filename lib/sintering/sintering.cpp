// sintering.cpp: checkpoints, the same for every method.
#include "sintering/sintering.h"

namespace kiln::sintering {

namespace {

constexpr const char* key = "sintering";  // of the numbers in a checkpoint

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
    for (std::size_t axis = 0; axis < 3; ++axis)
        if (settings_.pressure[static_cast<Eigen::Index>(axis)] != 0.0 && (settings_.fixed[axis] || !body_.box().periodic[axis]))
            throw Error("a pressure along an axis that is fixed or not periodic moves nothing");
}

State SinteringMethod::checkpoint() const {
    State state = body_.working();
    for (NamedArray& array : arrays()) state.particles.other.push_back(std::move(array));
    Json own = numbers();
    own["steps"] = steps_;
    own["strain"] = triple(body_.strain());
    state.other[key] = std::move(own);
    return state;
}

void SinteringMethod::restore(const State& checkpoint) {
    if (checkpoint.particles.size() != body_.size())
        throw Error("the checkpoint has " + std::to_string(checkpoint.particles.size()) + " particles, the state has " +
                    std::to_string(body_.size()));
    const Json own = checkpoint.other.value(key, Json());
    if (!own.is_object()) throw Error("the checkpoint has no " + std::string(key));
    try {
        body_.restore(checkpoint.box, checkpoint.particles.position, checkpoint.time, checkpoint.temperature.value_or(0.0),
                         triple_from(own.at("strain")));
        steps_ = own.at("steps");
        take_up(own, checkpoint.particles.other);
    } catch (const Json::exception& error) {
        throw Error("the checkpoint lacks a number: " + std::string(error.what()));
    }
}

}  // namespace kiln::sintering
