// tool.cpp: common options, the one catch, signals, the history entry.
#include "tools/common/tool.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <new>
#include <set>

#include "core/parallel.h"
#include "io/files.h"
#include "tools/common/help_format.h"
#include "tools/common/memory.h"
#include "tools/common/ranks.h"
#include "tools/common/value_options.h"

namespace kiln::cli {

namespace {

volatile std::sig_atomic_t signal_seen = 0;

void note_signal(int signal) { signal_seen = signal; }

/// The first signal asks long loops to end and interrupts a wait for input; a second one ends the program at once.
void watch_signals() {
    struct sigaction action {};
    action.sa_handler = note_signal;
    action.sa_flags = static_cast<int>(SA_RESETHAND);
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
    if (std::signal(SIGHUP, SIG_IGN) != SIG_IGN) sigaction(SIGHUP, &action, nullptr);  // under nohup it stays ignored
    for (const int signal : {SIGPIPE, SIGXFSZ}) std::signal(signal, SIG_IGN);  // these come back as errors of write
}

/// The group of options that every program has; --help prints it last.
constexpr const char* common_group = "Common options";

constexpr int max_threads = 1024;

/// --help and --version: everything is said already.
struct Finished {};

/// Options that change where or how a result is written, not the result.
constexpr std::array without_bearing{"--help",    "--version", "--config", "--output",     "--text",
                                     "--quiet",   "--verbose", "--threads", "--history",   "--states",
                                     "--resume",  "files",     "--checkpoint", "--checkpoint-every", "--plot"};

/// OMP_NUM_THREADS, which schedulers of clusters set; 0 where it gives no number.
int threads_of_environment() {
    const char* const text = std::getenv("OMP_NUM_THREADS");
    return text == nullptr ? 0 : std::clamp(std::atoi(text), 0, max_threads);
}

/// The text without line ends and what else a terminal would act on; names in it come from files.
std::string one_line(std::string text) {
    while (!text.empty() && text.back() == '\n') text.pop_back();
    std::replace_if(text.begin(), text.end(), [](unsigned char c) { return c < ' ' || c == 127; }, ' ');
    return text;
}

/// Status of a run that ended in a signal, as a shell counts it; `usual` of one that did not.
int status_after_signal(int usual) { return signal_seen == 0 ? usual : 128 + signal_seen; }

/// How a run ended, and what is still to be said of it.
struct Ending {
    int status;
    std::string sentence;
    bool failed = true;
};

Ending ending_of(const std::string& tool, int argc, char** argv, const std::function<int(int, char**)>& body) {
    const std::string see_help = "; see " + tool + " --help";
    try {
        const int status = body(argc, argv);
        return {status == done || status == interrupted ? status_after_signal(status) : status, "", false};
    } catch (const Finished&) {
        if (std::cout.flush()) return {done, ""};
        if (errno == EPIPE) return {closed_pipe, ""};
        return {failed, "standard output cannot be written"};
    } catch (const CLI::ParseError& error) {
        return {wrong_usage, error.what() + see_help};
    } catch (const TextError& error) {
        return {wrong_usage, error.what() + see_help};
    } catch (const io::ClosedPipe&) {
        return {closed_pipe, ""};
    } catch (const Interrupted&) {
        return {status_after_signal(interrupted), ""};
    } catch (const std::bad_alloc&) {
        return {failed, "there is not enough memory"};
    } catch (const std::exception& error) {
        return {failed, error.what()};
    }
}

/// Several processes share work only where that was chosen.
void refuse_idle_processes(const CLI::App& app) {
    const CLI::Option* solver = app.get_option_no_throw("--solver");
    if (ranks::launched().count == 1 || (solver && solver->count() > 0 && solver->as<std::string>() == "petsc")) return;
    throw CLI::ValidationError(std::to_string(ranks::launched().count) +
                               " processes were started, and each would do the same work and write the same file; only bend and "
                               "analyze elastic divide it among them, with --solver petsc");
}

}  // namespace

void add_help(CLI::App& app) {
    app.formatter(std::make_shared<HelpFormat>());
    app.set_help_flag("-h,--help", "Print this help and exit")->group(common_group);
    app.set_version_flag("--version", version, "Print the version and exit")->group(common_group);
}

void Common::add_to(CLI::App& app, bool reads, bool writes_states) {
    if (reads) app.add_option("files", files, "Streams to read; - or nothing is standard input")->type_name("FILE");
    app.add_option("-o,--output", output, "File to write, whole or not at all; - is standard output")
        ->type_name("FILE")
        ->default_str("-")
        ->group(common_group);
    if (writes_states)
        app.add_flag("--text", text, "Write text documents (JSON lines) instead of binary ones")->group(common_group);
    app.add_flag("-q,--quiet", quiet, "No progress and no warnings on standard error")->group(common_group);
    app.add_flag("-v,--verbose", verbose, "Say more on standard error; a JSON line a step if that is not a terminal")
        ->group(common_group);
    add_number(app, "--threads", threads, {1, max_threads}, "Number of threads; the result does not depend on it")
        ->default_str("OMP_NUM_THREADS, or all cores")
        ->group(common_group);
    app.set_config("--config", "", "Read options from a TOML file, such as: temperature = \"1200C\"")
        ->type_name("FILE")
        ->group(common_group);
    app.allow_config_extras(false);
    add_help(app);
}

int run(const std::string& tool, int argc, char** argv, const std::function<int(int, char**)>& body) {
    watch_signals();
    set_up_memory();
    const Ending ending = ending_of(tool, argc, argv, body);
    const bool together = !ending.failed || ranks::all_failed();
    if (!ending.sentence.empty() && (ranks::rank() == 0 || !together)) {
        const std::string which = ranks::rank() > 0 ? " (process " + std::to_string(ranks::rank() + 1) + ")" : "";
        std::cerr << tool << which << ": " << one_line(ending.sentence) << "\n";
    }
    if (!together) ranks::abort(ending.status);
    return ranks::end(ending.status);
}

void check_outputs(const std::vector<std::string>& names) {
    namespace fs = std::filesystem;
    std::set<fs::path> seen;
    for (const std::string& name : names) {
        std::error_code none;
        if (name.empty() || (fs::exists(name, none) && !fs::is_regular_file(name, none))) continue;
        if (!seen.insert(name == "-" ? fs::path(name) : fs::weakly_canonical(fs::absolute(name), none)).second)
            throw CLI::ValidationError(name + ": two outputs of one run cannot have the same name");
    }
}

void parse(CLI::App& app, int argc, char** argv, const Common& common) {
    if (ranks::launched().count > 1) ranks::begin();
    const auto finish = [](const std::string& text) {
        if (ranks::rank() == 0) std::cout << text;
        throw Finished();
    };
    try {
        app.parse(argc, argv);
    } catch (const CLI::CallForHelp&) {
        finish(app.help());
    } catch (const CLI::CallForVersion&) {
        finish(app.get_name() + " (Kiln) " + version + "\n");
    } catch (const CLI::FileError&) {  // the only file that CLI11 reads itself
        throw Error("--config: " + app.get_config_ptr()->as<std::string>() + " cannot be read");
    }
    refuse_idle_processes(app);
    if (const int count = common.threads > 0 ? common.threads : threads_of_environment(); count > 0) set_threads(count);
}

Json history_entry(const std::string& tool, const CLI::App& app, const Json& summary) {
    Json entry{{"tool", tool}, {"version", version}, {"arguments", Json::array()}};
    for (const CLI::Option* option : app.get_options()) {
        const std::string name = option->get_positional() ? "files" : option->get_name();
        const bool bears = std::find(without_bearing.begin(), without_bearing.end(), name) == without_bearing.end();
        const bool switched_off = option->get_expected_min() == 0 && option->results() == std::vector<std::string>{"false"};
        if (option->count() == 0 || !bears || switched_off) continue;
        entry["arguments"].push_back(name);
        std::string values;
        for (const std::string& value : option->results()) values += (values.empty() ? "" : ",") + value;
        if (option->get_expected_min() > 0) entry["arguments"].push_back(values);
    }
    if (const CLI::Option* seed = app.get_option_no_throw("--seed")) entry["seed"] = seed->as<std::uint64_t>();
    entry["summary"] = summary;
    return entry;
}

bool stop_requested() { return signal_seen != 0; }

void warn(const std::string& tool, const std::string& sentence) { std::cerr << tool << ": warning: " << sentence << "\n"; }

}  // namespace kiln::cli
