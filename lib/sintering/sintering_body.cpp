// sintering_body.cpp: memory order, the list of pairs with its margin, and the body's extent along free faces.
#include "sintering/sintering_body.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <numeric>
#include <unordered_map>
#include <utility>

#include "core/parallel.h"
#include "core/spatial_order.h"
#include "physics/sinter_contact.h"

namespace kiln::sintering {

namespace {

constexpr double list_margin = 0.15;    // of the mean radius, that a particle may travel before pairs are listed anew
constexpr double margin_ahead = 2.0;    // of the travel of a fast particle, that the margin leaves
constexpr std::size_t few = 100;        // of so many particles one may need a new list and the others keep theirs
constexpr double min_reach = 0.04;      // of the mean radius, that candidates for touch may be apart
constexpr double coincident = 1e-9;   // of the radii, distance of centres that has no direction
constexpr const char* offset_name = "offset";  // array of necks in a checkpoint

/// Box lengths from a position to the same one moved by whole boxes.
Image cells_between(const Box& box, const Vec3& from, const Vec3& to) {
    Image cells;
    for (int axis = 0; axis < 3; ++axis) {
        const double lengths = std::round((to[axis] - from[axis]) / box.lengths[axis]);
        if (std::abs(lengths) > 127.0) throw Error("a particle with a neck is more than 127 boxes outside the box");
        cells[static_cast<std::size_t>(axis)] = static_cast<std::int8_t>(lengths);
    }
    return cells;
}

/// A pair of rows whose positions are moved by so many boxes each, in the order of find_pairs.
Pair moved(std::int32_t i, std::int32_t j, const Image& image, const Image& cells_i, const Image& cells_j) {
    Pair pair{i, j, {}};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const int boxes = image[axis] + cells_i[axis] - cells_j[axis];
        pair.image[axis] = static_cast<std::int8_t>(boxes);
        if (pair.image[axis] != boxes) throw Error("a neck reaches over " + std::to_string(boxes) + " boxes");
    }
    if (pair.i > pair.j || (pair.i == pair.j && pair.image < Image{0, 0, 0})) {
        std::swap(pair.i, pair.j);
        for (std::int8_t& boxes : pair.image) boxes = static_cast<std::int8_t>(-boxes);
    }
    return pair;
}

/// Sorts pairs with a number each.
void sort_together(std::vector<Pair>& pairs, std::vector<double>& values) {
    std::vector<std::size_t> order(pairs.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::sort(order, [&](std::size_t a, std::size_t b) { return pairs[a] < pairs[b]; });
    std::vector<Pair> sorted_pairs;
    std::vector<double> sorted_values;
    for (const std::size_t row : order) {
        sorted_pairs.push_back(pairs[row]);
        sorted_values.push_back(values[row]);
    }
    pairs = std::move(sorted_pairs);
    values = std::move(sorted_values);
}

double neck_of(double overlap, double reduced) { return std::sqrt(physics::contact_radius_squared(overlap, reduced)); }

template <typename Value>
void keep_only(std::vector<Value>& values, const std::vector<std::int32_t>& rows) {
    for (std::size_t row = 0; row < rows.size(); ++row) values[row] = values[static_cast<std::size_t>(rows[row])];
    values.resize(rows.size());
}

}  // namespace

SinteringBody::SinteringBody(State state, Faces faces) : state_(std::move(state)) {
    Particles& particles = state_.particles;
    if (particles.size() == 0) throw Error("the state has no particles");
    if (state_.bonds && state_.bonds->size() > 0) throw Error("the state has bonds; sintering takes a packing without them");
    state_.bonds.reset();
    std::vector<Image> cells;  // that each particle moves by
    for (Vec3& position : particles.position) {
        const Vec3 inside = state_.box.wrap(position);
        if (state_.necks) cells.push_back(cells_between(state_.box, position, inside));
        position = inside;
    }
    if (faces != Faces::as_given) state_.box.periodic.fill(faces == Faces::periodic);
    max_radius_ = *std::max_element(particles.radius.begin(), particles.radius.end());
    solid_ = particle_volume(particles);
    mean_radius_ = std::cbrt(solid_ / static_cast<double>(particles.size()) * 0.75 / std::numbers::pi);
    order_ = spatial_order(state_.box, particles.position, 2.0 * max_radius_);
    particles = take_rows(particles, order_);
    first_radius_ = particles.radius;
    density_ = solid_ / state_.box.volume();
    if (state_.necks) take_necks(*std::exchange(state_.necks, std::nullopt), cells);
    list_pairs(list_margin * mean_radius_);
}

/// cells: what each particle of the input moved by into the box.
void SinteringBody::take_necks(const Necks& necks, std::span<const Image> cells) {
    std::vector<std::int32_t> present(size());
    for (std::size_t row = 0; row < size(); ++row) present[static_cast<std::size_t>(order_[row])] = static_cast<std::int32_t>(row);
    for (std::size_t row = 0; row < necks.size(); ++row) {
        const auto i = static_cast<std::size_t>(necks.pair[row][0]), j = static_cast<std::size_t>(necks.pair[row][1]);
        const Pair pair = moved(present[i], present[j], necks.image[row], cells[i], cells[j]);
        bool cut = false;  // by a face that is not periodic any more
        for (std::size_t axis = 0; axis < 3; ++axis) cut = cut || (pair.image[axis] != 0 && !state_.box.periodic[axis]);
        if (cut) continue;
        const auto [first, second] = radii(pair);
        const double overlap = physics::overlap_of_neck(necks.radius[row], physics::reduced_radius(first, second));
        record_.push_back(pair);
        record_offset_.push_back(overlap - (first + second - vector(pair).norm()));
    }
    sort_together(record_, record_offset_);
}

void SinteringBody::list_pairs(double margin) {
    margin_.assign(size(), margin);
    find_pairs();
}

std::vector<double> SinteringBody::reaches() const {
    std::vector<double> reach = state_.particles.radius;
    for (std::size_t row = 0; row < size(); ++row) reach[row] += std::max(margin_[row], 0.0);
    return reach;
}

void SinteringBody::find_pairs() {
    pairs_ = kiln::find_pairs(state_.box, state_.particles.position, reaches());
    listed_radius_ = state_.particles.radius;
    took_list();
}

/// Lists the pairs of a few particles anew: the others' margins and pairs among themselves hold on.
void SinteringBody::find_pairs_of(const std::vector<std::int32_t>& few) {
    const std::vector<Pair> of_few = kiln::find_pairs(state_.box, state_.particles.position, reaches(), few);
    std::vector<std::uint8_t> listed(size(), 0);
    for (const std::int32_t row : few) {
        listed[static_cast<std::size_t>(row)] = 1;
        listed_radius_[static_cast<std::size_t>(row)] = state_.particles.radius[static_cast<std::size_t>(row)];
    }
    std::erase_if(pairs_, [&](const Pair& pair) {
        return listed[static_cast<std::size_t>(pair.i)] != 0 || listed[static_cast<std::size_t>(pair.j)] != 0;
    });
    const auto others = static_cast<std::ptrdiff_t>(pairs_.size());
    pairs_.insert(pairs_.end(), of_few.begin(), of_few.end());
    std::inplace_merge(pairs_.begin(), pairs_.begin() + others, pairs_.end());
    took_list();
}

void SinteringBody::took_list() {
    const Particles& particles = state_.particles;
    list_record();
    min_margin_ = *std::min_element(margin_.begin(), margin_.end());
    ++lists_;
    for (const Pair& pair : pairs_) {
        const auto [first, second] = radii(pair);
        if (vector(pair).norm() < coincident * (first + second))
            throw Error("the centres of particles " + std::to_string(particles.id[static_cast<std::size_t>(pair.i)]) + " and " +
                        std::to_string(particles.id[static_cast<std::size_t>(pair.j)]) + " coincide");
    }
}

/// Brings list and record together: pairs without a grain leave the list, those of the record are in it wherever they are.
void SinteringBody::list_record() {
    if (grains_change_)
        std::erase_if(pairs_, [&](const Pair& pair) {
            const auto [first, second] = radii(pair);
            return first == 0.0 || second == 0.0;
        });
    offset_.clear();
    if (record_.empty()) return;
    std::vector<Pair> all;
    all.reserve(pairs_.size());
    std::ranges::set_union(pairs_, record_, std::back_inserter(all));
    pairs_ = std::move(all);
    offset_.assign(pairs_.size(), 0.0);
    std::size_t row = 0;
    for (std::size_t neck = 0; neck < record_.size(); ++neck) {
        while (pairs_[row] < record_[neck]) ++row;
        offset_[row] = record_offset_[neck];
    }
    first_pair_.assign(size() + 1, 0);
    for (const Pair& pair : pairs_) ++first_pair_[static_cast<std::size_t>(pair.i) + 1];
    std::partial_sum(first_pair_.begin(), first_pair_.end(), first_pair_.begin());
}

double SinteringBody::offset(const Pair& pair) const {
    if (offset_.empty()) return 0.0;
    const auto i = static_cast<std::size_t>(pair.i);
    for (std::size_t row = first_pair_[i]; row < first_pair_[i + 1]; ++row)
        if (pairs_[row].j == pair.j && pairs_[row].image == pair.image) return offset_[row];
    return 0.0;
}

void SinteringBody::set_grains(const Grains& grains) {
    std::vector<double>& radius = state_.particles.radius;
    grains_change_ = true;
    bool listed = true;  // all pairs that may come to touch
    for (std::size_t row = 0; row < size(); ++row) {
        listed = listed && (radius[row] > 0.0 || grains.radius[row] == 0.0);
        radius[row] = grains.radius[row];
        listed = listed && growth(row) <= margin_[row];
    }
    max_radius_ = *std::ranges::max_element(radius);
    record_ = grains.pair;
    record_offset_ = grains.offset;
    if (listed)
        list_record();
    else
        list_pairs(list_margin * mean_radius_);
}

/// Sums over the particles, where they have changed: solid, mean and largest radius.
void SinteringBody::measure() {
    const std::vector<double>& radius = state_.particles.radius;
    if (radius == first_radius_) return;
    max_radius_ = *std::ranges::max_element(radius);
    solid_ = particle_volume(state_.particles);
    mean_radius_ = std::cbrt(solid_ / static_cast<double>(size()) * 0.75 / std::numbers::pi);
    density_ = solid_ / state_.box.volume();
}

/// Keeps these rows of all that has a row a particle, and the pairs between them.
void SinteringBody::keep_rows(const std::vector<std::int32_t>& rows) {
    std::vector<std::int32_t> now(size(), -1);  // row of each particle
    for (std::size_t row = 0; row < rows.size(); ++row) now[static_cast<std::size_t>(rows[row])] = static_cast<std::int32_t>(row);
    state_.particles = take_rows(state_.particles, rows);
    keep_only(order_, rows);
    keep_only(margin_, rows);
    keep_only(first_radius_, rows);
    keep_only(listed_radius_, rows);
    const auto renumber = [&](std::vector<Pair>& pairs) {
        for (Pair& pair : pairs) pair = {now[static_cast<std::size_t>(pair.i)], now[static_cast<std::size_t>(pair.j)], pair.image};
    };
    renumber(pairs_);
    renumber(record_);
    list_record();
    ++lists_;
}

std::vector<std::int32_t> SinteringBody::remove_vanished() {
    std::vector<std::int32_t> rows;
    for (std::size_t row = 0; row < size(); ++row)
        if (state_.particles.radius[row] > 0.0) rows.push_back(static_cast<std::int32_t>(row));
    if (rows.size() < size()) keep_rows(rows);
    measure();
    return rows;
}

/// Bound of what a particle's motion takes off the gaps to particles beyond its margin, m: they close by no more than both travel.
double SinteringBody::travel(std::size_t row, const Motion& motion) const {
    return Eigen::Map<const Vec3>(&motion.displacement[3 * row]).norm() +
           motion.strain.cwiseAbs().maxCoeff() * (state_.particles.radius[row] + margin_[row]);
}

double SinteringBody::candidate_reach(const Motion& motion) const {
    return min_reach * mean_radius_ + 2.0 * mean_radius_ * motion.strain.cwiseAbs().maxCoeff();
}

void SinteringBody::cover(const Motion& motion, double factor) {
    // Candidates are chosen by twice the motion that is guessed and a distance to spare: where growing grains use up margins, all
    // of those are to be in the list, so that a run does not depend on when it was made.
    const double spare = grains_change_ ? 0.5 * candidate_reach(motion) : 0.0;  // for each of a pair
    if (grains_change_) factor = std::max(factor, candidate_motion);
    std::vector<std::uint8_t> beyond(size());
    for_rows(size(), [&](std::size_t row) {
        beyond[row] = factor * travel(row, motion) + growth(row) + spare > margin_[row];
    });
    const auto count = static_cast<std::size_t>(std::count(beyond.begin(), beyond.end(), 1));
    if (count == 0) return;
    const bool all = count > size() / few;
    std::vector<std::int32_t> rows;
    for (std::size_t row = 0; row < size(); ++row) {
        if (!all && beyond[row] == 0) continue;
        margin_[row] = std::clamp(margin_ahead * factor * travel(row, motion), list_margin * mean_radius_, mean_radius_);
        rows.push_back(static_cast<std::int32_t>(row));
    }
    all ? find_pairs() : find_pairs_of(rows);
}

double SinteringBody::approach_bound(const Motion& motion) const {
    const double largest = greatest_of_rows(
        size(), 0.0, [&](std::size_t row) { return Eigen::Map<const Vec3>(&motion.displacement[3 * row]).norm(); });
    return 2.0 * largest + motion.strain.cwiseAbs().maxCoeff() * 2.0 * max_radius_;
}

Vec3 SinteringBody::body_stretch(const Motion& motion) const {
    const Particles& particles = state_.particles;
    const auto& periodic = state_.box.periodic;
    Vec3 stretch = Vec3::Ones();
    if (periodic[0] && periodic[1] && periodic[2]) return stretch;
    double mass = 0.0;
    Vec3 sum = Vec3::Zero(), square = Vec3::Zero(), sum_after = Vec3::Zero(), square_after = Vec3::Zero();
    for (std::size_t row = 0; row < size(); ++row) {  // about the first particle, so that squares keep their digits
        const double m = particles.radius[row] * particles.radius[row] * particles.radius[row];
        const Vec3 before = particles.position[row] - particles.position[0];
        const Vec3 after = before + Eigen::Map<const Vec3>(&motion.displacement[3 * row]);
        mass += m;
        sum += m * before;
        square += m * before.cwiseProduct(before);
        sum_after += m * after;
        square_after += m * after.cwiseProduct(after);
    }
    const Vec3 spread = square / mass - (sum / mass).cwiseAbs2(),
               spread_after = square_after / mass - (sum_after / mass).cwiseAbs2();
    const double least = 1e-12 * max_radius_ * max_radius_;  // a body of one layer does not shrink across it
    for (int axis = 0; axis < 3; ++axis)
        if (!periodic[static_cast<std::size_t>(axis)] && spread[axis] > least)
            stretch[axis] = std::sqrt(spread_after[axis] / spread[axis]);
    return stretch;
}

double SinteringBody::log_density_change(const Motion& motion) const {
    return -std::log1p(motion.strain[0]) - std::log1p(motion.strain[1]) - std::log1p(motion.strain[2]) -
           body_stretch(motion).array().log().sum();
}

void SinteringBody::apply(const Motion& motion, double until, double temperature) {
    Box& box = state_.box;
    const Vec3 body = body_stretch(motion);
    const Vec3 stretch = Vec3::Ones() + motion.strain;
    for_rows(size(), [&](std::size_t row) {
        margin_[row] -= travel(row, motion);
        Vec3& position = state_.particles.position[row];
        position = box.origin + stretch.cwiseProduct(position - box.origin) + Eigen::Map<const Vec3>(&motion.displacement[3 * row]);
    });
    const Vec3 middle = box.origin + 0.5 * box.lengths, both = stretch.cwiseProduct(body);
    for (int axis = 0; axis < 3; ++axis)  // a free body's box shrinks towards its middle, a periodic one towards its origin
        if (!box.periodic[static_cast<std::size_t>(axis)]) box.origin[axis] = middle[axis] - 0.5 * body[axis] * box.lengths[axis];
    box.lengths = box.lengths.cwiseProduct(both);
    strain_ += both.array().log().matrix();
    state_.time = until;
    state_.temperature = temperature;
    density_ = solid_ / state_.box.volume();
    min_margin_ = margin_.empty() ? std::numeric_limits<double>::infinity() : *std::min_element(margin_.begin(), margin_.end());
    end_contacts();
}

/// A contact that was pulled apart is no more than two spheres. One whose grains have grown more than their neck keeps that: its
/// spheres overlap before it touches again.
void SinteringBody::end_contacts() {
    if (record_.empty()) return;
    std::vector<std::int32_t> lasting;  // rows of the record
    for (std::size_t neck = 0; neck < record_.size(); ++neck)
        if (record_offset_[neck] <= 0.0 || overlap(record_[neck]) >= 0.0) lasting.push_back(static_cast<std::int32_t>(neck));
    if (lasting.size() == record_.size()) return;
    keep_only(record_, lasting);
    keep_only(record_offset_, lasting);
    list_record();
}

/// Necks with a history, each particle having moved by so many boxes into its place; present: the row in the result of each row.
Necks SinteringBody::necks(std::span<const std::int32_t> present, std::span<const Image> cells) const {
    std::vector<Pair> pairs;
    std::vector<double> radius;
    for (const Pair& pair : record_) {
        const auto i = static_cast<std::size_t>(pair.i), j = static_cast<std::size_t>(pair.j);
        const auto [first, second] = radii(pair);
        pairs.push_back(moved(present[i], present[j], pair.image, cells[i], cells[j]));
        radius.push_back(neck_of(overlap(pair), physics::reduced_radius(first, second)));
    }
    sort_together(pairs, radius);
    Necks necks;
    for (const Pair& pair : pairs) {
        necks.pair.push_back({pair.i, pair.j});
        necks.image.push_back(pair.image);
    }
    necks.radius = std::move(radius);
    return necks;
}

State SinteringBody::state() const {
    State result = state_;
    std::vector<std::int32_t> back(order_.size()), present(order_.size());
    std::iota(back.begin(), back.end(), 0);
    std::ranges::sort(back, {}, [&](std::int32_t row) { return order_[static_cast<std::size_t>(row)]; });
    for (std::size_t row = 0; row < back.size(); ++row)
        present[static_cast<std::size_t>(back[row])] = static_cast<std::int32_t>(row);
    result.particles = take_rows(state_.particles, back);
    for (Vec3& position : result.particles.position) position = result.box.wrap(position);
    if (record_.empty()) return result;
    std::vector<Image> cells;
    for (std::size_t row = 0; row < size(); ++row)
        cells.push_back(cells_between(state_.box, state_.particles.position[row],
                                      result.particles.position[static_cast<std::size_t>(present[row])]));
    result.necks = necks(present, cells);
    return result;
}

State SinteringBody::checkpoint() const {
    State result = state_;
    if (record_.empty()) return result;
    std::vector<std::int32_t> present(size());
    std::iota(present.begin(), present.end(), 0);
    result.necks = necks(present, std::vector<Image>(size(), Image{0, 0, 0}));
    result.necks->other.push_back({offset_name, {{record_.size()}, record_offset_}});
    return result;
}

void SinteringBody::restore(const State& checkpoint, const Vec3& strain) {
    const Particles& earlier = checkpoint.particles;
    std::unordered_map<std::int64_t, std::int32_t> row_of;
    for (std::size_t row = 0; row < size(); ++row) row_of[state_.particles.id[row]] = static_cast<std::int32_t>(row);
    std::vector<std::int32_t> rows;
    for (const std::int64_t id : earlier.id) {
        const auto found = row_of.find(id);
        if (found == row_of.end()) throw Error("the checkpoint has a particle " + std::to_string(id) + ", the state has none");
        rows.push_back(found->second);
    }
    record_.clear();
    record_offset_.clear();
    pairs_.clear();
    keep_rows(rows);
    state_.box = checkpoint.box;
    state_.particles.position = earlier.position;
    state_.time = checkpoint.time;
    state_.temperature = checkpoint.temperature.value_or(0.0);
    strain_ = strain;
    density_ = solid_ / state_.box.volume();
    state_.particles.radius = earlier.radius;
    measure();
    if (checkpoint.necks) {
        for (std::size_t row = 0; row < checkpoint.necks->size(); ++row)
            record_.push_back({checkpoint.necks->pair[row][0], checkpoint.necks->pair[row][1], checkpoint.necks->image[row]});
        for (const NamedArray& named : checkpoint.necks->other)
            if (const auto* offset = std::get_if<std::vector<double>>(&named.array.data); offset && named.name == offset_name)
                record_offset_ = *offset;
        if (record_offset_.size() != record_.size()) throw Error("the checkpoint has no offset of its necks");
    }
    list_pairs(list_margin * mean_radius_);
}

}  // namespace kiln::sintering
