// mean.cpp: means of every number that several results have, with their intervals of confidence.
#include <CLI/CLI.hpp>
#include <cmath>
#include <limits>
#include <map>

#include "analysis/histogram.h"
#include "analysis/student.h"
#include "io/json_values.h"
#include "io/state_io.h"
#include "tools/analyze/analyze.h"
#include "tools/analyze/report.h"
#include "tools/analyze/results.h"
#include "tools/common/each_state.h"

namespace kiln::analyze {

namespace {

constexpr const char* mean_footer =
    "Keys of the result:\n"
    "  documents, confidence\n"
    "  material             names in one text; null where no document says it\n"
    "  not_determined       keys whose interval reaches farther than their mean is large\n"
    "  mean, standard_deviation, standard_error, interval\n"
    "                       objects with the keys that are numbers in all documents: deviation and error\n"
    "                       of the n values, with n - 1, and the interval of the mean by Student's t\n\n"
    "Examples:\n"
    "  analyze mean --table moduli.json\n"
    "  analyze density trajectory.kiln | analyze mean | jq .interval.coordination_number";

const std::vector<Column> mean_columns{{"material", "material", ""},
                                       {"quantity", "quantity", ""}, {"documents", "n", ""},
                                       {"mean", "mean", ""},         {"lower", "lower", ""},
                                       {"upper", "upper", ""},       {"standard_deviation", "deviation", ""},
                                       {"note", "note", ""}};

/// The numbers at the top of all documents, in the order of the first one.
class Values {
   public:
    void add(const io::Document& document) {
        if (document.header.value("format", Json("dem-state")) == "dem-state")
            throw Error("is a state, analyze mean reads results, such as those of analyze density");
        std::map<std::string, std::vector<double>> left;
        for (const auto& [key, value] : document.header.items()) {
            if (key == "version" || !value.is_number()) continue;
            const auto before = values_.find(key);
            if (documents_ > 0 && before == values_.end()) continue;
            std::vector<double>& list = left[key];
            if (before != values_.end()) list = std::move(before->second);
            list.push_back(io::number_from(value, key, std::numeric_limits<double>::lowest()));
        }
        values_ = std::move(left);
        headers_.push_back({{"material", document.header.value("material", Json())}});
        ++documents_;
    }

    std::size_t documents() const { return documents_; }
    Json material() const { return joined_materials(headers_); }
    const std::map<std::string, std::vector<double>>& each() const { return values_; }

   private:
    std::map<std::string, std::vector<double>> values_;
    std::vector<Json> headers_;  // of each its material
    std::size_t documents_ = 0;
};

/// What is said of one quantity; all but the mean is null for a single value.
Json row_of(const std::string& key, const std::vector<double>& values) {
    const auto count = static_cast<double>(values.size());
    const analysis::Spread spread = *analysis::spread_of(values);
    Json row{{"quantity", key},       {"documents", values.size()},      {"mean", spread.mean},
             {"lower", nullptr},      {"upper", nullptr},                {"standard_deviation", nullptr},
             {"standard_error", nullptr}};
    if (values.size() < 2) return row;
    const double deviation = spread.standard_deviation * std::sqrt(count / (count - 1.0)), error = deviation / std::sqrt(count);
    const double reach = analysis::student_factor(values.size() - 1, confidence) * error;
    row["standard_deviation"] = deviation;
    row["standard_error"] = error;
    row["lower"] = spread.mean - reach;
    row["upper"] = spread.mean + reach;
    row["undetermined"] = deviation > 0.0 && says_nothing(spread.mean, reach);
    return row;
}

Json document_of(const Values& values) {
    Json document{{"format", "dem-mean"}, {"version", io::format_version}, {"documents", values.documents()},
                  {"confidence", confidence}};
    document["material"] = values.material();
    document["not_determined"] = Json::array();
    for (const char* key : {"mean", "standard_deviation", "standard_error", "interval"}) document[key] = Json::object();
    for (const auto& [key, list] : values.each()) {
        const Json row = row_of(key, list);
        for (const char* what : {"mean", "standard_deviation", "standard_error"}) document[what][key] = row[what];
        document["interval"][key] = list.size() < 2 ? Json() : Json::array({row["lower"], row["upper"]});
        if (row.value("undetermined", false)) document["not_determined"].push_back(key);
    }
    return document;
}

}  // namespace

int mean(int argc, char** argv) {
    CLI::App app{
        "Means of every number that all results of the input have, with intervals that hold the true mean in 95 of 100 cases.",
        "analyze mean"};
    app.footer(mean_footer);
    cli::Common common;
    bool table = false;
    add_table(app, table);
    common.add_to(app, true, false);
    cli::parse(app, argc, argv, common);

    Values values;
    io::Input input(common.files, cli::stop_requested);
    cli::for_each_document(input, [&](const io::Document& document) { values.add(document); });
    if (values.each().empty()) throw Error("the results have no number in common");
    Report report(common, table, mean_columns);
    if (table)
        for (const auto& [key, list] : values.each()) {
            Json row = row_of(key, list);
            row["material"] = values.material();
            if (row.value("undetermined", false)) row["note"] = not_determined;
            report.add(std::move(row));
        }
    else
        report.add(document_of(values));
    report.finish();
    return cli::done;
}

}  // namespace kiln::analyze
