// help_format.h: how --help is laid out: lines of at most 100 columns, a program's own options before the common ones.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace kiln::cli {

/// Columns that no line of a help text exceeds, so that it can be read in a terminal and in a manual page.
inline constexpr std::size_t help_width = 100;

/// Text broken between words into lines of at most help_width columns, those after the first of a paragraph indented by `indent`.
/// Line ends stay, and lines that begin with a space (commands, lists) are kept as they are.
std::string wrapped(const std::string& text, std::size_t indent = 0);

class HelpFormat : public CLI::Formatter {
   public:
    HelpFormat();

    std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override;
    std::string make_description(const CLI::App* app) const override;
    std::string make_footer(const CLI::App* app) const override;
    std::string make_option(const CLI::Option* option, bool is_positional) const override;
    std::string make_option_name(const CLI::Option* option, bool is_positional) const override;
    std::string make_option_opts(const CLI::Option* option) const override;
    std::string make_option_desc(const CLI::Option* option) const override;
};

}  // namespace kiln::cli
