// help_format.cpp: wrapping of help texts; default values and conflicts with other options behind the words and not before them.
#include "tools/common/help_format.h"

#include <algorithm>
#include <set>
#include <sstream>

namespace kiln::cli {

namespace {

constexpr std::size_t names_width = 34;  // columns of an option's names and the kind of its value

constexpr char bound_space = '\x1f';           // a space at which no line is broken
constexpr std::size_t longest_unbroken = 16;  // columns of a default value that is kept on one line

/// Columns of a UTF-8 text: bytes but for those that continue a character.
std::size_t columns_of(const std::string& text) {
    return static_cast<std::size_t>(std::ranges::count_if(text, [](char byte) { return (byte & 0xC0) != 0x80; }));
}

/// One paragraph, whose first line begins in column `indent` and whose other lines are indented by it.
std::string paragraph(const std::string& text, std::size_t indent) {
    std::istringstream words(text);
    std::string lines, word;
    std::size_t column = indent;
    while (words >> word) {
        const std::size_t width = columns_of(word);
        const bool first = column == indent;
        if (!first && column + 1 + width > help_width) {
            lines += "\n" + std::string(indent, ' ');
            column = indent;
        } else if (!first) {
            lines += ' ';
            ++column;
        }
        lines += word;
        column += width;
    }
    std::ranges::replace(lines, bound_space, ' ');
    return lines;
}

std::string names(const std::set<CLI::Option*>& options) {
    std::string list;
    for (const CLI::Option* option : options) list += (list.empty() ? "" : ", ") + option->get_name();
    return list;
}

bool takes_many(const CLI::Option* option) { return option->get_expected_max() == CLI::detail::expected_max_vector_size; }

}  // namespace

std::string wrapped(const std::string& text, std::size_t indent) {
    std::istringstream lines(text);
    std::string result, line;
    for (bool first = true; std::getline(lines, line); first = false)
        result += (first ? "" : "\n") + (line.starts_with(' ') ? line : paragraph(line, indent));
    return result;
}

HelpFormat::HelpFormat() {
    column_width(names_width);
    label("Positionals", "Input");
}

std::string HelpFormat::make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const {
    std::string text = make_description(app) + "\n" + make_usage(app, std::move(name)) + make_positionals(app) +
                       make_groups(app, mode) + "\n" + make_footer(app);
    for (std::size_t blank = text.find("\n\n\n"); blank != std::string::npos; blank = text.find("\n\n\n")) text.erase(blank, 1);
    return text;
}

std::string HelpFormat::make_description(const CLI::App* app) const { return wrapped(app->get_description()) + "\n"; }

std::string HelpFormat::make_footer(const CLI::App* app) const {
    return app->get_footer().empty() ? "" : wrapped(app->get_footer()) + "\n";
}

std::string HelpFormat::make_option(const CLI::Option* option, bool is_positional) const {
    const std::string left = "  " + make_option_name(option, is_positional) + make_option_opts(option);
    const bool fits = columns_of(left) < names_width;
    return left + (fits ? std::string(names_width - columns_of(left), ' ') : "\n" + std::string(names_width, ' ')) +
           wrapped(make_option_desc(option), names_width) + "\n";
}

std::string HelpFormat::make_option_name(const CLI::Option* option, bool is_positional) const {
    if (!is_positional) return Formatter::make_option_name(option, false);
    return option->get_type_name().empty() ? option->get_name() : option->get_type_name();
}

std::string HelpFormat::make_option_opts(const CLI::Option* option) const {
    if (option->get_positional()) return takes_many(option) ? "..." : "";
    return option->get_type_size() == 0 || option->get_type_name().empty() ? "" : " " + option->get_type_name();
}

std::string HelpFormat::make_option_desc(const CLI::Option* option) const {
    std::string words = option->get_description();
    if (std::string standard = option->get_default_str(); !standard.empty() && option->get_type_size() != 0) {
        const bool brief = columns_of(standard) <= longest_unbroken;
        if (brief) std::ranges::replace(standard, ' ', bound_space);
        words += std::string(" (default") + (brief ? bound_space : ' ') + standard + ")";
    }
    if (!option->get_needs().empty()) words += "; requires " + names(option->get_needs());
    if (!option->get_excludes().empty()) words += "; not with " + names(option->get_excludes());
    return words;
}

}  // namespace kiln::cli
