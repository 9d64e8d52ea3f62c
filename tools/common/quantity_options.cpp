// quantity_options.cpp: options that take quantities.
#include "tools/common/quantity_options.h"

namespace kiln::cli {

CLI::Option* add_quantity(CLI::App& app, const std::string& name, double& target, io::Dimension dimension, const std::string& help,
                          const std::string& default_text) {
    const std::string known = io::known_units(dimension);
    CLI::Option* option = app.add_option_function<std::string>(
        name,
        [&target, dimension, name](const std::string& text) {
            target = parsed(name, [&] { return io::parse_quantity(text, dimension); });
        },
        help + (known.empty() ? "" : " [" + known + "]"));
    option->type_name(known.empty() ? "NUMBER" : "QUANTITY");
    if (!default_text.empty()) option->default_str(default_text);
    return option;
}

CLI::Option* add_quantities(CLI::App& app, const std::string& name, std::vector<double>& target, io::Dimension dimension,
                            const std::string& help) {
    const std::string known = io::known_units(dimension);
    CLI::Option* option = app.add_option_function<std::string>(
        name,
        [&target, dimension, name](const std::string& list) {
            target.clear();
            for (std::size_t start = 0; start <= list.size();) {
                const std::size_t end = std::min(list.find(',', start), list.size());
                const std::string_view word = std::string_view(list).substr(start, end - start);
                target.push_back(parsed(name, [&] { return io::parse_quantity(word, dimension); }));
                start = end + 1;
            }
        },
        help + (known.empty() ? "" : " [" + known + "]"));
    option->type_name(known.empty() ? "NUMBER,..." : "QUANTITY,...");
    return option;
}

}  // namespace kiln::cli
