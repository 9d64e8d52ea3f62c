// size_table.cpp: which columns of a table hold diameters and shares, what they count, and what is not clear enough to be used.
#include "packing/size_table.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdio>
#include <iterator>
#include <numeric>
#include <string_view>
#include <utility>

#include "core/types.h"
#include "io/csv.h"
#include "io/text_encoding.h"

namespace kiln::packing {

namespace {

using io::CsvTable, io::Dimension;

constexpr double tail = 1e-3;       // share beyond the ends of a cumulative curve that is rounding of an export
constexpr double sum_error = 1e-2;  // by which the shares of many classes, each rounded, may miss 100 %

constexpr std::array volume_words{"volume", "vol", "q3", "mass", "weight", "wt", "masse", "gewicht"};
constexpr std::array number_words{"number", "count", "counts", "frequency", "q0", "anzahl"};
constexpr std::array count_words{"count", "counts", "frequency", "anzahl"};
constexpr std::array undersize_words{"cum", "cumulative", "undersize", "passing", "pass", "finer", "less", "smaller", "<",
                                     "durchgang", "summe", "kumuliert"};
constexpr std::array oversize_words{"oversize", "coarser", "larger", ">", "residue"};
constexpr std::array size_words{"size",  "sizes",   "diameter",    "diameters", "d",   "channel",
                                "class", "classes", "durchmesser", "sieve",     "mesh"};
constexpr std::array lower_words{"lower", "low", "from", "untere", "von"};
constexpr std::array upper_words{"upper", "high", "to", "obere", "bis"};

/// Letters and digits of a heading in groups: "cum. < vol%" is cum, <, vol.
std::vector<std::string> words_of(const std::string& name) {
    std::vector<std::string> words(1);
    for (const char letter : name) {
        const bool sign = letter == '<' || letter == '>';
        const bool part = std::isalnum(static_cast<unsigned char>(letter)) != 0 || static_cast<unsigned char>(letter) >= 0x80;
        if (sign) words.emplace_back();
        if (part || sign) words.back() += letter;
        if (!part) words.emplace_back();
    }
    return words;
}

template <std::size_t count>
bool has_word(const CsvTable& table, std::size_t column, const std::array<const char*, count>& list) {
    const std::vector<std::string> words = words_of(table.name(column));
    return std::ranges::any_of(words, [&](const std::string& word) { return std::ranges::find(list, word) != list.end(); });
}

bool is_length(const CsvTable& table, std::size_t column) {
    return !table.unit(column).empty() && io::scale_of(table.unit(column), Dimension::length).has_value();
}

bool is_percent(const CsvTable& table, std::size_t column) {
    return !table.unit(column).empty() && io::scale_of(table.unit(column), Dimension::fraction).has_value();
}

std::string quoted(const CsvTable& table, const std::vector<std::size_t>& columns) {
    std::string list;
    for (const std::size_t column : columns) list += (list.empty() ? "" : ", ") + io::excerpt(table.heading(column));
    return list;
}

/// "D10", "Dx (50)", "d(0.9)", "Dv10": 10, 50 or 90, and whether it counts particles; nothing for another heading.
std::optional<std::pair<int, bool>> percentile_in(const std::string& name) {
    std::string letters, number;
    for (const char letter : name) {
        if (std::isdigit(static_cast<unsigned char>(letter))) number += letter;
        if (std::isalpha(static_cast<unsigned char>(letter))) (number.empty() ? letters : number) += letter;
    }
    constexpr std::array<std::string_view, 5> known{"d", "dx", "dv", "dn", "x"};
    if (std::ranges::find(known, letters) == known.end()) return std::nullopt;
    for (const auto& [percent, texts] : {std::pair(10, std::pair("10", "01")), {50, {"50", "05"}}, {90, {"90", "09"}}})
        if (number == texts.first || number == texts.second) return std::pair(percent, letters == "dn");
    return std::nullopt;
}

class SizeTable {
   public:
    SizeTable(const CsvTable& table, std::string file, std::optional<Weighting> weighting, std::optional<Shares> shares,
              const FileManner& manner)
        : table_(table), file_(std::move(file)), weighting_(weighting), shares_(shares), manner_(manner) {}

    SizeDistribution read() {
        SizeDistribution found = distribution();
        if (!manner_.unit.empty() && !unit_used_) refuse("all sizes have units, and --length-unit gives one more");
        return found;
    }

   private:
    SizeDistribution distribution() {
        if (auto percentiles = three_percentiles()) return std::move(*percentiles);
        find_sizes();
        if (table_.columns() == 1) return list();
        find_share();
        decide_weighting();
        read_columns();
        decide_shares();
        return SizeClasses(shares_ == Shares::classes ? classes() : classes_between(curve()), *weighting_);
    }

    [[noreturn]] void refuse(const std::string& sentence) const { throw Error(file_ + ": " + sentence); }

    std::vector<double> lengths(std::size_t column) const {
        unit_used_ = unit_used_ || table_.unit(column).empty();
        if (table_.unit(column).empty() && manner_.unit.empty())
            refuse("column " + io::excerpt(table_.heading(column)) + " has no unit; --length-unit names it");
        return table_.values(column, Dimension::length, manner_.unit);
    }

    /// A table of one row with D10, D50 and D90.
    std::optional<SizeDistribution> three_percentiles() const {
        std::array<std::optional<std::size_t>, 3> at;
        bool number = false;
        for (std::size_t column = 0; column < table_.columns(); ++column)
            if (const auto found = percentile_in(table_.name(column))) {
                at[found->first == 10 ? 0 : found->first == 50 ? 1 : 2] = column;
                number = number || found->second;
            }
        if (!at[0] || !at[1] || !at[2]) return std::nullopt;
        if (shares_) refuse("--shares goes with a table of sizes and shares, and this one has D10, D50 and D90");
        if (table_.rows() != 1)
            refuse("has " + std::to_string(table_.rows()) + " rows with D10, D50 and D90; leave the one that is meant");
        std::array<double, 3> d{};
        for (std::size_t each = 0; each < 3; ++each) d[each] = lengths(*at[each])[0];
        if (!(0.0 < d[0] && d[0] < d[1] && d[1] < d[2])) refuse("D10, D50 and D90 do not ascend from above zero");
        const Weighting by = weighting_.value_or(number ? Weighting::number : Weighting::volume);
        if (number != (by == Weighting::number)) refuse("the heading of D10 and --sizes-by say different things");
        return SizeClasses(classes_between(through_percentiles(d[0], d[1], d[2], d[0] * d[0] / d[1], d[2] * d[2] / d[1])), by);
    }

    void find_sizes() {
        std::vector<std::size_t> found;
        for (std::size_t column = 0; column < table_.columns(); ++column)
            if (is_length(table_, column)) found.push_back(column);
        for (std::size_t column = 0; column < table_.columns() && found.empty(); ++column)
            if (table_.unit(column).empty() && has_word(table_, column, size_words)) found.push_back(column);
        const auto take = [&](std::size_t column) {
            std::optional<std::size_t>& edge = has_word(table_, column, lower_words)   ? lower_
                                               : has_word(table_, column, upper_words) ? upper_
                                                                                       : size_;
            if (edge) refuse("the columns " + quoted(table_, {*edge, column}) + " may both hold sizes; --columns chooses");
            edge = column;
        };
        for (const std::size_t column : found) take(column);
        if (found.empty()) refuse("has no column of sizes; its headings are " + table_.headings_text() + "; --columns names them");
        if (size_ && (lower_ || upper_))
            refuse("the columns " + quoted(table_, {*size_, lower_ ? *lower_ : *upper_}) +
                   " may both hold sizes; --columns chooses");
    }

    DiameterList list() const {
        if (weighting_ || shares_) refuse("is a list of diameters, one of each particle; --sizes-by and --shares go with a table");
        const std::size_t column = size_ ? *size_ : lower_ ? *lower_ : *upper_;
        const std::vector<double> diameters = lengths(column);
        for (std::size_t row = 0; row < diameters.size(); ++row)
            if (!(diameters[row] > 0.0))
                throw Error(table_.place(row) + ": the diameter " + io::excerpt(table_.cell(row, column)) + " is not above zero");
            else if (!is_diameter(diameters[row]))
                throw Error(table_.place(row) + ": the diameter " + io::excerpt(table_.cell(row, column)) + " is out of range");
        return {diameters};
    }

    std::optional<Weighting> weighting_in(std::size_t column) const {
        const bool volume = has_word(table_, column, volume_words), number = has_word(table_, column, number_words);
        if (volume == number) return std::nullopt;
        return volume ? Weighting::volume : Weighting::number;
    }

    std::optional<Shares> shares_in(std::size_t column) const {
        if (has_word(table_, column, oversize_words)) return Shares::oversize;
        if (has_word(table_, column, undersize_words)) return Shares::undersize;
        return std::nullopt;
    }

    void find_share() {
        std::vector<std::size_t> found;
        for (std::size_t column = 0; column < table_.columns(); ++column) {
            if (column == size_ || column == lower_ || column == upper_ || is_length(table_, column)) continue;
            const bool named = table_.name(column) == "share" || table_.name(column) == "shares";
            const bool plain = table_.unit(column).empty() || is_percent(table_, column);
            if (plain &&
                (named || is_percent(table_, column) || weighting_in(column) || shares_in(column) || table_.columns() == 2))
                found.push_back(column);
        }
        const auto keep = [&](const auto& fits) {
            std::vector<std::size_t> fitting;
            std::ranges::copy_if(found, std::back_inserter(fitting), fits);
            if (!fitting.empty()) found = fitting;
        };
        if (found.size() > 1 && weighting_) keep([&](std::size_t column) { return weighting_in(column) == weighting_; });
        if (found.size() > 1 && shares_)
            keep([&](std::size_t column) { return shares_in(column).value_or(Shares::classes) == shares_; });
        if (found.empty()) refuse("has no column of shares; its headings are " + table_.headings_text() + "; --columns names them");
        if (found.size() > 1)
            refuse("the columns " + quoted(table_, found) + " may all hold shares; --sizes-by, --shares or --columns chooses");
        share_ = found.front();
    }

    void decide_weighting() {
        const auto heading = weighting_in(share_);
        if (!weighting_ && !heading)
            refuse("column " + quoted(table_, {share_}) + " does not say what it counts; --sizes-by number, volume or mass does");
        if (weighting_ && heading && *weighting_ != *heading)
            refuse("column " + quoted(table_, {share_}) + " and --sizes-by say different things");
        if (!weighting_) weighting_ = heading;
    }

    /// Diameters in ascending order and their shares as fractions, or as counts.
    void read_columns() {
        values_ = table_.values(share_, Dimension::fraction);
        for (std::size_t row = 0; row < values_.size(); ++row)
            if (values_[row] < 0.0)
                throw Error(table_.place(row) + ": the share " + io::excerpt(table_.cell(row, share_)) + " is below zero");
        const std::size_t main = size_ ? *size_ : lower_ ? *lower_ : *upper_;
        sizes_ = lengths(main);
        if (lower_ && upper_) others_ = lengths(*upper_);
        rows_.resize(sizes_.size());
        std::iota(rows_.begin(), rows_.end(), std::size_t{0});
        if (sizes_.size() > 1 && sizes_.front() > sizes_.back()) std::ranges::reverse(rows_);
        for (std::size_t at = 0; at < rows_.size(); ++at) {
            const std::size_t row = rows_[at];
            const std::string given = io::excerpt(table_.cell(row, main));
            if (sizes_[row] < 0.0 || (sizes_[row] == 0.0 && (at > 0 || values_[row] > 0.0)))
                throw Error(table_.place(row) + ": the diameter " + given + " is not above zero");
            if (at > 0 && !(sizes_[row] > sizes_[rows_[at - 1]]))
                throw Error(table_.place(row) + ": the diameter " + given + " is out of order");
        }
        if (sizes_[rows_.front()] == 0.0) rows_.erase(rows_.begin());  // of which there is nothing
        if (rows_.empty()) refuse("has no sizes above zero");
    }

    double sum() const {
        double total = 0.0;
        for (const std::size_t row : rows_) total += values_[row];
        return total;
    }

    bool whole(double value, double error) const {
        const double all = hundred_ ? 100.0 : 1.0;
        return std::abs(value - all) <= error * all;
    }

    /// Whether the shares are of classes or cumulative, and whether 1 or 100 is all of them; counts are of classes.
    void decide_shares() {
        const auto heading = shares_in(share_);
        if (shares_ && heading && *shares_ != *heading)
            refuse("column " + quoted(table_, {share_}) + " and --shares say different things");
        if (!shares_) shares_ = heading;
        if (!shares_ && !is_percent(table_, share_) && has_word(table_, share_, count_words)) shares_ = Shares::classes;
        const auto value = [&](std::size_t at) { return values_[rows_[at]]; };
        const double first = value(0), last = value(rows_.size() - 1), total = sum();
        bool rises = true, falls = true;
        for (std::size_t at = 1; at < rows_.size(); ++at) {
            rises = rises && value(at) >= value(at - 1);
            falls = falls && value(at) <= value(at - 1);
        }
        const bool whole_numbers = std::ranges::all_of(values_, [](double share) { return share == std::floor(share); });
        const bool counts = *weighting_ == Weighting::number && !is_percent(table_, share_) &&
                            (whole_numbers || has_word(table_, share_, count_words));
        std::vector<std::pair<Shares, bool>> possible;  // and in percent
        for (const bool percent : {false, true}) {
            if (percent && is_percent(table_, share_)) break;  // read as a fraction already
            hundred_ = percent;
            if (whole(total, sum_error)) possible.emplace_back(Shares::classes, percent);
            if (rises && whole(last, tail)) possible.emplace_back(Shares::undersize, percent);
            if (falls && whole(first, tail)) possible.emplace_back(Shares::oversize, percent);
        }
        if (shares_) std::erase_if(possible, [&](const auto& each) { return each.first != *shares_; });
        if (counts && shares_.value_or(Shares::classes) == Shares::classes && total > 0.0) possible = with_counts(possible);
        const std::string column = "the shares in column " + quoted(table_, {share_});
        if (possible.empty())
            refuse(column + " add up to " + number(total) + " and go from " + number(first) + " to " + number(last) +
                   (shares_ == Shares::classes ? ", not to all of the powder"
                    : shares_                  ? ", not between 0 and all of the powder; add the row that is missing"
                                               : ": neither classes that make up all of the powder nor a cumulative curve"));
        if (possible.size() > 1 && possible.front().first != possible.back().first)
            refuse(column + " may be those of classes or a cumulative curve; --shares says which");
        shares_ = possible.front().first;
        hundred_ = possible.front().second;
    }

    /// Classes may also be numbers of particles that add up to anything.
    static std::vector<std::pair<Shares, bool>> with_counts(std::vector<std::pair<Shares, bool>> possible) {
        if (possible.empty() || possible.front().first != Shares::classes)
            possible.insert(possible.begin(), {Shares::classes, false});
        return possible;
    }

    static std::string number(double value) {
        char text[32];
        std::snprintf(text, sizeof text, "%.4g", value);
        return text;
    }

    std::vector<SizeClass> classes() const {
        std::vector<SizeClass> found;
        for (std::size_t at = 0; at < rows_.size(); ++at) {
            const std::size_t row = rows_[at];
            double low = sizes_[row], high = low;
            if (lower_ && upper_) {
                high = others_[row];
                if (!(high > low)) throw Error(table_.place(row) + ": the upper edge of the class is not above the lower one");
                if (at > 0 && low < others_[rows_[at - 1]] * (1.0 - tail * tail))
                    throw Error(table_.place(row) + ": the class overlaps the one before it");
                if (at > 0) low = std::max(low, others_[rows_[at - 1]]);
            } else if (lower_) {
                if (at + 1 == rows_.size() && values_[row] > 0.0)
                    throw Error(table_.place(row) + ": the last class has no upper edge; add a row with a share of 0 for it");
                if (at + 1 < rows_.size()) high = sizes_[rows_[at + 1]];
            } else if (upper_) {
                if (at == 0 && values_[row] > 0.0)
                    throw Error(table_.place(row) + ": the first class has no lower edge; add a row with a share of 0 for it");
                if (at > 0) low = sizes_[rows_[at - 1]];
            }
            found.push_back({low, high, values_[row]});
        }
        return found;
    }

    std::vector<Undersize> curve() const {
        if (lower_ && upper_) refuse("a cumulative share belongs to one diameter, and there are two edges");
        std::vector<Undersize> points;
        const double all = hundred_ ? 100.0 : 1.0;
        for (const std::size_t row : rows_) {
            const double share = std::clamp(values_[row] / all, 0.0, 1.0);
            points.push_back({sizes_[row], shares_ == Shares::oversize ? 1.0 - share : share});
        }
        const double missing = std::max(points.front().below, 1.0 - points.back().below);
        if (missing > tail)
            refuse(number(100.0 * missing) + " % lie " +
                   (points.front().below > tail ? "below the smallest" : "above the largest") +
                   " diameter; add the row where the curve " + (points.front().below > tail ? "begins" : "ends"));
        for (std::size_t at = 1; at < points.size(); ++at)
            if (points[at].below < points[at - 1].below)
                throw Error(table_.place(rows_[at]) + ": the cumulative share turns back");
        return points;
    }

    const CsvTable& table_;
    std::string file_;
    std::optional<Weighting> weighting_;
    std::optional<Shares> shares_;
    const FileManner& manner_;
    std::optional<std::size_t> size_, lower_, upper_;  // columns
    std::size_t share_ = 0;
    bool hundred_ = false;  // 100 is all
    mutable bool unit_used_ = false;
    std::vector<double> sizes_, others_, values_;  // of each row: m, m of the upper edge, share
    std::vector<std::size_t> rows_;                // in the order of size
};

/// Lines of a text without blank ones and those that begin with #, and their numbers from 1.
std::vector<std::pair<std::size_t, std::string>> lines_of(const std::string& text) {
    std::vector<std::pair<std::size_t, std::string>> lines;
    std::size_t number = 1;
    for (std::size_t at = 0; at < text.size(); ++number) {
        const std::size_t end = std::min(text.find('\n', at), text.size());
        std::string line = text.substr(at, end - at);
        while (!line.empty() && (line.back() == '\r' || line.back() == ' ' || line.back() == '\t')) line.pop_back();
        line.erase(0, line.find_first_not_of(" \t"));
        if (!line.empty() && line.front() != '#') lines.emplace_back(number, line);
        at = end + 1;
    }
    return lines;
}

double diameter_in(const std::string& line) {
    const double diameter = io::parse_quantity(line, Dimension::length);
    if (!(diameter > 0.0)) throw TextError("the diameter '" + line + "' is not above zero");
    if (!is_diameter(diameter)) throw TextError("the diameter '" + line + "' is out of range");
    return diameter;
}

/// The diameters of a list whose first line is a quantity; nothing where it is none.
std::optional<DiameterList> list_in(const std::string& text, const std::string& file) {
    const auto lines = lines_of(text);
    if (lines.empty()) throw Error(file + ": the list of diameters is empty");
    try {
        io::parse_quantity(lines.front().second, Dimension::length);
    } catch (const TextError&) {
        return std::nullopt;
    }
    DiameterList list;
    for (const auto& [number, line] : lines) try {
            list.diameters.push_back(diameter_in(line));
        } catch (const TextError& error) {
            throw Error(file + ", line " + std::to_string(number) + ": " + error.what());
        }
    return list;
}

}  // namespace

SizeDistribution read_sizes(const std::string& file, std::optional<Weighting> weighting, std::optional<Shares> shares,
                            const FileManner& manner) {
    const std::string bytes = io::bytes_of(file);
    if (manner.columns.empty())
        if (auto list = list_in(io::utf8_text(bytes, file), file)) {
            if (weighting || shares)
                throw Error(file + ": is a list of diameters, one of each particle; --sizes-by and --shares go with a table");
            if (!manner.unit.empty()) throw Error(file + ": all sizes have units, and --length-unit gives one more");
            return std::move(*list);
        }
    const CsvTable table = manner.columns.empty() ? CsvTable(file, bytes) : CsvTable(file, bytes, manner.columns);
    return SizeTable(table, file, weighting, shares, manner).read();
}

}  // namespace kiln::packing
